// SPDX-License-Identifier: Apache-2.0
#include "compiler/nodes/table.h"

#include <algorithm>
#include <unordered_map>

#include "compiler/functions/library.h"
#include "compiler/support/assert.h"

namespace isoshade::nodes {
namespace {

struct Domain {
  std::string_view node, text, function;
};
constexpr Domain domains[] = {
#define DOMAIN(node, text) {#node, text, ""},
#define AS(node, row) {#node, "", #row},
#include "compiler/nodes/domains.def"
};

}  // namespace

const std::vector<Row>& table() {
  static const std::vector<Row> rows = [] {
    std::vector<Row> all;
    const auto add = [&](std::string_view group, std::vector<Row> rows) {
      for (Row& row : rows) {
        row.group = group;
        all.push_back(std::move(row));
      }
    };
    add("structure", structure_rows());
    add("math", math_rows());
    add("vector", vector_rows());
    add("logic", logic_rows());
    add("color", color_rows());
    add("procedural", procedural_rows());
    add("texture", texture_rows());
    add("geometry", geometry_rows());
    add("light", light_rows());
    add("screen", screen_rows());
    return all;
  }();
  return rows;
}

const Row* find(std::string_view name) {
  static const std::unordered_map<std::string_view, const Row*> by_name = [] {
    std::unordered_map<std::string_view, const Row*> map;
    for (const Row& row : table()) support::assert_that(map.emplace(row.name, &row).second, row.name);
    return map;
  }();
  const auto found = by_name.find(name);
  return found == by_name.end() ? nullptr : found->second;
}

std::string_view domain_of(const Row& row, functions::Tier tier) {
  if (const auto* function = std::get_if<Function>(&row.lowering))
    return functions::domain_of(function->row, tier);
  const auto found = std::ranges::find(domains, row.name, &Domain::node);
  if (found == std::end(domains)) return {};
  return found->function.empty() ? found->text : functions::domain_of(found->function, tier);
}

}  // namespace isoshade::nodes
