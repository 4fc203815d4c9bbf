// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/layout.h"

#include <algorithm>

#include "compiler/lower/frame_layout.h"
#include "runtime/render/samples.h"

namespace isoshade::render {
namespace {

using backends::Slot;
using backends::SlotAllocator;

constexpr int color_channels = 4, depth_channels = 1;

/// Whether a step can run right after the one before it, or after drawing, pixel by pixel.
bool follows(const PostChain& chain, size_t s, int width, int height) {
  const PostStep& step = chain.steps[s];
  const auto image = static_cast<int>(s);
  const bool is_alone = chain.result != image && chain.last_reader[s] <= image;
  const bool is_whole = step.width == width && step.height == height;
  return step.post->is_pointwise && is_alone && is_whole &&
         (step.sources[0] == image || step.sources[0] == PostStep::not_read);
}

void give_back(SlotAllocator& allocator, const FrameLayout::ViewImages& view) {
  allocator.give_back(view.depth);
  allocator.give_back(view.color);
}

}  // namespace

FrameLayout::FrameLayout(const Plan& plan, bool apart) {
  const backends::Frame& frame = plan.frame;
  const PostChain& chain = plan.posts;
  const size_t picture = frame.views.size() - 1, steps = chain.steps.size();
  const int side = samples_each_way(plan.samples);
  const int width = frame.picture().target.width / side, height = frame.picture().target.height / side;

  if (plan.samples > 1)
    drawn_steps = chain.sample_steps;
  else if (!apart)
    while (drawn_steps < steps && follows(chain, drawn_steps, width, height)) ++drawn_steps;
  for (size_t s = drawn_steps; s < steps;) {
    StepGroup group{s, 1};
    const auto& [made_width, made_height] = std::pair(chain.steps[s].width, chain.steps[s].height);
    while (!apart && s + group.count < steps && follows(chain, s + group.count, made_width, made_height)) ++group.count;
    groups.push_back(group);
    s += group.count;
  }

  SlotAllocator allocator;
  std::vector<size_t> last_reader(frame.views.size());  // of each view: the last view that reads it, or itself
  for (size_t v = 0; v <= picture; ++v) {
    last_reader[v] = v;
    for (const size_t read : frame.views[v].reads)
      if (read != backends::View::nothing) last_reader[read] = v;
  }
  views.resize(frame.views.size());
  for (ViewImages& view : views) view.camera = allocator.take(lower::view_word::camera_words);
  for (size_t v = 0; v <= picture; ++v) {
    const backends::Target& target = frame.views[v].target;
    const int each = v == picture ? side : 1;
    views[v].depth = allocator.take(target.width / each, target.height / each, depth_channels);
    if (target.has_color) views[v].color = allocator.take(target.width / each, target.height / each, color_channels);
    for (size_t drawn = 0; drawn < picture; ++drawn)
      if (last_reader[drawn] == v) give_back(allocator, views[drawn]);
  }
  if (plan.motion) {
    const backends::Target& target = plan.motion->now.target;
    drawn_motion.depth = allocator.take(target.width, target.height, depth_channels);
    drawn_motion.color = allocator.take(target.width, target.height, color_channels);
    motion = allocator.take(target.width, target.height, color_channels);
    give_back(allocator, drawn_motion);
  }
  images.assign(1 + steps, {});
  std::fill_n(images.begin(), drawn_steps + 1, views[picture].color);
  std::vector<size_t> kept{drawn_steps};  // images that a later step or nobody but the scene reads
  for (const StepGroup& group : groups) {
    const size_t last = group.first + group.count - 1;
    const Slot made = allocator.take(chain.steps[last].width, chain.steps[last].height, color_channels);
    std::fill_n(images.begin() + static_cast<ptrdiff_t>(group.first) + 1, group.count, made);
    kept.push_back(last + 1);
    most_images = std::max(most_images, kept.size());
    std::erase_if(kept, [&](size_t image) {
      const bool done = image <= last && chain.is_done(image, last);
      if (done) allocator.give_back(images[image]);
      return done;
    });
  }
  if (apart) {
    probe.depth = allocator.take(side, side, depth_channels);
    probe.color = allocator.take(side, side, color_channels);
  }
  floats = allocator.length();
}

size_t FrameLayout::fused() const {
  size_t count = drawn_steps;
  for (const StepGroup& group : groups) count += group.count - 1;
  return count;
}

uint64_t shadow_bytes(const Plan& plan) {
  uint64_t bytes = 0;
  for (const backends::View& view : plan.frame.views)
    if (!view.target.has_color)
      bytes += sizeof(float) * static_cast<uint64_t>(view.target.width) * static_cast<uint64_t>(view.target.height);
  return bytes;
}

}  // namespace isoshade::render
