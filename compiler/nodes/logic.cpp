// SPDX-License-Identifier: Apache-2.0
// Booleans and selection: both values are computed, and one is selected.
#include "compiler/nodes/site.h"
#include "compiler/nodes/table.h"

namespace isoshade::nodes {
namespace {

using ir::Opcode;

void choose(Site& s, ir::ValueId condition) {
  std::array<ir::ValueId, 4> columns;
  for (size_t i = 0; i < s.in[2].count; ++i)
    columns[i] = s.op(Opcode::select, {condition, s.in[2].columns[i], s.in[3].columns[i]});
  s.out[0] = Value(std::span<const ir::ValueId>(columns).first(s.in[2].count));
}

template <Opcode comparison>
void choose_by(Site& s) {
  choose(s, s.op(comparison, {s[0], s[1]}));
}

void choose_equal(Site& s) {
  switch (s.types[0]) {
    case Type::boolean: return choose(s, s.op(Opcode::bnot, {s.op(Opcode::bxor, {s[0], s[1]})}));
    case Type::integer: return choose_by<Opcode::ieq>(s);
    default: return choose_by<Opcode::feq>(s);
  }
}

}  // namespace

std::vector<Row> logic_rows() {
  const PortType equatable{only(Type::boolean) | only(Type::integer) | only(Type::floating), Variable::u};
  const Port value1{"value1", Float, "the left side of the comparison"};
  const Port value2{"value2", Float, "the right side of the comparison"};
  // Without both, the result is the boolean of the comparison.
  const Port in1{"in1", Any, "the result if the comparison is true; default: true, or 0 for other types", true};
  const Port in2{"in2", Any, "the result if the comparison is false, or if a side is NaN", false};
  const Port truth1{"in1", Boolean, "the first boolean"};
  const Port truth2{"in2", Boolean, "the second boolean"};
  return {
      {"ifgreater",
       "`in1` if `value1` > `value2`, else `in2`; without `in1` and `in2`, the boolean of the comparison.",
       {value1, value2, in1, in2},
       Any,
       choose_by<Opcode::fgt>},
      {"ifgreatereq",
       "`in1` if `value1` >= `value2`, else `in2`; without `in1` and `in2`, the boolean of the comparison.",
       {value1, value2, in1, in2},
       Any,
       choose_by<Opcode::fge>},
      {"ifequal",
       "`in1` if `value1` equals `value2`, else `in2`; without `in1` and `in2`, the boolean of the comparison.",
       {{"value1", equatable, "the left side"}, {"value2", equatable, "the right side"}, in1, in2},
       Any,
       choose_equal},
      {"and", "Whether both are true.", {truth1, truth2}, Boolean, Opcode::band},
      {"or", "Whether at least one is true.", {truth1, truth2}, Boolean, Opcode::bor},
      {"xor", "Whether exactly one is true.", {truth1, truth2}, Boolean, Opcode::bxor},
      {"not", "Whether `in` is false.", {{"in", Boolean, "a boolean"}}, Boolean, Opcode::bnot},
  };
}

}  // namespace isoshade::nodes
