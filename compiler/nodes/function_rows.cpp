// SPDX-License-Identifier: Apache-2.0
// The operators and functions of expressions as rows: rows of functions.def and three ops, with ports derived from the
// signatures.
#include <algorithm>
#include <array>
#include <optional>
#include <unordered_map>

#include "compiler/nodes/site.h"
#include "compiler/nodes/table.h"
#include "compiler/support/assert.h"

namespace isoshade::nodes {
namespace {

/// The type of a code in a signature (functions.def); nullopt if nodes have no such type. Vector types include colours,
/// so that functions like `dot` accept them.
std::optional<PortType> type_of(std::string_view code) {
  constexpr PortType matrix{matrix_types, Variable::t};
  constexpr auto tuple_of = [](Type vector, Type color) {
    return PortType{only(vector) | only(color), Variable::t};
  };
  if (code == "f") return Float;
  if (code == "g") return AnyFloat;
  if (code == "h") return PortType{float_types, Variable::u};
  if (code == "i") return PortType{only(Type::integer)};
  if (code == "v") return VectorOrColor;
  if (code == "v2") return Vector2;
  if (code == "v3") return tuple_of(Type::vector3, Type::color3);
  if (code == "v4") return tuple_of(Type::vector4, Type::color4);
  if (code == "m") return matrix;
  if (code == "m3") return PortType{only(Type::matrix33)};
  if (code == "m4") return PortType{only(Type::matrix44)};
  return std::nullopt;
}

/// Splits "g_ggh" into g, g, g, h; the result comes first.
std::vector<std::string_view> codes_of(std::string_view signature) {
  std::vector<std::string_view> codes;
  for (size_t at = 0; at < signature.size();) {
    const size_t length =
        at + 1 < signature.size() && signature[at + 1] >= '0' && signature[at + 1] <= '9' ? 2 : 1;
    if (signature[at] != '_') codes.push_back(signature.substr(at, length));
    at += length;
  }
  return codes;
}

/// The last argument must be a float or have the type of the result.
std::optional<Refusal> last_fits(std::span<const Type> types, std::span<const uint32_t>, Type out) {
  if (types.back() == Type::floating || types.back() == out) return std::nullopt;
  return Refusal{support::Id::type_mismatch, types.size() - 1,
                 "the last argument must be float or " + std::string(graph::type_name(out)) + ", not " +
                     std::string(graph::type_name(types.back()))};
}

/// A matrix multiplies vectors of its own height.
std::optional<Refusal> vector_fits(std::span<const Type> types, std::span<const uint32_t>, Type) {
  const int rows = types[0] == Type::matrix33 ? 3 : 4;
  if (graph::float_count(types[1]) == rows) return std::nullopt;
  return Refusal{support::Id::type_mismatch, 1,
                 "a " + std::string(graph::type_name(types[0])) + " multiplies a vector" + std::to_string(rows) +
                     ", not a " + std::string(graph::type_name(types[1]))};
}

void add_row(std::vector<Row>& rows, std::string_view name, std::string_view signature, Lowering lowering) {
  constexpr std::array<std::string_view, 8> names = {"x", "y", "z", "w", "a", "b", "c", "d"};
  if (name.ends_with("_exact")) return;  // implementations of `/` and sqrt
  const std::vector<std::string_view> codes = codes_of(signature);
  std::vector<PortType> types;
  for (const std::string_view code : codes) {
    const std::optional<PortType> type = type_of(code);
    support::assert_that(type.has_value(), code);
    types.push_back(*type);
  }
  // A result whose type no argument determines is a vector, not a colour.
  const bool settled = std::any_of(types.begin() + 1, types.end(),
                                   [&](PortType type) { return type.variable == types[0].variable; });
  if (!settled && types[0].variable != Variable::none) types[0] = Vector3;
  const bool transforms = signature == "v_mv";
  if (transforms) types[1].variable = Variable::u;
  Row row{name, "", {}, types[0], lowering};
  for (size_t i = 1; i < types.size(); ++i) row.ports.push_back({names[i - 1], types[i], ""});
  row.group = "function";
  if (transforms) row.condition = vector_fits;
  if (codes.back() == "h") row.condition = last_fits;
  rows.push_back(std::move(row));
}

void choose(Site& s) {
  std::array<ir::ValueId, 4> columns;
  for (size_t i = 0; i < s.in[1].count; ++i)
    columns[i] = s.op(ir::Opcode::select, {s[0], s.in[1].columns[i], s.in[2].columns[i]});
  s.out[0] = Value(std::span<const ir::ValueId>(columns).first(s.in[1].count));
}

void compare_equal(Site& s, bool equal) {
  using enum ir::Opcode;
  switch (s.types[0]) {
    case Type::boolean: {
      const ir::ValueId differ = s.op(bxor, {s[0], s[1]});
      s.out[0] = equal ? s.op(bnot, {differ}) : differ;
      return;
    }
    case Type::integer: s.out[0] = s.op(equal ? ieq : ine, {s[0], s[1]}); return;
    default: s.out[0] = s.op(equal ? feq : fne, {s[0], s[1]}); return;
  }
}

/// The operators, named by their text; unary minus is "negate".
std::vector<Row> operator_rows() {
  using enum ir::Opcode;
  constexpr PortType Boolean{only(Type::boolean)};
  constexpr PortType equatable{only(Type::boolean) | only(Type::integer) | only(Type::floating), Variable::t};
  const auto binary = [](std::string_view name, PortType in, PortType out, Lowering lowering) {
    return Row{name, "", {{"left", in, ""}, {"right", in, ""}}, out, lowering};
  };
  const auto arithmetic = [](std::string_view name, std::string_view node) {
    Row row = *find(node);
    row.name = name;
    return row;
  };
  return {
      arithmetic("+", "add"),
      arithmetic("-", "subtract"),
      arithmetic("*", "multiply"),
      arithmetic("/", "divide"),
      binary("<", Float, Boolean, flt),
      binary("<=", Float, Boolean, fle),
      binary(">", Float, Boolean, fgt),
      binary(">=", Float, Boolean, fge),
      binary("==", equatable, Boolean, Custom([](Site& s) { compare_equal(s, true); })),
      binary("!=", equatable, Boolean, Custom([](Site& s) { compare_equal(s, false); })),
      binary("&&", Boolean, Boolean, band),
      binary("||", Boolean, Boolean, bor),
      {"!", "", {{"value", Boolean, ""}}, Boolean, bnot},
      {"negate", "", {{"value", AnyFloat, ""}}, AnyFloat, fneg},
      {"?:", "", {{"condition", Boolean, ""}, {"first", Any, ""}, {"second", Any, ""}}, Any, choose},
  };
}

}  // namespace

const std::vector<Row>& function_table() {
  static const std::vector<Row> rows = [] {
    std::vector<Row> rows = operator_rows();
    add_row(rows, "abs", "g_g", ir::Opcode::fabs);
    add_row(rows, "floor", "g_g", ir::Opcode::floor);
    add_row(rows, "sqrt", "g_g", ir::Opcode::fsqrt);
#define FUNCTION(name, signature, ulp, domain, reference, unit) \
  add_row(rows, #name, #signature, Function{#name});
#include "compiler/functions/functions.def"
#undef FUNCTION
    std::ranges::sort(rows, {}, &Row::name);
    return rows;
  }();
  return rows;
}

const Row* find_function(std::string_view name) {
  const std::vector<Row>& rows = function_table();
  const auto found = std::ranges::lower_bound(rows, name, {}, &Row::name);
  return found == rows.end() || found->name != name ? nullptr : &*found;
}

}  // namespace isoshade::nodes
