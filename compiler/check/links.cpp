// SPDX-License-Identifier: Apache-2.0
#include "compiler/check/links.h"

namespace isoshade::check {
namespace {

using graph::Link;
using support::Id;
using support::quote;

constexpr std::string_view positions = "xyzw";
constexpr std::string_view channels = "rgba";

bool is_color(Type type) { return nodes::color_types.has(type); }

/// Whether letters could be meant as a swizzle: otherwise they are the name of an output.
bool looks_like_swizzle(std::string_view letters) {
  return letters.size() <= 4 && (letters.find_first_not_of(positions) == std::string_view::npos ||
                                 letters.find_first_not_of(channels) == std::string_view::npos);
}

/// What `count` components of a value make.
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
      work.report(Id::bad_swizzle, link.place, quote(letters) + " are no components of a " + name);
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

/// Which output of a node a link means; `rest` loses the selector that names it. Nothing if it is unclear.
std::optional<uint32_t> find_output(Work& work, const Link& link, std::span<const std::string>& rest,
                                    const Node& node) {
  // Most nodes have one output, which most links do not name.
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
                               : quote(link.name) + " has several outputs, of which the link must name one";
  support::Diagnostic& report = work.report(Id::unknown_output, link.place, what);
  if (names_one) suggest_nearest(work.diagnostics, report, rest.front(), names);
  report.note((count == 1 ? "its output is " : "its outputs are ") + listed(names));
  return std::nullopt;
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
    work.report(Id::bad_link, link.place, quote(link.name) + " is an input: it has no outputs to name");
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

}  // namespace isoshade::check
