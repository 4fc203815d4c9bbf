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
               int height, interface::Skips skips, std::vector<Skipped>& skipped, Diagnostics& diagnostics)
      : scene_(scene),
        documents_(documents),
        width_(width),
        height_(height),
        skip_(skips.has(interface::Skip::posts)),
        skipped_(skipped),
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
  /// The image that results when posts that do not run pass on the image that they would process.
  int passed_on(int image) const;
  /// Of the posts that run.
  PostChain chain() const;
  void drop_unread();
  bool check_result(int result) const;
  bool check_size(const PostChain& chain) const;
  /// Of a chain of all posts, whether they are switched off or not: or a value would change what the others do.
  size_t count_sample_steps(const PostChain& chain) const;

  const scene::Scene& scene_;
  const std::vector<const driver::Post*>& documents_;
  int width_, height_;
  bool skip_;
  std::vector<Skipped>& skipped_;
  Diagnostics& diagnostics_;
  std::vector<Planned> planned_;
  std::vector<size_t> switched_off_;
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
  switched_off_.push_back(p);
  const std::string& parameter = document.parameters.fields[*document.enabled].name;
  skipped_.push_back({interface::Skip::posts, "post " + post.name, parameter + " is 0"});
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
      skipped_.push_back({interface::Skip::posts, "post " + scene_.posts[p].name, "nothing reads its image"});
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

PostChain ChainPlanner::chain() const {
  PostChain chain;
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
                  planned_[p].record,
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
  return chain;
}

std::optional<PostChain> ChainPlanner::plan() {
  bool good = true;
  for (size_t p = 0; p < scene_.posts.size() && !diagnostics_.full(); ++p) good = read_post(p) && good;
  if (!good || diagnostics_.full()) return std::nullopt;
  const size_t of_samples = count_sample_steps(chain());
  for (const size_t p : switched_off_) planned_[p].runs = false;
  const int result = passed_on(static_cast<int>(planned_.size()) - 1);
  if (!check_result(result)) return std::nullopt;
  if (skip_) drop_unread();
  PostChain made = chain();
  if (!check_size(made)) return std::nullopt;
  made.sample_steps = static_cast<size_t>(
      std::ranges::count_if(made.steps, [&](const PostStep& step) { return step.post_number < of_samples; }));
  return made;
}

}  // namespace

std::optional<PostChain> plan_posts(const scene::Scene& scene,
                                    const std::vector<const driver::Post*>& documents, int width, int height,
                                    interface::Skips skips, std::vector<Skipped>& skipped, Diagnostics& diagnostics) {
  return ChainPlanner(scene, documents, width, height, skips, skipped, diagnostics).plan();
}

}  // namespace isoshade::render
