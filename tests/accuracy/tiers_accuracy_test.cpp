// SPDX-License-Identifier: Apache-2.0
// Every row keeps its error bound in the fast and the precise tier: those with bodies of their own as computed on
// floats, and all whose calls end elsewhere than in the default tier as what their IR computes.
#include <bit>
#include <cstring>

#include "compiler/functions/library.h"
#include "compiler/ir/interpreter.h"
#include "compiler/ir/printer.h"
#include "tests/accuracy/rows.h"

namespace isoshade::accuracy {
namespace {

using functions::Tier;

#define TIER(tier, row, ulp, domain, unit_)                                                                 \
  TEST(FunctionErrorIsWithinTheBoundOfTheTier, row##_##tier) {                                              \
    expect_variants_within<rows::tier##_##row##_row>(#row " " #tier, rows::tier##_##row##_row::Variants{}); \
  }
#include "compiler/functions/functions.def"

// How arguments and results lie in a function's parameters and results.
void flatten(float x, std::vector<uint32_t>& out) { out.push_back(std::bit_cast<uint32_t>(x)); }
template <int N>
void flatten(const lanes::vec<float, N>& v, std::vector<uint32_t>& out) {
  for (int i = 0; i < N; ++i) flatten(v[i], out);
}
template <int N>
void flatten(const functions::mat<float, N>& m, std::vector<uint32_t>& out) {
  for (int i = 0; i < N; ++i) flatten(m[i], out);
}
void add_types(float, std::vector<ir::Type>& out) { out.push_back(ir::float_type); }
template <int N>
void add_types(const lanes::vec<float, N>&, std::vector<ir::Type>& out) {
  out.push_back(ir::vector_type(N));
}
template <int N>
void add_types(const functions::mat<float, N>&, std::vector<ir::Type>& out) {
  out.insert(out.end(), N, ir::vector_type(N));
}

template <class... T>
const functions::Variant& variant_for(std::string_view row, functions::Types<T...>) {
  std::vector<ir::Type> types;
  (add_types(T{}, types), ...);
  return *functions::find(row, types);
}

ir::Module expanded(const functions::Variant& variant, Tier tier) {
  ir::Module module;
  functions::declare(module, variant);
  functions::expand(module, tier);
  return module;
}

/// A row whose body is what its IR computes in a tier.
template <class Row, Tier tier>
struct Interpreted : Row {
  static inline std::string_view name;

  template <class... T>
  static auto body(T... arguments) {
    using Result = decltype(Row::Default::body(arguments...));
    struct Program {
      ir::Module module = expanded(variant_for(name, functions::Types<T...>{}), tier);
      ir::Interpreter interpreter{module};
    };
    static Program program;
    std::vector<uint32_t> in;
    (flatten(arguments, in), ...);
    std::vector<uint32_t> out(sizeof(Result) / sizeof(float));
    EXPECT_TRUE(program.interpreter.run(0, in, out));
    Result result;
    std::memcpy(&result, out.data(), sizeof result);  // nothing but floats, as they are flattened
    return result;
  }
};

template <class Row, Tier tier, class... T>
void expect_ir_within(std::string_view row, functions::Types<T...> types) {
  const functions::Variant& variant = variant_for(row, types);
  EXPECT_EQ(variant.accuracy[static_cast<size_t>(tier)].ulp, Row::bound) << row;
  if (ir::print(expanded(variant, tier)) == ir::print(expanded(variant, Tier::standard))) return;
  using Measured = Interpreted<Row, tier>;
  Measured::name = row;
  expect_within(std::string(functions::tier_name(tier)) + " " + variant.name, Row::bound,
                measure<Measured>(types, 3000));
}

template <class Row, Tier tier, class First, class... Rest>
void expect_all_ir_within(std::string_view row, functions::Types<First, Rest...>) {
  expect_ir_within<Row, tier>(row, First{});
  if constexpr (!is_of_floats<First>) (expect_ir_within<Row, tier>(row, Rest{}), ...);
}

/// What a tier says of a row, or else the default.
template <class Row, Tier tier>
struct RowOf {
  using Type = Row;
};
#define TIER(tier, row, ulp, domain, unit)    \
  template <>                                 \
  struct RowOf<rows::row##_row, Tier::tier> { \
    using Type = rows::tier##_##row##_row;    \
  };
#define FOLLOWS TIER
#include "compiler/functions/functions.def"

#define FUNCTION(row, signature, ulp, domain, reference_, unit_)                                             \
  TEST(IrErrorIsWithinTheBoundOfTheTier, row) {                                                              \
    expect_all_ir_within<RowOf<rows::row##_row, Tier::fast>::Type, Tier::fast>(#row,                         \
                                                                               rows::row##_row::Variants{}); \
    expect_all_ir_within<RowOf<rows::row##_row, Tier::precise>::Type, Tier::precise>(                        \
        #row, rows::row##_row::Variants{});                                                                  \
  }
#include "compiler/functions/functions.def"

TEST(UnaryFunctions, StayWithinTierBoundsForEveryFloat) {
  if (std::getenv("ISOSHADE_FULL") == nullptr) GTEST_SKIP() << "long; set ISOSHADE_FULL=1";
#define TIER(tier, row, ulp, domain, unit) \
  expect_all_floats_within<rows::tier##_##row##_row>(#row, rows::tier##_##row##_row::Variants{});
#include "compiler/functions/functions.def"
}

}  // namespace
}  // namespace isoshade::accuracy
