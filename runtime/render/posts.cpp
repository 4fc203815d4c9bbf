// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/posts.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "compiler/lower/frame_layout.h"
#include "compiler/support/memory.h"
#include "compiler/support/visible.h"
#include "runtime/render/parameters.h"
#include "runtime/render/records.h"
#include "runtime/render/samples.h"

namespace isoshade::render {
namespace {

using support::Diagnostics;
using support::Id;
using support::quote;

/// A side of an image that is this fraction of another side; exact, as a double holds the product.
int part_of(int side, float part) {
  return static_cast<int>(std::ceil(static_cast<double>(side) * static_cast<double>(part)));
}

class ChainPlanner {
 public:
  ChainPlanner(const scene::Scene& scene, const std::vector<const driver::Post*>& documents, int width,
               int height, bool skip, std::vector<Skip>& skips, Diagnostics& diagnostics)
      : scene_(scene),
        documents_(documents),
        width_(width),
        height_(height),
        skip_(skip),
        skips_(skips),
        diagnostics_(diagnostics) {}

  std::optional<PostChain> plan();

 private:
  /// An image before it is known which posts run: that of a post of the scene, or scene::scene_image.
  struct Planned {
    std::vector<float> record;
    std::vector<int> sources;
    bool runs = true;
  };

  bool read_post(size_t p);
  bool find_sources(size_t p, Planned& planned);
  /// The image that results when posts that are switched off pass on the image that they would process.
  int passed_on(int image) const;
  void drop_unread();
  bool check_result(int result) const;
  bool check_size(const PostChain& chain) const;
  size_t count_sample_steps(const PostChain& chain) const;

