// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/finite.h"

#include <algorithm>
#include <bit>
#include <fmt/format.h>
#include <memory>

#include "compiler/support/assert.h"
#include "compiler/support/visible.h"
#include "runtime/lanes/float_rules.h"
#include "runtime/raster/tile.h"
#include "runtime/raster/triangle.h"
#include "runtime/render/plan.h"

namespace isoshade::render {
namespace {

using support::Id;
using support::quote;

constexpr uint32_t exponent_bits = 0x7f800000;

bool is_finite(const float* pixel) {
  bool finite = true;
  for (int c = 0; c < 4; ++c)
    finite = finite && (std::bit_cast<uint32_t>(pixel[c]) & exponent_bits) != exponent_bits;
  return finite;
}

constexpr std::string_view way_out = "`isoshade check` finds the operation that gives no finite number";

/// "3 of 64 pixels are infinite or NaN"
std::string count_of(const NonFinite& found, const Plan& plan) {
  const backends::Target& target = plan.frame.picture().target;
  const int64_t pixels = int64_t{target.width} * target.height / plan.samples;
  return fmt::format("{} of {} pixels {} infinite or NaN", found.count, pixels, found.count == 1 ? "is" : "are");
}

support::Diagnostic& warn_drawn(const scene::Scene& scene, const Plan& plan, const NonFiniteReport& report,
                                support::Diagnostics& diagnostics) {
  const NonFinite& drawn = report.drawn;
  const std::string found = count_of(drawn, plan) + fmt::format("; the first, at ({}, {}), ", drawn.x, drawn.y);
  // Finite samples may be so large that their mean is not.
  if (report.object < 0) return diagnostics.report(Id::not_finite, found + "is the mean of finite samples");
  const auto origin = std::ranges::lower_bound(plan.origins, report.object, {}, &RecordOrigin::record);
  support::assert_that(origin != plan.origins.end() && origin->record == report.object,
                       "a record of no object");
  const scene::Object& object = scene.objects[origin->object];
  return diagnostics
      .report(Id::not_finite, object.name_where,
              found + "shows object " + quote(object.name) + ", pass " + quote(origin->pass->name) + " of " +
                  quote(object.effect))
      .suggest(std::string(way_out));
}

support::Diagnostic& warn_post(const scene::Post& post, const NonFinite& made,
                               support::Diagnostics& diagnostics) {
  return diagnostics
      .report(Id::not_finite, post.name_where,
              "in the image of post " + quote(post.name) + " " + fmt::format("{} pixels are", made.count) +
                  fmt::format(" infinite or NaN, and in what it reads none; the first is at ({}, {})", made.x, made.y))
      .suggest(std::string(way_out));
}

}  // namespace

NonFinite find_non_finite(std::span<const float> rgba, int width) {
  NonFinite found;
  for (size_t i = 0; i < rgba.size(); i += 4) {
    if (is_finite(&rgba[i])) continue;
    if (found.count++ > 0) continue;
    found.x = static_cast<int>(i / 4 % static_cast<size_t>(width));
    found.y = static_cast<int>(i / 4 / static_cast<size_t>(width));
  }
  return found;
}

int object_at(std::span<const int32_t> triangles, int x, int y, float depth) {
  const lanes::FpGuard guard;
  const raster::Box sample = raster::box_at(x, y, 1, 1);
  const int count =
      raster::opaque_count(triangles.data(), static_cast<int>(triangles.size() / lower::triangle_word::stride));
  std::vector<int32_t> reaching;
  for (int i = 0; i < count; ++i)
    if (!raster::bounds(raster::triangle_at(triangles.data(), i)).within(sample).empty()) reaching.push_back(i);
  const auto tile = std::make_unique<raster::Tile>();
  constexpr int place = raster::tile_index(0, 0);
  while (true) {
    tile->clear();
    raster::rasterize_tile(triangles.data(), reaching, x, y, *tile);
    const int32_t seen = tile->triangles[place];
    if (seen < 0) return -1;
    const raster::Triangle triangle = raster::triangle_at(triangles.data(), seen);
    if (!triangle.cutout() || tile->depth[place] == depth) return triangle.object();
    std::erase(reaching, seen);  // the sample lies in a hole of it
  }
}

void warn_non_finite(const scene::Scene& scene, const Plan& plan, const NonFiniteReport& report,
                     support::Diagnostics& diagnostics) {
  const auto tell_result = [&](support::Diagnostic& warning) {
    if (!plan.posts.steps.empty()) warning.note("after the posts " + count_of(report.result, plan));
  };
  if (report.drawn.count > 0) tell_result(warn_drawn(scene, plan, report, diagnostics));
  for (const NonFiniteReport::Post& made : report.posts)
    tell_result(warn_post(scene.posts[made.post], made.made, diagnostics));
}

}  // namespace isoshade::render
