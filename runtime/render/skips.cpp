// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/skips.h"

#include <algorithm>
#include <string>
#include <utility>

#include "runtime/scene/placement.h"

namespace isoshade::render {

void report_skips(const scene::Object& object, const driver::Effect& effect, int64_t parts,
                  std::span<const PassSkips> passes, std::vector<Skipped>& skips) {
  const int64_t copies = scene::instance_count(object);
  /// `count` of `total`, called `unit`.
  const auto report = [&](std::optional<interface::Skip> skip, int64_t count, int64_t total, const std::string& unit,
                          const std::string& pass, std::string reason) {
    if (count == 0) return;
    const std::string what = total == 1 ? object.name
                                        : std::to_string(count) + " of " + std::to_string(total) + " " +
                                              unit + " of " + object.name;
    skips.push_back({skip, pass.empty() ? what : pass + " of " + what, std::move(reason), object.name});
  };
  const bool alike = std::ranges::all_of(
      passes, [&](const PassSkips& pass) { return pass.unseen == passes.front().unseen; });
  if (alike) report(interface::Skip::objects, passes.front().unseen, copies, "copies", "", "outside of the view");
  for (size_t p = 0; p < passes.size(); ++p) {
    const driver::EffectPass& pass = effect.passes[p];
    if (!alike) report(interface::Skip::objects, passes[p].unseen, copies, "copies", pass.name, "outside of the view");
    const std::string unit = parts == 1 ? "copies" : "parts";
    if (pass.cutoff) {
      const driver::Field& field = effect.parameters.fields[*pass.cutoff];
      report({}, passes[p].uncut, copies * parts, unit, "cut-out of " + pass.name, field.name + " is not above 0");
    }
    if (!pass.enabled) continue;
    const driver::Field& field = effect.parameters.fields[*pass.enabled];
    report({}, passes[p].disabled, copies * parts, unit, pass.name,
           field.name + " is " + (field.type == "boolean" ? "false" : "0"));
  }
}

void report_tiles(const backends::TileCounts& counts, std::vector<Skipped>& skips) {
  const auto report = [&](int64_t count, int64_t total, const std::string& unit, std::string reason) {
    if (count == 0) return;
    const std::string what = std::to_string(count) + " of " + std::to_string(total) + " " + unit;
    skips.push_back({interface::Skip::tiles, what, std::move(reason)});
  };
  report(counts.empty - counts.kept, counts.tiles, "tiles", "nothing covers them");
  report(counts.kept, counts.tiles, "tiles", "nothing covers them, as in the frame before");
  report(counts.blocks_of_one_object, counts.blocks, "blocks of pixels", "each shows one object");
}

}  // namespace isoshade::render
