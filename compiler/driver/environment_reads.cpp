// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/environment_reads.h"

#include <bit>

namespace isoshade::driver {

using check::Operand;

EnvironmentReads environment_reads(const check::TypedGraph& typed) {
  EnvironmentReads reads;
  reads.any = typed.needs(check::StageNeed::environment);
  if (!reads.any) return reads;
  for (const check::Node& node : typed.nodes) {
    if (node.row == nullptr) {
      reads.blurred |= node.callee->needs(check::StageNeed::environment);
      continue;
    }
    const auto* const what = std::get_if<nodes::Environment>(&node.row->lowering);
    if (what == nullptr) continue;
    if (*what == nodes::Environment::irradiance) {
      reads.blurred = true;
      continue;
    }
    constexpr size_t roughness_port = 1;
    const Operand& roughness = typed.operands_of(node)[roughness_port];
    if (roughness.from == Operand::From::input && roughness.type == graph::Type::floating && roughness.swizzle_count == 0)
      reads.roughnesses.push_back(roughness.index);
    else if (roughness.from != Operand::From::words || std::bit_cast<float>(typed.words[roughness.index]) > 0)
      reads.blurred = true;
  }
  return reads;
}

}  // namespace isoshade::driver
