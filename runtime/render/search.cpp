// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/search.h"

#include "compiler/lower/frame_layout.h"
#include "runtime/raster/bins.h"
#include "runtime/raster/triangle.h"

namespace isoshade::render {
namespace {

constexpr size_t stride = lower::triangle_word::stride;

}  // namespace

bool find_object(backends::Backend& backend, const backends::Drawing& drawing, const FrameLayout::ViewImages& probe,
                 NonFiniteReport& report, support::Diagnostics& diagnostics) {
  const int side = drawing.side;
  backends::Drawing pixel = drawing;
  pixel.window = {side * report.drawn.x, side * report.drawn.y, side, side};
  pixel.side = 1;
  pixel.depth = probe.depth;
  pixel.color = probe.color;
  const std::vector<int32_t> selected = 
      raster::triangles_within(drawing.triangles, raster::box_at(pixel.window.x, pixel.window.y, side, side));
  const auto draw_first = [&](size_t count) {
    pixel.triangles = std::span(selected).first(count * stride);
    return backend.draw(pixel, diagnostics);
  };
  const size_t count = selected.size() / stride;
  if (!draw_first(count)) return false;
  const NonFinite sample = find_non_finite(backend.read(probe.color), side);
  if (sample.count == 0) return true;  // the mean of finite samples
  const auto place = static_cast<size_t>(sample.y) * static_cast<size_t>(side) + static_cast<size_t>(sample.x);
  const float depth = backend.read(probe.depth)[place];
  const auto is_finite = [&] { return find_non_finite(backend.read(probe.color).subspan(4 * place, 4), 1).count == 0; };
  // What is blended over a sample that is not finite is not finite either, so the first triangle that makes it so is found
  // by halves.
  const auto opaque = static_cast<size_t>(raster::opaque_count(selected.data(), static_cast<int>(count)));
  if (opaque < count) {
    if (!draw_first(opaque)) return false;
    if (is_finite()) {
      size_t good = opaque, bad = count;
      while (bad - good > 1) {
        const size_t middle = good + (bad - good) / 2;
        if (!draw_first(middle)) return false;
        (is_finite() ? good : bad) = middle;
      }
      report.object = raster::triangle_at(selected.data(), static_cast<int>(bad - 1)).object();
      return true;
    }
  }
  const float opaque_depth = opaque < count ? backend.read(probe.depth)[place] : depth;
  report.object = object_at(selected, pixel.window.x + sample.x, pixel.window.y + sample.y, opaque_depth);
  return true;
}

}  // namespace isoshade::render
