// SPDX-License-Identifier: Apache-2.0
#include "compiler/nodes/site.h"

#include <algorithm>
#include <bit>

#include "compiler/functions/library.h"
#include "compiler/support/assert.h"

namespace isoshade::nodes {

using support::assert_that;

Value::Value(std::span<const ir::ValueId> ids) : count(static_cast<uint8_t>(ids.size())) {
  assert_that(ids.size() <= columns.size(), "a value has at most four columns");
  std::ranges::copy(ids, columns.begin());
}

int column_count(Type type) {
  switch (type) {
    case Type::matrix33: return 3;
    case Type::matrix44: return 4;
    case Type::filename:
    case Type::string: return 0;
    default: return 1;
  }
}

ir::Type ir_type(Type type) {
  if (type == Type::boolean) return ir::bool_type;
  if (type == Type::integer) return ir::int_type;
  assert_that(column_count(type) > 0, "filenames and strings have no IR type");
  return ir::vector_type(graph::float_count(type) / column_count(type));
}

Value constant(ir::Builder& b, Type type, std::span<const uint32_t> bits) {
  const ir::Type column = ir_type(type);
  if (!column.is_float()) return b.constant_bits(column, bits.front());
  std::array<ir::ValueId, 4> columns;
  const size_t count = column_count(type);
  for (size_t c = 0; c < count; ++c) {
    const std::span<const uint32_t> words = bits.subspan(c * column.width, column.width);
    std::array<ir::ValueId, 4> floats;
    for (size_t i = 0; i < words.size(); ++i)
      floats[i] =
          i > 0 && words[i] == words[i - 1] ? floats[i - 1] : b.constant(std::bit_cast<float>(words[i]));
    columns[c] = b.construct(std::span(floats).first(words.size()));
  }
  return Value(std::span<const ir::ValueId>(columns).first(count));
}

Value broadcast(ir::Builder& b, Value value, Type from, Type to) {
  if (from == Type::integer && to != Type::integer) value = b.op(ir::Opcode::itof, {value.id()});
  const int width = graph::float_count(to);
  if (b.type(value.id()) != ir::float_type || width == 1) return value;
  std::array<ir::ValueId, 4> components;
  components.fill(value.id());
  return b.construct(std::span<const ir::ValueId>(components).first(width));
}

Value call_function(ir::Builder& b, std::string_view row, std::span<const Value> arguments) {
  std::vector<ir::ValueId> ids;
  std::vector<ir::Type> types;
  size_t width = 1;
  for (const Value& argument : arguments) {
    for (const ir::ValueId id : argument.ids()) {
      ids.push_back(id);
      types.push_back(b.type(id));
      width = std::max<size_t>(width, b.type(id).width);
    }
  }
  if (functions::find(row, types) != nullptr) return Value(functions::call_library(b, row, ids));
  std::array<ir::ValueId, 4> results;
  for (uint32_t i = 0; i < width; ++i) {
    std::vector<ir::ValueId> component;
    for (const ir::ValueId id : ids) component.push_back(b.type(id).width > 1 ? b.extract(id, i) : id);
    results[i] = functions::call_library(b, row, component).front();
  }
  return b.construct(std::span<const ir::ValueId>(results).first(width));
}

Value Site::op_of_columns(ir::Opcode opcode) const {
  std::array<ir::ValueId, 4> columns;
  for (size_t c = 0; c < in[0].count; ++c) {
    std::array<ir::ValueId, 3> operands;
    for (size_t i = 0; i < in.size(); ++i) operands[i] = in[i].columns[c];
    columns[c] = b.op(opcode, std::span<const ir::ValueId>(operands).first(in.size()));
  }
  return Value(std::span<const ir::ValueId>(columns).first(in[0].count));
}

namespace {
Value differentiate(Derivative what, Site& s) {
  using enum ir::Opcode;
  if (what == Derivative::x) return s.op(ddx, {s[0]});
  if (what == Derivative::y) return s.op(ddy, {s[0]});
  return s.op(fadd, {s.op(fabs, {s.op(ddx, {s[0]})}), s.op(fabs, {s.op(ddy, {s[0]})})});
}
}  // namespace

void lower(const Row& row, Site& site) {
  if (const auto* opcode = std::get_if<ir::Opcode>(&row.lowering)) {
    site.out[0] = site.op_of_columns(*opcode);
  } else if (const auto* function = std::get_if<Function>(&row.lowering)) {
    site.out[0] = call_function(site.b, function->row, site.in);
  } else if (const auto* derivative = std::get_if<Derivative>(&row.lowering)) {
    site.out[0] = differentiate(*derivative, site);
  } else if (const auto* custom = std::get_if<Custom>(&row.lowering)) {
    (*custom)(site);
  } else {
    support::bug("this node depends on more than its ports");
  }
}

}  // namespace isoshade::nodes