  const scene::Scene& scene_;
  const std::vector<const driver::Post*>& documents_;
  int width_, height_;
  bool skip_;
  std::vector<Skip>& skips_;
  Diagnostics& diagnostics_;
  std::vector<Planned> planned_;
};

bool ChainPlanner::find_sources(size_t p, Planned& planned) {
  const scene::Post& post = scene_.posts[p];
  const driver::Post& document = *documents_[p];
  bool good = true;
  planned.sources.assign(1 + document.images.size(), scene::no_image);
  if (document.motion) planned.sources[1 + *document.motion] = scene::motion_image;
  planned.sources[0] = p == 0 ? scene::scene_image : static_cast<int>(p) - 1;
  std::vector<std::string_view> names{graph::post_output};
  names.insert(names.end(), document.images.begin(), document.images.end());
  for (const scene::PostInput& input : post.inputs) {
    const auto found = std::ranges::find(names, input.image);
    if (found == names.end()) {
      std::string list;
      for (const std::string_view name : names) list.append(list.empty() ? "" : ", ").append(name);
      diagnostics_
          .report_unknown(Id::unknown_image, input.image_where,
                          "the document of post " + quote(post.name) + " has no image " + quote(input.image),
                          input.image, names)
          .note("it has " + list);
      good = false;
    } else {
      planned.sources[static_cast<size_t>(found - names.begin())] = input.source;
    }
  }
  for (size_t i = 0; i < planned.sources.size(); ++i) {
    if (planned.sources[i] != scene::no_image) continue;
    diagnostics_
        .report(Id::unknown_image, post.name_where,
                "post " + quote(post.name) + " has no input for the image " + quote(names[i]))
        .suggest("write \"inputs\": {\"" + std::string(names[i]) +
                 "\": \"scene\"}, or the name of an earlier post");
    good = false;
  }
  return good;
}

bool ChainPlanner::read_post(size_t p) {
  Planned& planned = planned_.emplace_back();
  const bool has_sources = find_sources(p, planned);
  const scene::Post& post = scene_.posts[p];
  const driver::Post& document = *documents_[p];
  const auto values =
      ParameterValues::resolve(document.parameters, {post.name, post.parameters}, {}, diagnostics_);
  if (!values || !has_sources) return false;
  planned.record = values->words({}, {});
  const bool has_image = planned.sources[0] != scene::motion_image;  // one that it could pass on
  if (!skip_ || !has_image || !document.parameters.is_off(document.enabled, planned.record)) return true;
  planned.runs = false;
  const std::string& parameter = document.parameters.fields[*document.enabled].name;
  skips_.push_back({"post " + post.name, parameter + " is 0"});
  return true;
}

int ChainPlanner::passed_on(int image) const {
  while (image >= 0 && !planned_[static_cast<size_t>(image)].runs)
    image = planned_[static_cast<size_t>(image)].sources[0];
  return image;
}

/// Drops the posts, from the last one backwards, whose images neither a post that runs nor the scene's result uses.
void ChainPlanner::drop_unread() {
  std::vector<bool> read(planned_.size());
  const auto mark = [&](int image) {
    if (const int real = passed_on(image); real >= 0) read[static_cast<size_t>(real)] = true;
  };
  mark(static_cast<int>(planned_.size()) - 1);
  for (size_t p = planned_.size(); p-- > 0;) {
    Planned& planned = planned_[p];
    if (!planned.runs) continue;
    if (!read[p]) {
      planned.runs = false;
      skips_.push_back({"post " + scene_.posts[p].name, "nothing reads its image"});
      continue;
    }
    for (size_t i = 0; i < planned.sources.size(); ++i)
      if (documents_[p]->reads[i]) mark(planned.sources[i]);
  }
}

bool ChainPlanner::check_result(int result) const {
  if (result == scene::scene_image) return true;
  const scene::Post& post = scene_.posts[static_cast<size_t>(result)];
  if (part_of(width_, post.size) == width_ && part_of(height_, post.size) == height_) return true;
  diagnostics_
      .report(Id::out_of_range, post.size_where,
              "post " + quote(post.name) + " makes the scene's image, but not at full size")
      .suggest("leave out its \"size\", or add a post after it");
  return false;
}

/// Counts the images that run_posts keeps at a time.
bool ChainPlanner::check_size(const PostChain& chain) const {
  std::vector<int64_t> kept{static_cast<int64_t>(width_) * height_};
  for (size_t s = 0; s < chain.steps.size(); ++s) {
    kept.push_back(static_cast<int64_t>(chain.steps[s].width) * chain.steps[s].height);
    if (std::accumulate(kept.begin(), kept.end(), int64_t{0}) > max_kept_pixels) {
      diagnostics_
          .report(Id::too_large, scene_.posts.back().name_where,
                  "the images of the posts have more than " + std::to_string(max_kept_pixels) +
                      " pixels at a time")
          .suggest("let posts read images that were made just before them");
      return false;
    }
    for (size_t i = 0; i < kept.size(); ++i)
      if (i <= s && chain.is_done(i, s)) kept[i] = 0;
  }
  return true;
}

size_t ChainPlanner::count_sample_steps(const PostChain& chain) const {
  size_t count = 0;
  for (size_t s = 0; s < chain.steps.size(); ++s) {
    const PostStep& step = chain.steps[s];
    const auto image = static_cast<int>(s);
    const bool is_alone = chain.result != image && chain.last_reader[s] <= image;
    const bool is_whole = step.width == width_ && step.height == height_;
    const bool follows = step.sources[0] == image || step.sources[0] == PostStep::not_read;
    if (!step.post->is_pointwise || !is_alone || !is_whole || !follows) break;
    if (step.post->reads_depth) count = s + 1;
  }
  return count;
}

std::optional<PostChain> ChainPlanner::plan() {
  PostChain chain;
  bool good = true;
  for (size_t p = 0; p < scene_.posts.size() && !diagnostics_.full(); ++p) good = read_post(p) && good;
  if (!good || diagnostics_.full()) return std::nullopt;
  const int result = passed_on(static_cast<int>(planned_.size()) - 1);
  if (!check_result(result)) return std::nullopt;
  if (skip_) drop_unread();

  std::vector<int> number(planned_.size());
  const auto number_of = [&](int image) {
    const int real = passed_on(image);
    if (real == scene::motion_image) return PostStep::motion;
    return real == scene::scene_image ? 0 : number[static_cast<size_t>(real)];
  };
  chain.last_reader.push_back(PostChain::none);
  for (size_t p = 0; p < planned_.size(); ++p) {
    if (!planned_[p].runs) continue;
    const int this_step = static_cast<int>(chain.steps.size());
    number[p] = this_step + 1;
    PostStep step{documents_[p],
                  std::move(planned_[p].record),
                  part_of(width_, scene_.posts[p].size),
                  part_of(height_, scene_.posts[p].size),
                  {},
                  p};
    for (size_t i = 0; i < planned_[p].sources.size(); ++i) {
      const bool reads = documents_[p]->reads[i];
      step.sources.push_back(reads ? number_of(planned_[p].sources[i]) : PostStep::not_read);
      if (reads && step.sources.back() != PostStep::motion) chain.last_reader[static_cast<size_t>(step.sources.back())] = this_step;
    }
    chain.steps.push_back(std::move(step));
    chain.last_reader.push_back(PostChain::none);
  }
  chain.result = number_of(static_cast<int>(planned_.size()) - 1);
  if (!check_size(chain)) return std::nullopt;
  chain.sample_steps = count_sample_steps(chain);
  return chain;
}

/// An image between the drawing and the end of the chain.
struct Layer {
  int width = 0, height = 0;
  std::vector<float> rgba;
  bool finite = true;
};

/// Reports pixels of a step's image that are not finite, and whether the step caused them.
void note_non_finite(const PostStep& step, const std::vector<Layer>& layers, Layer& made,
                     NonFiniteReport& report) {
  report.result = find_non_finite(made.rgba, made.width);
  made.finite = report.result.count == 0;
  const bool read_finite = std::ranges::all_of(step.sources, [&](int source) {
    return source < 0 || layers[static_cast<size_t>(source)].finite;
  });
  if (!made.finite && read_finite) report.posts.push_back({step.post_number, report.result});
}

/// The images that a step reads.
Layers layers_of(const PostStep& step, const std::vector<Layer>& images, const backends::Image& image,
                 const backends::Image& motion) {
  Layers layers(step.width, step.height);
  if (step.post->reads_depth)
    layers.add(image.depth, image.width, image.height);
  else
    layers.add_unread(image.width, image.height);
  for (size_t i = 0; i < step.sources.size(); ++i) {
    const int source = step.sources[i];
    const auto same = static_cast<size_t>(std::ranges::find(step.sources, source) - step.sources.begin());
    if (source == PostStep::not_read) {
      layers.add_unread();
    } else if (same < i) {
      layers.add_again(lower::image_record::color + same);
    } else if (source == PostStep::motion) {
      layers.add(motion.rgba, motion.width, motion.height);
    } else {
      const Layer& read = images[static_cast<size_t>(source)];
      layers.add(read.rgba, read.width, read.height);
    }
  }
  return layers;
}

/// The pass of a step over its whole image.
backends::ScreenPass pass_of(const PostStep& step, const backends::Frame& frame, const Layers& arrays) {
  return {.program = &step.post->program,
          .width = step.width,
          .height = step.height,
          .frame = frame.frame,
          .view = std::span(frame.picture().words).first(lower::view_word::camera_words),
          .record = step.record,
          .layers = arrays.floats,
          .layer_records = arrays.records,
          .textures = step.post->reads_environment ? &frame : nullptr};
}

}  // namespace

std::optional<PostChain> plan_posts(const scene::Scene& scene,
                                    const std::vector<const driver::Post*>& documents, int width, int height,
                                    bool skip, std::vector<Skip>& skips, Diagnostics& diagnostics) {
  return ChainPlanner(scene, documents, width, height, skip, skips, diagnostics).plan();
}

bool run_sample_posts(const PostChain& chain, const backends::Frame& frame, int first_row, backends::Backend& backend,
                      backends::Image& samples, DrawStats& stats, Diagnostics& diagnostics) {
  std::vector<NonFiniteReport::Post>& reports = stats.non_finite.posts;
  bool was_finite = find_non_finite(samples.rgba, samples.width).count == 0;
  const backends::View& view = frame.picture();
  const int width = view.target.width, height = view.target.height;
  for (size_t s = 0; s < chain.sample_steps; ++s) {
    const PostStep& step = chain.steps[s];
    Layers arrays(width, height);
    const auto add = [&](bool is_read, std::span<const float> rows, int channels) {
      if (is_read)
        arrays.add_rows(rows, channels, width, height, first_row);
      else
        arrays.add_unread(width, height);
    };
    add(step.post->reads_depth, samples.depth, 1);
    add(step.sources[0] != PostStep::not_read, samples.rgba, 4);
    backends::ScreenPass pass = pass_of(step, frame, arrays);
    pass.width = width;
    pass.height = samples.height;
    pass.first_row = first_row;
    if (!backend.post(pass, samples.rgba, diagnostics)) return false;
    NonFinite made = find_non_finite(samples.rgba, width);
    const bool is_known = std::ranges::find(reports, step.post_number, &NonFiniteReport::Post::post) != reports.end();
    if (was_finite && made.count > 0 && !is_known) {
      const int side = samples_each_way(stats.samples);
      made.x /= side;
      made.y = (first_row + made.y) / side;
      reports.push_back({step.post_number, made});
    }
    was_finite = made.count == 0;
  }
  return true;
}

bool run_posts(const PostChain& chain, size_t first, const backends::Frame& frame, const backends::Image& motion,
               backends::Backend& backend, backends::Image& image, DrawStats& stats, Diagnostics& diagnostics) {
  if (first == chain.steps.size()) return true;
  std::vector<Layer> layers(1 + chain.steps.size());
  layers[first] = {image.width, image.height, std::move(image.rgba), stats.non_finite.result.count == 0};
  int64_t kept = 1;
  for (size_t s = first; s < chain.steps.size(); ++s) {
    const PostStep& step = chain.steps[s];
    Layer& made = layers[s + 1];
    made.width = step.width;
    made.height = step.height;
    stats.kept_images = std::max(stats.kept_images, ++kept);
    {
      const Layers arrays = layers_of(step, layers, image, motion);
      const backends::ScreenPass pass = pass_of(step, frame, arrays);
      if (!backend.post(pass, made.rgba, diagnostics)) return false;
    }
    note_non_finite(step, layers, made, stats.non_finite);
    for (size_t i = 0; i <= s; ++i) {
      if (!chain.is_done(i, s) || layers[i].rgba.empty()) continue;
      support::release(layers[i].rgba);
      --kept;
    }
  }
  image.rgba = std::move(layers[static_cast<size_t>(chain.result)].rgba);
  return true;
}

}  // namespace isoshade::render
