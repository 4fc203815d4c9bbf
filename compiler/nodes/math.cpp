// SPDX-License-Identifier: Apache-2.0
// Arithmetic, componentwise.
#include "compiler/nodes/site.h"
#include "compiler/nodes/table.h"

namespace isoshade::nodes {
namespace {

std::optional<Refusal> weight_fits(std::span<const Type> types, std::span<const uint32_t>, Type out) {
  if (types[2] == Type::floating || types[2] == out) return std::nullopt;
  return Refusal{support::Id::type_mismatch, 2,
                 "\"mix\" must be float or " + std::string(graph::type_name(out)) + ", not " +
                     std::string(graph::type_name(types[2]))};
}

}  // namespace

std::vector<Row> math_rows() {
  using enum ir::Opcode;
  const Port in{"in", AnyFloat, "the value"};
  const Port in1{"in1", AnyFloat, "the first value"};
  const Port in2{"in2", AnyFloat, "the second value"};
  return {
      {"add",
       "`in1` + `in2`.",
       {{"in1", FloatOrMatrix, "the first value"}, {"in2", FloatOrMatrix, "the second value", 0.0f}},
       FloatOrMatrix,
       fadd},
      {"subtract",
       "`in1` - `in2`.",
       {{"in1", FloatOrMatrix, "the first value"}, {"in2", FloatOrMatrix, "the value to subtract", 0.0f}},
       FloatOrMatrix,
       fsub},
      {"multiply",
       "`in1` * `in2`; for matrices, the matrix product.",
       {{"in1", FloatOrMatrix, "the first factor"}, {"in2", FloatOrMatrix, "the second factor", 1.0f}},
       FloatOrMatrix,
       [](Site& s) {
         s.out[0] = s.in[0].count > 1 ? s.call("matmul", {s.in[0], s.in[1]}) : s.op(fmul, {s[0], s[1]});
       }},
      {"divide",
       "`in1` / `in2`, correctly rounded. Division by zero gives infinity, 0 / 0 gives NaN. For matrices, `in1` times "
       "the inverse of `in2`.",
       {{"in1", FloatOrMatrix, "the dividend"}, {"in2", FloatOrMatrix, "the divisor", 1.0f}},
       FloatOrMatrix,
       [](Site& s) {
         s.out[0] = s.in[0].count > 1 ? s.call("matmul", {s.in[0], s.call("inverse", {s.in[1]})})
                                      : s.op(fdiv, {s[0], s[1]});
       }},
      {"modulo",
       "The remainder of `in1` divided by `in2`, with the sign of `in2`.",
       {in1, {"in2", AnyFloat, "the divisor", 1.0f}},
       AnyFloat,
       Function{"mod"}},
      {"power",
       "`in1` to the power of `in2`. NaN for negative `in1`.",
       {in1, {"in2", AnyFloat, "the exponent", 1.0f}},
       AnyFloat,
       Function{"pow"}},
      {"safepower",
       "The magnitude of `in1` to the power of `in2`, with the sign of `in1`.",
       {in1, {"in2", AnyFloat, "the exponent", 1.0f}},
       AnyFloat,
       Function{"safepower"}},
      {"min", "The smaller value.", {in1, in2}, AnyFloat, Function{"min"}},
      {"max", "The larger value.", {in1, in2}, AnyFloat, Function{"max"}},
      {"clamp",
       "`in`, clamped to [`low`, `high`].",
       {in, {"low", AnyFloat, "the smallest result", 0.0f}, {"high", AnyFloat, "the largest result", 1.0f}},
       AnyFloat,
       Function{"clamp"}},
      {"saturate", "`in`, clamped to [0, 1].", {in}, AnyFloat, Function{"saturate"}},
      {"finite", "`in`, or 0 if it is infinite or NaN.", {in}, AnyFloat, Function{"finite_or_zero"}},
      {"absval", "The absolute value of `in`.", {in}, AnyFloat, fabs},
      {"sign", "The sign of `in`: -1, 0 or 1.", {in}, AnyFloat, Function{"sign"}},
      {"floor", "The largest integer not above `in`.", {in}, AnyFloat, floor},
      {"ceil", "The smallest integer not below `in`.", {in}, AnyFloat, Function{"ceil"}},
      {"round",
       "The integer nearest to `in`, ties to even.",
       {in},
       AnyFloat,
       Function{"round"}},
      {"fract", "`in` - floor(`in`), in [0, 1).", {in}, AnyFloat, Function{"fract"}},
      {"invert",
       "`amount` - `in`.",
       {in, {"amount", AnyFloat, "the value to subtract `in` from", 1.0f}},
       AnyFloat,
       [](Site& s) {
         s.out[0] = s.op(fsub, {s[1], s[0]});
       }},
      {"sqrt", "The square root, correctly rounded. NaN for negative `in`.", {in}, AnyFloat, fsqrt},
      {"exp", "e to the power of `in`.", {in}, AnyFloat, Function{"exp"}},
      {"exp2", "2 to the power of `in`.", {in}, AnyFloat, Function{"exp2"}},
      {"ln", "The natural logarithm. -infinity for 0, NaN for negative `in`.", {in}, AnyFloat, Function{"log"}},
      {"log2", "The base-2 logarithm. -infinity for 0, NaN for negative `in`.", {in}, AnyFloat, Function{"log2"}},
      {"sin", "The sine of an angle in radians.", {in}, AnyFloat, Function{"sin"}},
      {"cos", "The cosine of an angle in radians.", {in}, AnyFloat, Function{"cos"}},
      {"tan", "The tangent of an angle in radians.", {in}, AnyFloat, Function{"tan"}},
      {"asin", "The angle in [-pi/2, pi/2] whose sine is `in`.", {in}, AnyFloat, Function{"asin"}},
      {"acos", "The angle in [0, pi] whose cosine is `in`.", {in}, AnyFloat, Function{"acos"}},
      {"atan2",
       "The angle in [-pi, pi] from the x axis to the point (`inx`, `iny`), towards the y axis.",
       {{"iny", AnyFloat, "y of the point"}, {"inx", AnyFloat, "x of the point", 1.0f}},
       AnyFloat,
       Function{"atan2"}},
      {"mix",
       "Linear interpolation from `bg` at `mix` = 0 to `fg` at `mix` = 1; exact at both ends.",
       {{"fg", AnyFloat, "the value at 1"},
        {"bg", AnyFloat, "the value at 0"},
        {"mix", {float_types, Variable::u}, "the weight of `fg`: a float, or one per component"}},
       AnyFloat,
       [](Site& s) {
         s.out[0] = s.call("mix", {s.in[1], s.in[0], s.in[2]});
       },
       weight_fits},
      {"remap",
       "Maps `in` linearly from the range `inlow` to `inhigh` to the range `outlow` to `outhigh`.",
       {in,
        {"inlow", AnyFloat, "the value mapped to `outlow`", 0.0f},
        {"inhigh", AnyFloat, "the value mapped to `outhigh`", 1.0f},
        {"outlow", AnyFloat, "the result at `inlow`", 0.0f},
        {"outhigh", AnyFloat, "the result at `inhigh`", 1.0f}},
       AnyFloat,
       Function{"remap"}},
      {"smoothstep",
       "0 up to `low`, 1 from `high`, with a smooth cubic transition in between.",
       {in,
        {"low", AnyFloat, "the lower edge", 0.0f},
        {"high", AnyFloat, "the upper edge", 1.0f}},
       AnyFloat,
       [](Site& s) {
         s.out[0] = s.call("smoothstep", {s.in[1], s.in[2], s.in[0]});
       }},
      {"step",
       "0 if `in` is below `edge`, else 1.",
       {in, {"edge", AnyFloat, "the smallest value that gives 1", 0.5f}},
       AnyFloat,
       [](Site& s) {
         s.out[0] = s.call("step", {s.in[1], s.in[0]});
       }},
  };
}

}  // namespace isoshade::nodes
