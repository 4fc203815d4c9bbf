// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/library_rows.h"

#include <algorithm>

#include "compiler/nodes/table.h"
#include "compiler/support/parse_number.h"

namespace isoshade::driver {
namespace {

/// "0 to 1", "at least 0", "0 (world) or 1 (screen)"; empty if the range is unlimited.
std::string range_text(const graph::Input& input) {
  if (!input.names.empty()) {
    std::string text;
    for (size_t i = 0; i < input.names.size(); ++i)
      text += (i == 0 ? "" : i + 1 == input.names.size() ? " or " : ", ") + std::to_string(i) + " (" +
              input.names[i] + ")";
    return text;
  }
  const auto limit = [&](float number) { return graph::limit_text(input.type, number); };
  if (input.min && input.max) return limit(*input.min) + " to " + limit(*input.max);
  if (input.min) return "at least " + limit(*input.min);
  if (input.max) return "at most " + limit(*input.max);
  return {};
}

std::string doc_of(const graph::Input& input) {
  std::string text = input.doc;
  for (const std::string& part : {range_text(input), std::string(input.unit ? "of length 1" : "")})
    if (!part.empty()) text += (text.empty() ? "" : "; ") + part;
  return text;
}

/// The documentation, and what keeps the function from being called everywhere.
std::string doc_of(const check::TypedGraph& function) {
  using check::StageNeed;
  constexpr std::pair<StageNeed, std::string_view> all[] = {
      {StageNeed::surface, "the surface"}, {StageNeed::vertex, "the vertex"},
      {StageNeed::pixel, "the pixel"},     {StageNeed::images, "images"},
      {StageNeed::lights, "the lights"},   {StageNeed::derivatives, "derivatives"},
      {StageNeed::repetition, "the repetition of the pass"},
      {StageNeed::environment, "the environment"}, {StageNeed::time, "the time"}};
  static_assert(std::size(all) == check::stage_need_count);
  std::vector<std::string_view> read;
  for (const auto& [need, name] : all)
    if (function.needs(need)) read.push_back(name);
  std::string text = function.graph.doc;
  if (read.empty()) return text;
  text += (text.empty() ? "Reads " : " Reads ");
  for (size_t i = 0; i < read.size(); ++i)
    text += std::string(i == 0 ? "" : i + 1 == read.size() ? " and " : ", ") + std::string(read[i]);
  const bool for_posts =
      std::ranges::all_of(all, [&](const auto& one) { return check::posts_have(one.first) || !function.needs(one.first); });
  return text + (for_posts ? ": for effects and posts." : ": for effects only.");
}

nodes::PortType type_of(const graph::Input& input) {
  return input.any ? nodes::AnyFloat : nodes::PortType{nodes::only(input.type)};
}

}  // namespace

nodes::Port LibraryRows::port_of(const graph::Input& input) {
  nodes::Port port{keep(input.name), type_of(input), keep(doc_of(input))};
  if (!input.value) return port;
  const graph::Literal& value = *input.value;
  switch (value.kind) {
    case graph::Literal::Kind::boolean: port.value = value.boolean; break;
    case graph::Literal::Kind::number: port.value = value.number; break;
    case graph::Literal::Kind::string: port.value = keep(value.string); break;
    case graph::Literal::Kind::numbers:
      if (value.numbers.size() == 3) {
        port.value = std::array{value.numbers[0], value.numbers[1], value.numbers[2]};
        break;
      }
      std::string text;
      for (const float number : value.numbers) text += (text.empty() ? "" : ", ") + support::format_float(number);
      port.value = keep(text);
      break;
  }
  return port;
}

LibraryRows::LibraryRows(check::Library& library, support::Diagnostics& diagnostics) {
  const check::Scope scope = library.scope_of({});
  for (const std::string& name : library.names()) {
    const auto function = library.function({name, nodes::table()}, scope, {}, diagnostics);
    if (function == nullptr) continue;
    nodes::Row row{keep(name), keep(doc_of(*function)), {}, nodes::Outputs{}, nodes::Function{}};
    for (const graph::Input& input : function->graph.inputs) row.ports.push_back(port_of(input));
    for (size_t i = 0; i < function->graph.outputs.size(); ++i)
      row.outputs.push_back(
          {keep(function->graph.outputs[i].name), nodes::PortType{nodes::only(function->outputs[i].needed)}});
    row.group = "library";
    rows_.push_back(std::move(row));
  }
}

}  // namespace isoshade::driver
