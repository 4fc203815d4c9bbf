// SPDX-License-Identifier: Apache-2.0
#include "compiler/functions/domains.h"

namespace isoshade::functions {
namespace {

struct Domain {
  std::string_view tier, row, text;
};
constexpr Domain domains[] = {
#include "domains.inc"
};

std::string_view text_of(std::string_view row, Tier tier) {
  for (const Domain& domain : domains)
    if (domain.row == row && domain.tier == tier_name(tier)) return domain.text;
  return {};
}

}  // namespace

std::string_view domain_of(std::string_view row, Tier tier) {
  const std::string_view own = text_of(row, tier);
  return own.empty() ? text_of(row, Tier::standard) : own;
}

}  // namespace isoshade::functions
