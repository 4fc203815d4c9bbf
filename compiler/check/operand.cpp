// SPDX-License-Identifier: Apache-2.0
#include "compiler/check/operand.h"

#include <bit>
#include <utility>

namespace isoshade::check {
namespace {

using graph::Link;
using graph::Literal;
using support::Id;
using support::quote;

constexpr std::string_view positions = "xyzw";
constexpr std::string_view channels = "rgba";

bool is_color(Type type) { return nodes::color_types.has(type); }

/// Whether a selector can be a swizzle; otherwise it is the name of an output.
bool looks_like_swizzle(std::string_view letters) {
  return letters.size() <= 4 && (letters.find_first_not_of(positions) == std::string_view::npos ||
                                 letters.find_first_not_of(channels) == std::string_view::npos);
}

/// The type of a swizzle with `count` components.
Type tuple_of(size_t count, bool color) {
  switch (count) {
    case 1: return Type::floating;
    case 2: return Type::vector2;
    case 3: return color ? Type::color3 : Type::vector3;
    default: return color ? Type::color4 : Type::vector4;
  }
}

bool swizzle(Work& work, const Link& link, std::string_view letters, Operand& operand) {
  const Type type = operand.type;
  const bool tuple = nodes::vector_types.has(type) || is_color(type);
  const size_t count = tuple ? graph::float_count(type) : 0;
  const std::string_view alphabet =
      letters.find_first_not_of(positions) == std::string_view::npos ? positions : channels;
  bool good = tuple && letters.size() <= 4;
  for (size_t i = 0; good && i < letters.size(); ++i) {
    const size_t component = alphabet.find(letters[i]);
    good = component < count;
    operand.swizzle[i] = static_cast<uint8_t>(component);
  }
  if (good) {
    operand.swizzle_count = static_cast<uint8_t>(letters.size());
    operand.type = tuple_of(letters.size(), is_color(type));
    return true;
  }
  const std::string name(graph::type_name(type));
  support::Diagnostic& report =
      work.report(Id::bad_swizzle, link.place, quote(letters) + " is not a valid swizzle of " + name);
  if (tuple) {
    report.note("a " + name + " has the components " + std::string(positions.substr(0, count)) + ", or " +
                std::string(channels.substr(0, count)));
  } else {
    report.note("only vectors and colours have components");
  }
  return false;
}

std::vector<std::string_view> output_names(const Node& node) {
  std::vector<std::string_view> names;
  if (node.row != nullptr) {
    for (const nodes::Output& output : node.row->outputs) names.push_back(output.name);
  } else {
    for (const graph::Output& output : node.callee->graph.outputs) names.push_back(output.name);
  }
  return names;
}

/// The output of `node` that a link refers to; removes the selector that names it from `rest`. Reports a missing or
/// ambiguous output and returns nullopt.
std::optional<uint32_t> find_output(Work& work, const Link& link, std::span<const std::string>& rest,
                                    const Node& node) {
  // The common case: one output, not named.
  const size_t count = node.output_count;
  if (rest.empty() && count == 1) return 0;
  const std::vector<std::string_view> names = output_names(node);
  for (uint32_t i = 0; i < count && !rest.empty(); ++i) {
    if (names[i] != rest.front()) continue;
    rest = rest.subspan(1);
    return i;
  }
  const bool names_one = rest.size() > 1 || (rest.size() == 1 && !looks_like_swizzle(rest.front()));
  if (!names_one) {
    for (uint32_t i = 0; i < count; ++i)
      if (count == 1 || names[i] == "out") return i;
  }
  const std::string what = names_one
                               ? quote(link.name) + " has no output " + quote(rest.front())
                               : quote(link.name) + " has several outputs; the link must name one";
  support::Diagnostic& report = work.report(Id::unknown_output, link.place, what);
  if (names_one) suggest_nearest(work.diagnostics, report, rest.front(), names);
  report.note((count == 1 ? "its output is " : "its outputs are ") + listed(names));
  return std::nullopt;
}

bool is_tuple(Type type) { return (nodes::vector_types | nodes::color_types).has(type); }

void begin(TypedGraph& typed, Type type, Operand& operand) {
  operand.from = Operand::From::words;
  operand.type = operand.needed = type;
  operand.index = static_cast<uint32_t>(typed.words.size());
}

/// Fills every component of a vector or colour, or the diagonal of a matrix.
void place_number(TypedGraph& typed, float value, Type type, Operand& operand) {
  begin(typed, type, operand);
  if (type == Type::integer) typed.words.push_back(static_cast<uint32_t>(static_cast<int32_t>(value)));
  if (type == Type::boolean) typed.words.push_back(value != 0 ? 1 : 0);
  const int count = graph::float_count(type);
  const int step = type == Type::matrix33 ? 4 : type == Type::matrix44 ? 5 : 1;
  for (int i = 0; i < count; ++i) typed.words.push_back(i % step == 0 ? std::bit_cast<uint32_t>(value) : 0);
}

}  // namespace

bool select(Work& work, const Link& link, Operand& operand) {
  std::span<const std::string> rest(link.selectors);
  if (operand.from == Operand::From::input) {
    operand.type = work.graph().inputs[operand.index].type;
  } else if (operand.from == Operand::From::node) {
    if (work.broken[operand.index]) return false;
    const Node& node = work.typed.nodes[operand.index];
    const std::optional<uint32_t> output = find_output(work, link, rest, node);
    if (!output) return false;
    operand.output = *output;
    operand.type = work.typed.types[node.first_type + *output];
  } else {
    return false;
  }
  if (rest.size() > 1) {
    work.report(Id::bad_link, link.place, quote(link.name) + " is an input and has no outputs");
    return false;
  }
  return rest.empty() || swizzle(work, link, rest.front(), operand);
}

std::string described(nodes::TypeSet types) {
  std::vector<std::string_view> names;
  for (const std::string_view name : graph::all_type_names())
    if (types.has(*graph::find_type(name))) names.push_back(name);
  std::string text;
  for (size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? " or " : ", ";
    text += names[i];
  }
  return text;
}

bool converts(Type from, Type to) {
  if (from == to) return true;
  if (from == Type::floating) return is_tuple(to);
  return from == Type::integer && to == Type::floating;
}

bool fits(const Literal& literal, Type type) {
  return graph::fits(type, literal) || (is_tuple(type) && literal.kind == Literal::Kind::number);
}

void place(TypedGraph& typed, const Literal& literal, Type type, Operand& operand) {
  if (type == Type::floating || (is_tuple(type) && literal.kind == Literal::Kind::number))
    return place_number(typed, literal.number, type, operand);
  begin(typed, type, operand);
  if (type == Type::boolean) typed.words.push_back(literal.boolean ? 1 : 0);
  if (type == Type::integer) typed.words.push_back(static_cast<uint32_t>(literal.integer));
  for (const float number : literal.numbers) typed.words.push_back(std::bit_cast<uint32_t>(number));
}

void place_file(TypedGraph& typed, File file, Operand& operand) {
  operand.from = Operand::From::file;
  operand.type = operand.needed = Type::filename;
  operand.index = static_cast<uint32_t>(typed.files.size());
  typed.files.push_back(std::move(file));
}

void place(TypedGraph& typed, const nodes::Default& value, Type type, Operand& operand) {
  if (const auto* attribute = std::get_if<nodes::SurfaceValue>(&value)) {
    operand.from = Operand::From::surface;
    operand.type = operand.needed = type;
    operand.index = static_cast<uint32_t>(attribute->index());
  } else if (const auto* numbers = std::get_if<std::array<float, 3>>(&value)) {
    begin(typed, type, operand);
    for (const float number : *numbers) typed.words.push_back(std::bit_cast<uint32_t>(number));
    typed.words.resize(operand.index + static_cast<size_t>(graph::float_count(type)));
  } else if (const auto* truth = std::get_if<bool>(&value); truth != nullptr && type == Type::boolean) {
    begin(typed, type, operand);
    typed.words.push_back(*truth ? 1 : 0);
  } else {
    place_number(typed, truth != nullptr ? 0.0f : std::get<float>(value), type, operand);
  }
}

std::string described(const Literal& literal) {
  switch (literal.kind) {
    case Literal::Kind::boolean: return "a boolean";
    case Literal::Kind::number: return "a number";
    case Literal::Kind::numbers: return "an array of " + std::to_string(literal.numbers.size()) + " numbers";
    case Literal::Kind::string: return "a string";
  }
  return {};
}

}  // namespace isoshade::check
