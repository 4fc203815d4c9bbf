// SPDX-License-Identifier: Apache-2.0
// A body builds the IR of what it computes. Every variant of every row.
#include <gtest/gtest.h>
#include <set>
#include <string>
#include <tuple>

#include "compiler/functions/all.h"
#include "compiler/functions/library.h"
#include "compiler/functions/signatures.h"
#include "compiler/ir/interpreter.h"
#include "compiler/ir/validator.h"
#include "tests/unit/functions_values.h"

namespace isoshade::functions {
namespace {

/// A module of nothing but the whole library.
const ir::Module& library() {
  static const ir::Module module = [] {
    ir::Module m;
    for (const Variant& variant : variants()) declare(m, variant);
    expand(m);
    return m;
  }();
  return module;
}

TEST(Library, IsValidIr) { EXPECT_EQ(ir::validate(library()), ""); }

TEST(Library, HasOneFunctionPerVariant) {
  std::set<std::string> names;
  for (const ir::Function& function : library().functions) {
    EXPECT_FALSE(function.is_declaration()) << function.name;
    EXPECT_TRUE(names.insert(function.name).second) << function.name;
  }
  EXPECT_EQ(names.size(), variants().size());
}

// Drivers fold such shapes in ways of their own.
TEST(Library, ContainsNothingForDriversToFold) {
  using ir::Opcode;
  for (const ir::Function& f : library().functions) {
    std::vector<const ir::Instruction*> origin(f.values.size());
    for (const ir::Instruction& i : f.instructions)
      for (uint32_t r = 0; r < i.result_count; ++r) origin[i.first_result + r] = &i;
    const auto is = [&](ir::ValueId value, Opcode op) { return origin[value] && origin[value]->op == op; };
    const auto is_float = [&](ir::ValueId value, float x) {
      return is(value, Opcode::constant) && f.type(value) == ir::float_type &&
             origin[value]->imm == std::bit_cast<uint32_t>(x);
    };
    for (const ir::Instruction& i : f.instructions) {
      if (!ir::is_primitive(i.op)) continue;
      const auto operands = f.operands_of(i);
      const std::string where = f.name + ": " + std::string(ir::name(i.op));
      int literals = 0;
      for (ir::ValueId operand : operands) literals += is(operand, Opcode::constant);
      EXPECT_LE(literals, i.op == Opcode::select ? 2 : 1) << where;
      EXPECT_FALSE(is(operands[0], Opcode::constant) && (i.op == Opcode::select || operands.size() == 1))
          << where;
      EXPECT_FALSE(i.op == Opcode::ftoi && is(operands[0], Opcode::itof)) << where;
      EXPECT_FALSE(i.op == Opcode::itof && is(operands[0], Opcode::ftoi)) << where;
      if (i.op != Opcode::fadd && i.op != Opcode::fsub && i.op != Opcode::fmul && i.op != Opcode::fdiv)
        continue;
      for (ir::ValueId operand : operands) {
        EXPECT_FALSE(is_float(operand, 0.0f) || is_float(operand, -0.0f)) << where;
        EXPECT_FALSE(i.op == Opcode::fmul && (is_float(operand, 1.0f) || is_float(operand, -1.0f))) << where;
      }
    }
  }
}

// Arguments and results of bodies, as words and as types.
void append(std::vector<uint32_t>& words, float x) { words.push_back(bits_of(x)); }
template <int N>
void append(std::vector<uint32_t>& words, const vec<float, N>& v) {
  for (int i = 0; i < N; ++i) append(words, v[i]);
}
template <int N>
void append(std::vector<uint32_t>& words, const mat<float, N>& m) {
  for (int i = 0; i < N; ++i) append(words, m[i]);
}

template <class T>
struct Argument;
template <>
struct Argument<float> {
  static void types(std::vector<ir::Type>& list) { list.push_back(ir::float_type); }
  template <class Random>
  static float any(Random& random) {
    return any_float(random);
  }
};
template <int N>
struct Argument<vec<float, N>> {
  static void types(std::vector<ir::Type>& list) { list.push_back(ir::vector_type(N)); }
  template <class Random>
  static vec<float, N> any(Random& random) {
    return componentwise([&](float) { return any_float(random); }, vec<float, N>{});
  }
};
template <int N>
struct Argument<mat<float, N>> {
  static void types(std::vector<ir::Type>& list) {
    for (int i = 0; i < N; ++i) list.push_back(ir::vector_type(N));
  }
  template <class Random>
  static mat<float, N> any(Random& random) {
    mat<float, N> m;
    for (auto& column : m.column) column = Argument<vec<float, N>>::any(random);
    return m;
  }
};

ir::Interpreter& interpreter() {
  static ir::Interpreter instance(library(), ir::Preconditions::report);
  return instance;
}

template <class Row, class... T>
void expect_same_bits(uint32_t function, const T&... arguments) {
  std::vector<uint32_t> words, expected;
  (append(words, arguments), ...);
  {
    const lanes::FpGuard guard;
    append(expected, Row::body(arguments...));
  }
  std::vector<uint32_t> results(expected.size());
  ASSERT_TRUE(interpreter().run(function, words, results));
  ASSERT_EQ(results, expected) << library().functions[function].name << " of "
                               << testing::PrintToString(words);
  ASSERT_EQ(interpreter().breaches(), 0u)
      << library().functions[function].name << " of " << testing::PrintToString(words);
}

template <class Row, class... T>
void expect_variant(std::string_view row, Types<T...>) {
  std::vector<ir::Type> types;
  (Argument<T>::types(types), ...);
  const Variant* variant = find(row, types);
  ASSERT_NE(variant, nullptr);
  const uint32_t function = library().find("iso_" + variant->name);
  ASSERT_NE(function, ir::none);
  if constexpr (std::is_same_v<Types<T...>, Types<float>>)
    for (float x : special_floats()) expect_same_bits<Row>(function, x);
  if constexpr (std::is_same_v<Types<T...>, Types<float, float>>)
    for (float x : special_floats())
      for (float y : special_floats()) expect_same_bits<Row>(function, x, y);
  std::mt19937 random(1);
  for (int i = 0; i < 2000 && !testing::Test::HasFatalFailure(); ++i)
    expect_same_bits<Row, T...>(function, Argument<T>::any(random)...);
}

template <class Row, class... Variants>
void expect_variants(std::string_view row, Types<Variants...>) {
  (expect_variant<Row>(row, Variants{}), ...);
}

#define FUNCTION(row, signature, ulp, domain, reference, unit) \
  struct row##_row {                                           \
    template <class... T>                                      \
    static auto body(T... arguments) {                         \
      return functions::row(arguments...);                     \
    }                                                          \
  };                                                           \
  TEST(InterpretedIrMatchesCpp, row) { expect_variants<row##_row>(#row, Signatures<float>::signature{}); }
#include "compiler/functions/functions.def"

}  // namespace
}  // namespace isoshade::functions
