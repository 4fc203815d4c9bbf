// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/kept.h"

#include <algorithm>

namespace isoshade::render {

using backends::Slot;

namespace {

bool overlap(const Slot& a, const Slot& b) {
  return a.exists() && b.exists() && a.first < b.first + b.size() && b.first < a.first + a.size();
}

/// Whether another image of the frame shares the place of a view's.
bool is_overwritten(const FrameLayout& layout, size_t view) {
  std::vector<Slot> others{layout.motion, layout.drawn_motion.depth, layout.drawn_motion.color};
  for (size_t v = 0; v < layout.views.size(); ++v)
    if (v != view) others.insert(others.end(), {layout.views[v].depth, layout.views[v].color});
  others.insert(others.end(), layout.images.begin() + static_cast<ptrdiff_t>(layout.drawn_steps) + 1,
                layout.images.end());
  const FrameLayout::ViewImages& own = layout.views[view];
  return std::ranges::any_of(
      others, [&](const Slot& other) { return overlap(other, own.depth) || overlap(other, own.color); });
}

bool is_same(uint64_t a, uint64_t b) { return a == b && a != 0; }

/// Whether what a view reads of the frame, beyond what is its own, is known to be the same. A target without color does
/// not depend on lights. Where the maps of an environment begin is as the textures are.
bool has_same_arrays(const backends::Revisions& a, const backends::Revisions& b, bool has_color,
                     bool reads_time) {
  const auto& [programs, vertices, objects, lights, frame, texels, texel_bytes, textures] = a;
  return is_same(programs, b.programs) && is_same(vertices, b.vertices) && is_same(objects, b.objects) &&
         (!has_color || is_same(lights, b.lights)) && (!reads_time || is_same(frame, b.frame)) &&
         is_same(texels, b.texels) && is_same(texel_bytes, b.texel_bytes) && is_same(textures, b.textures);
}

}  // namespace

std::vector<DrawnFrame::Step> DrawnFrame::steps_of(const Plan& plan, size_t count) {
  std::vector<Step> steps;
  for (const PostStep& step : std::span(plan.posts.steps).first(count))
    steps.push_back({step.post->program.number, step.record, step.sources, step.width, step.height});
  return steps;
}

DrawnFrame::DrawnFrame(const Plan& plan, const FrameLayout& layout)
    : revisions_(plan.frame.revisions),
      steps_(steps_of(plan, plan.posts.steps.size())),
      drawn_steps_(layout.drawn_steps),
      floats_(layout.floats),
      samples_(plan.samples),
      result_(plan.posts.result),
      has_motion_(plan.motion.has_value()) {
  for (size_t v = 0; v < layout.views.size(); ++v)
    views_.push_back({plan.frame.views[v].revision, layout.views[v].depth, layout.views[v].color,
                      !is_overwritten(layout, v)});
}

std::vector<bool> DrawnFrame::views_of(const Plan& plan, const FrameLayout& layout) const {
  const std::vector<backends::View>& views = plan.frame.views;
  std::vector<bool> kept(views.size());
  // With other places, a view that is drawn might overwrite one that is kept.
  const auto is_in_place = [&](const DrawnView& drawn, const FrameLayout::ViewImages& now) {
    return drawn.depth == now.depth && drawn.color == now.color;
  };
  if (floats_ != layout.floats || samples_ != plan.samples ||
      !std::ranges::equal(views_, layout.views, is_in_place))
    return kept;
  for (size_t v = 0; v < views.size(); ++v) {
    const backends::View& view = views[v];
    const bool reads_the_same = std::ranges::all_of(
        view.reads, [&](size_t read) { return read == backends::View::nothing || kept[read]; });
    kept[v] =
        views_[v].is_whole && view.revision != 0 && view.revision == views_[v].revision && reads_the_same &&
        has_same_arrays(revisions_, plan.frame.revisions, view.target.has_color, plan.views_read_time) &&
        !is_overwritten(layout, v);
  }
  const std::span<const Step> before = std::span(steps_).first(drawn_steps_);
  const bool has_time = drawn_steps_ == 0 || is_same(revisions_.frame, plan.frame.revisions.frame);
  if (drawn_steps_ != layout.drawn_steps || !has_time ||
      !std::ranges::equal(before, steps_of(plan, drawn_steps_)))
    kept.back() = false;
  return kept;
}

bool DrawnFrame::has_posts_of(const Plan& plan, const FrameLayout& layout) const {
  return !has_motion_ && !plan.motion && is_same(revisions_.frame, plan.frame.revisions.frame) &&
         layout.drawn_steps == drawn_steps_ && result_ == plan.posts.result &&
         steps_ == steps_of(plan, plan.posts.steps.size());
}

}  // namespace isoshade::render
