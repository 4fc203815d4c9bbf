// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "compiler/ir/expansion.h"
#include "tests/unit/ir_text.h"

namespace isoshade::ir {
namespace {

uint64_t operations(const Module& module, const char* function, uint64_t of_division = 1) {
  const uint32_t entry = module.find(function);
  return expanded_operations(module, entry, of_division)[entry];
}

constexpr const char* twice = R"(
  func @leaf(%x: vec3) -> (out: vec3) {
    %s: vec3 = fmul %x, %x
    %d: vec3 = fdiv %s, %x
    return %d
  }
  func @twice(%x: vec3) -> (out: vec3) {
    %a: vec3 = call @leaf(%x)
    %b: vec3 = call @leaf(%a)
    return %b
  })";

TEST(Expansion, CountsComponentsAndEveryCall) {
  EXPECT_EQ(operations(valid(twice), "leaf"), 6u);
  EXPECT_EQ(operations(valid(twice), "twice"), 12u);
}

TEST(Expansion, AppliesTheGivenCostOfDivisions) {
  EXPECT_EQ(operations(valid(twice), "twice", 40), 2u * (3 + 120));
}

TEST(Expansion, CountsBothBranchSidesAndOneLoopIteration) {
  EXPECT_EQ(operations(valid(R"(
    func @f(%x: float, %c: bool, %n: int uniform) -> (out: float) {
      %a = branch %c {
        %s = fadd %x, %x
        yield %s
      } else {
        %p = fmul %x, %x
        %q = fmul %p, %p
        yield %q
      }
      %b = loop %i < %n, %t = %a {
        %u = fadd %t, %x
        yield %u
      }
      return %b
    })"),
                       "f"),
            4u);
}

// 2^200 operations: the count stops, and takes no longer than the text is long.
TEST(Expansion, TerminatesForDeepCalls) {
  std::string text = "func @f0(%x: float) -> (out: float) {\n  %s = fadd %x, %x\n  return %s\n}\n";
  for (int i = 1; i <= 200; ++i) {
    const std::string below = std::to_string(i - 1);
    text += "func @f" + std::to_string(i) + "(%x: float) -> (out: float) {\n  %a = call @f" + below +
            "(%x)\n  %b = call @f" + below + "(%a)\n  return %b\n}\n";
  }
  const Module module = valid(text);
  EXPECT_EQ(operations(module, "f20"), uint64_t{1} << 20);
  EXPECT_GE(operations(module, "f200"), uint64_t{1} << 40);
}

}  // namespace
}  // namespace isoshade::ir
