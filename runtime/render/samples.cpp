// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/samples.h"

#include <algorithm>
#include <array>

#include "compiler/functions/blending.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/support/assert.h"
#include "runtime/raster/clip.h"
#include "runtime/raster/triangle.h"

namespace isoshade::render {
namespace {

using backends::Image;
using backends::Window;

/// The triangles that may cover a sample of the window.
void select_triangles(std::span<const int32_t> triangles, const Window& window,
                      std::vector<int32_t>& selected) {
  constexpr int stride = lower::triangle_word::stride;
  const raster::Box area = raster::box_at(window.x, window.y, window.width, window.height);
  const int count = static_cast<int>(triangles.size() / stride);
  selected.clear();
  for (int i = 0; i < count; ++i) {
    const raster::Triangle triangle = raster::triangle_at(triangles.data(), i);
    if (raster::bounds(triangle).within(area).empty() || !raster::Edges(triangle).reach(area)) continue;
    selected.insert(selected.end(), triangle.words, triangle.words + stride);
  }
}

/// The resolved image of a window without triangles.
void fill_with_background(const backends::View& view, int side, const Window& part, Image& resolved) {
  resolved.resize(side, side);
  for (size_t i = 0; i < resolved.depth.size(); ++i)
    std::ranges::copy(view.background, resolved.rgba.begin() + static_cast<ptrdiff_t>(4 * i));
  while (resolved.width > 1) halve(resolved);
  const std::array color{resolved.rgba[0], resolved.rgba[1], resolved.rgba[2], resolved.rgba[3]};
  resolved.resize(part.width, part.height);
  for (size_t i = 0; i < resolved.depth.size(); ++i)
    std::ranges::copy(color, resolved.rgba.begin() + static_cast<ptrdiff_t>(4 * i));
  std::ranges::fill(resolved.depth, 0.0f);
}

/// Copies the part into the image at (x, y).
void copy_part(const Image& part, int x, int y, Image& image) {
  const auto width = static_cast<ptrdiff_t>(part.width);
  for (int row = 0; row < part.height; ++row) {
    const ptrdiff_t from = row * width;
    const ptrdiff_t to = static_cast<ptrdiff_t>(y + row) * image.width + x;
    std::copy_n(part.rgba.begin() + 4 * from, 4 * width, image.rgba.begin() + 4 * to);
    std::copy_n(part.depth.begin() + from, width, image.depth.begin() + to);
  }
}

bool draw_parts(const backends::View& view, int side, std::span<const int32_t> triangles,
                backends::ViewRenderer& renderer, Image& image, DrawStats& stats,
                support::Diagnostics& diagnostics) {
  const int size = max_part_size / side;  // of a part, in pixels
  image.resize(view.target.width / side, view.target.height / side);
  std::vector<int32_t> selected;
  Image resolved;
  for (int y = 0; y < image.height; y += size) {
    for (int x = 0; x < image.width; x += size) {
      const Window part{x, y, std::min(size, image.width - x), std::min(size, image.height - y)};
      const Window window{side * part.x, side * part.y, side * part.width, side * part.height};
      ++stats.parts;
      select_triangles(triangles, window, selected);
      if (selected.empty()) {
        ++stats.empty_parts;
        fill_with_background(view, side, part, resolved);
      } else {
        if (!renderer.draw(window, selected, resolved, diagnostics)) return false;
        while (resolved.width > part.width) halve(resolved);
      }
      copy_part(resolved, x, y, image);
    }
  }
  return true;
}

/// The same in windows as wide as the picture, whose samples are processed before they are resolved.
bool draw_rows(const backends::ViewPass& pass, int side, std::span<const float> vertices,
               std::span<const int32_t> triangles, const ProcessSamples& process, backends::Backend& backend,
               Image& image, DrawStats& stats, support::Diagnostics& diagnostics) {
  const backends::Target& target = pass.view.target;
  image.resize(target.width / side, target.height / side);
  const int rows = std::max(1, max_part_size * max_part_size / (target.width * side));
  std::vector<int32_t> selected;
  for (int y = 0; y < image.height; y += rows) {
    const Window window{0, side * y, target.width, side * std::min(rows, image.height - y)};
    ++stats.parts;
    select_triangles(triangles, window, selected);
    Image samples;
    {
      // The backend is used otherwise below.
      const auto renderer = backend.begin(pass, vertices, diagnostics);
      if (renderer == nullptr || !renderer->draw(window, selected, samples, diagnostics)) return false;
    }
    if (!process(window.y, samples)) return false;
    while (samples.width > image.width) halve(samples);
    copy_part(samples, 0, y, image);
  }
  return true;
}

bool is_not_finite(const Image& image, int x, int y) {
  const size_t pixel = static_cast<size_t>(y) * static_cast<size_t>(image.width) + static_cast<size_t>(x);
  return find_non_finite(std::span(image.rgba).subspan(4 * pixel, 4), 1).count > 0;
}

/// Counts the pixels of the image that are not finite, and finds the object that the first of them shows by drawing its
/// samples again.
bool note_non_finite(int side, std::span<const int32_t> triangles, backends::ViewRenderer& renderer,
                     const Image& image, NonFiniteReport& report, support::Diagnostics& diagnostics) {
  report.drawn = report.result = find_non_finite(image.rgba, image.width);
  if (report.drawn.count == 0) return true;
  const Window pixel{side * report.drawn.x, side * report.drawn.y, side, side};
  std::vector<int32_t> selected;
  select_triangles(triangles, pixel, selected);
  Image drawn;
  if (!renderer.draw(pixel, selected, drawn, diagnostics)) return false;
  const NonFinite sample = find_non_finite(drawn.rgba, side);
  if (sample.count == 0) {
    report.drawn = {};  // a post that is run for each sample made them
    return true;
  }
  // What is blended over a sample that is not finite is not finite either, so the first triangle that makes it so is
  // found by halves.
  constexpr size_t stride = lower::triangle_word::stride;
  const auto draw_first = [&](size_t count) {
    return renderer.draw(pixel, std::span(selected).first(count * stride), drawn, diagnostics);
  };
  const auto is_finite = [&] { return !is_not_finite(drawn, sample.x, sample.y); };
  const size_t count = selected.size() / stride;
  const auto opaque = static_cast<size_t>(raster::opaque_count(selected.data(), static_cast<int>(count)));
  size_t good = opaque, bad = count;
  if (opaque < count && !draw_first(opaque)) return false;
  if (opaque < count && is_finite()) {
    while (bad - good > 1) {
      const size_t middle = good + (bad - good) / 2;
      if (!draw_first(middle)) return false;
      (is_finite() ? good : bad) = middle;
    }
    report.object = raster::triangle_at(selected.data(), static_cast<int>(bad - 1)).object();
    return true;
  }
  const float depth = drawn.depth[static_cast<size_t>(sample.y) * static_cast<size_t>(side) + static_cast<size_t>(sample.x)];
  report.object = object_at(selected, pixel.x + sample.x, pixel.y + sample.y, depth);
  return true;
}

}  // namespace

bool check_samples(const scene::Scene& scene, int width, int height, support::Diagnostics& diagnostics) {
  const int largest = raster::max_image_size / samples_each_way(scene.samples);
  if (std::max(width, height) <= largest) return true;
  diagnostics
      .report(support::Id::too_large, scene.samples_where,
              "an image of " + std::to_string(scene.samples) + " samples a pixel has at most " +
                  std::to_string(largest) + " pixels each way, and this one has " + std::to_string(width) +
                  "x" + std::to_string(height))
      .suggest("ask for fewer samples, or a smaller size");
  return false;
}

void halve(Image& image) {
  const lanes::FpGuard guard;
  using Color = lanes::Float<4, 1>;
  const auto wide = static_cast<size_t>(image.width);
  const size_t width = wide / 2, height = static_cast<size_t>(image.height) / 2;
  // In place: a pixel overwrites only samples that have been read.
  for (size_t y = 0; y < height; ++y) {
    for (size_t x = 0; x < width; ++x) {
      const size_t upper = 2 * y * wide + 2 * x, lower = upper + wide;
      const auto color = [&](size_t at) { return lanes::load_lanes<Color>(image.rgba.data() + 4 * at); };
      const auto depth = [&](size_t at) { return image.depth[at]; };
      const auto mean = [&](const auto& of) {
        return functions::mean_of_four(of(upper), of(upper + 1), of(lower), of(lower + 1));
      };
      lanes::store_lanes(image.rgba.data() + 4 * (y * width + x), mean(color));
      image.depth[y * width + x] = mean(depth);
    }
  }
  image.resize(static_cast<int>(width), static_cast<int>(height));
}

bool draw(const backends::ViewPass& pass, int samples, std::span<const float> vertices,
          std::span<const int32_t> triangles, const ProcessSamples& process, backends::Backend& backend,
          Image& image, DrawStats& stats, support::Diagnostics& diagnostics) {
  const backends::Target& target = pass.view.target;
  const int side = samples_each_way(samples);
  support::assert_that(target.has_color || side == 1, "several samples of a target without color");
  const bool in_rows = side > 1 && process;
  if (in_rows && !draw_rows(pass, side, vertices, triangles, process, backend, image, stats, diagnostics))
    return false;
  const auto renderer = backend.begin(pass, vertices, diagnostics);
  if (renderer == nullptr) return false;
  const bool drawn = in_rows || (side == 1 ? renderer->draw({0, 0, target.width, target.height}, triangles, image, diagnostics)
                                           : draw_parts(pass.view, side, triangles, *renderer, image, stats, diagnostics));
  const bool is_picture = &pass.view == &pass.frame.picture();
  return drawn &&
         (!is_picture || note_non_finite(side, triangles, *renderer, image, stats.non_finite, diagnostics));
}

}  // namespace isoshade::render
