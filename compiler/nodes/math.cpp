// SPDX-License-Identifier: Apache-2.0
// Arithmetic, componentwise.
#include "compiler/nodes/site.h"
#include "compiler/nodes/table.h"

namespace isoshade::nodes {
namespace {

std::optional<Refusal> share_fits(std::span<const Type> types, std::span<const uint32_t>, Type out) {
  if (types[2] == Type::floating || types[2] == out) return std::nullopt;
  return Refusal{support::Id::type_mismatch, 2,
                 "\"mix\" is float or " + std::string(graph::type_name(out)) + ", not " +
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
       {{"in1", FloatOrMatrix, "the first value"}, {"in2", FloatOrMatrix, "what is added", 0.0f}},
       FloatOrMatrix,
       fadd},
      {"subtract",
       "`in1` - `in2`.",
       {{"in1", FloatOrMatrix, "the first value"}, {"in2", FloatOrMatrix, "what is taken away", 0.0f}},
       FloatOrMatrix,
       fsub},
      {"multiply",
       "`in1` * `in2`; of two matrices their product.",
       {{"in1", FloatOrMatrix, "the first factor"}, {"in2", FloatOrMatrix, "the second factor", 1.0f}},
       FloatOrMatrix,
       [](Site& s) {
         s.out[0] = s.in[0].count > 1 ? s.call("matmul", {s.in[0], s.in[1]}) : s.op(fmul, {s[0], s[1]});
       }},
      {"divide",
       "`in1` / `in2`, correctly rounded. By zero: infinity, or NaN for 0 / 0. Of matrices, `in1` times the "
       "inverse of `in2`.",
       {{"in1", FloatOrMatrix, "what is divided"}, {"in2", FloatOrMatrix, "the divisor", 1.0f}},
       FloatOrMatrix,
       [](Site& s) {
         s.out[0] = s.in[0].count > 1 ? s.call("matmul", {s.in[0], s.call("inverse", {s.in[1]})})
                                      : s.op(fdiv, {s[0], s[1]});
       }},
      {"modulo",
       "What is left of `in1` when divided by `in2`; it has the sign of `in2`.",
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
      {"min", "The lesser.", {in1, in2}, AnyFloat, Function{"min"}},
      {"max", "The greater.", {in1, in2}, AnyFloat, Function{"max"}},
      {"clamp",
       "`in`, but at least `low` and at most `high`.",
       {in, {"low", AnyFloat, "the least result", 0.0f}, {"high", AnyFloat, "the greatest result", 1.0f}},
       AnyFloat,
       Function{"clamp"}},
      {"saturate", "`in`, but at least 0 and at most 1.", {in}, AnyFloat, Function{"saturate"}},
      {"finite", "`in`, or 0 where it is infinite or NaN.", {in}, AnyFloat, Function{"finite_or_zero"}},
      {"absval", "`in` without its sign.", {in}, AnyFloat, fabs},
      {"sign", "-1, 0 or 1: the sign of `in`.", {in}, AnyFloat, Function{"sign"}},
      {"floor", "The greatest whole number that is not above `in`.", {in}, AnyFloat, floor},
      {"ceil", "The least whole number that is not below `in`.", {in}, AnyFloat, Function{"ceil"}},
      {"round",
       "The whole number nearest to `in`; halves go to the even one.",
       {in},
       AnyFloat,
       Function{"round"}},
      {"fract", "`in` - floor(`in`), in [0, 1).", {in}, AnyFloat, Function{"fract"}},
      {"invert",
       "`amount` - `in`.",
       {in, {"amount", AnyFloat, "what is subtracted from", 1.0f}},
       AnyFloat,
       [](Site& s) {
         s.out[0] = s.op(fsub, {s[1], s[0]});
       }},
      {"sqrt", "The square root, correctly rounded. NaN below 0.", {in}, AnyFloat, fsqrt},
      {"exp", "e to the power of `in`.", {in}, AnyFloat, Function{"exp"}},
      {"exp2", "2 to the power of `in`.", {in}, AnyFloat, Function{"exp2"}},
      {"ln", "The natural logarithm. -infinity at 0, NaN below.", {in}, AnyFloat, Function{"log"}},
      {"log2", "The logarithm to base 2. -infinity at 0, NaN below.", {in}, AnyFloat, Function{"log2"}},
      {"sin", "The sine of an angle in radians.", {in}, AnyFloat, Function{"sin"}},
      {"cos", "The cosine of an angle in radians.", {in}, AnyFloat, Function{"cos"}},
      {"tan", "The tangent of an angle in radians.", {in}, AnyFloat, Function{"tan"}},
      {"asin", "The angle in [-pi/2, pi/2] whose sine is `in`.", {in}, AnyFloat, Function{"asin"}},
      {"acos", "The angle in [0, pi] whose cosine is `in`.", {in}, AnyFloat, Function{"acos"}},
      {"atan2",
       "The angle in [-pi, pi] of the point (`inx`, `iny`), from the x axis towards the y axis.",
       {{"iny", AnyFloat, "the point's y"}, {"inx", AnyFloat, "the point's x", 1.0f}},
       AnyFloat,
       Function{"atan2"}},
      {"mix",
       "`bg` at `mix` 0, `fg` at 1, in proportion between; both ends are exact.",
       {{"fg", AnyFloat, "the value at 1"},
        {"bg", AnyFloat, "the value at 0"},
        {"mix", {float_types, Variable::u}, "the share of `fg`: a float, or one for each component"}},
       AnyFloat,
       [](Site& s) {
         s.out[0] = s.call("mix", {s.in[1], s.in[0], s.in[2]});
       },
       share_fits},
      {"remap",
       "`in` taken linearly from the range `inlow` to `inhigh` to the range `outlow` to `outhigh`.",
       {in,
        {"inlow", AnyFloat, "what becomes `outlow`", 0.0f},
        {"inhigh", AnyFloat, "what becomes `outhigh`", 1.0f},
        {"outlow", AnyFloat, "the result at `inlow`", 0.0f},
        {"outhigh", AnyFloat, "the result at `inhigh`", 1.0f}},
       AnyFloat,
       Function{"remap"}},
      {"smoothstep",
       "0 up to `low`, 1 from `high` on, a smooth rise between.",
       {in,
        {"low", AnyFloat, "where it begins to rise", 0.0f},
        {"high", AnyFloat, "where it reaches 1", 1.0f}},
       AnyFloat,
       [](Site& s) {
         s.out[0] = s.call("smoothstep", {s.in[1], s.in[2], s.in[0]});
       }},
      {"step",
       "0 where `in` is below `edge`, else 1.",
       {in, {"edge", AnyFloat, "the first value that gives 1", 0.5f}},
       AnyFloat,
       [](Site& s) {
         s.out[0] = s.call("step", {s.in[1], s.in[0]});
       }},
  };
}

}  // namespace isoshade::nodes
