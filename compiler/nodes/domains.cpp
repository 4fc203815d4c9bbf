// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "compiler/functions/library.h"
#include "compiler/nodes/table.h"

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

std::string_view domain_of(const Row& row, functions::Tier tier) {
  if (const auto* function = std::get_if<Function>(&row.lowering))
    return functions::domain_of(function->row, tier);
  const auto found = std::ranges::find(domains, row.name, &Domain::node);
  if (found == std::end(domains)) return {};
  return found->function.empty() ? found->text : functions::domain_of(found->function, tier);
}

}  // namespace isoshade::nodes
