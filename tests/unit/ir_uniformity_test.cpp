// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <gtest/gtest.h>

#include "compiler/ir/uniformity.h"
#include "tests/unit/ir_text.h"

namespace isoshade::ir {
namespace {

// The nodes whose values are uniform, in the order of the text.
std::vector<std::string> uniform_names(const Module& module) {
  const Function& f = module.functions[0];
  const std::vector<bool> uniform = uniform_values(f);
  std::vector<std::string> names;
  for (ValueId value = 0; value < f.values.size(); ++value)
    if (uniform[value] && f.values[value].names != 0) names.push_back(f.origins[f.values[value].names].node);
  return names;
}

using Names = std::vector<std::string>;

TEST(Uniformity, ResultIsUniformIfAllOperandsAre) {
  EXPECT_EQ(uniform_names(valid(R"(
    buffer b: float
    func @f(%u: float uniform, %v: float, %i: int uniform, %j: int) -> (out: float) {
      %one = constant float 0x3f800000
      %uu = fadd %u, %one
      %uv = fadd %u, %v
      %read = load b[%i]
      %gathered = load b[%j]
      %called = call @g(%u)
      %called_varying = call @g(%v)
      return %uv
    }
    func @g(%x: float) -> (out: float) library "g")")),
            (Names{"one", "uu", "read", "called"}));
}

TEST(Uniformity, BranchIsUniformIfConditionAndYieldsAre) {
  EXPECT_EQ(uniform_names(valid(R"(
    func @f(%cu: bool uniform, %cv: bool, %u: float uniform, %v: float) -> (out: float) {
      %both, %one_side = branch %cu { yield %u, %v } else { yield %u, %u }
      %divergent = branch %cv {
        %inside = fneg %u
        yield %inside
      } else { yield %u }
      return %both
    })")),
            (Names{"both", "inside"}));
}

TEST(Uniformity, LoopCarriedValueVariesIfItEverDoes) {
  EXPECT_EQ(uniform_names(valid(R"(
    func @f(%n: int uniform, %u: float uniform, %v: float) -> (out: float) {
      %steady_out, %first_out, %second_out, %from_v = loop %i < %n, %steady = %u, %first = %u, %second = %u, %w = %v {
        %indexed = itof %i
        %next = fadd %steady, %indexed
        yield %next, %second, %v, %u
      }
      return %steady_out
    })")),
            (Names{"steady_out", "i", "steady", "indexed", "next"}));
}

}  // namespace
}  // namespace isoshade::ir
