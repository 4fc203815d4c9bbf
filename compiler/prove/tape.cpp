// SPDX-License-Identifier: Apache-2.0
// The tape of a whole function: its calls are inlined, and the operations put in order.
#include "compiler/prove/tape.h"

#include "compiler/functions/library.h"
#include "compiler/prove/flatten.h"

namespace isoshade::prove {
namespace {

/// Gives bodies to the declarations of library functions, and only to those.
void give_bodies(ir::Module& module, functions::Tier tier) {
  for (uint32_t i = 0; i < module.functions.size(); ++i) {
    if (!module.functions[i].is_declaration() || module.functions[i].library.empty()) continue;
    const functions::Variant& variant = functions::variant_of(module.functions[i]);
    ir::Builder builder(module, i);
    variant.body(tier)(builder);
  }
}

}  // namespace

std::optional<Tape> make_tape(const ir::Module& module, uint32_t function, const std::vector<Given>& given,
                              const std::function<std::vector<Given>(uint32_t)>& outside, functions::Tier tier) {
  Tape tape;
  tape.tier = tier;
  tape.module = module;
  give_bodies(tape.module, tier);
  Pool pool(tape);
  if (!flatten(pool, function, given, outside)) return std::nullopt;
  put_in_order(pool);
  return tape;
}

}  // namespace isoshade::prove
