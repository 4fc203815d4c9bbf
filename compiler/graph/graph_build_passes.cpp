// SPDX-License-Identifier: Apache-2.0
// The passes of an effect.
#include "compiler/graph/graph_builder.h"
#include "compiler/support/visible.h"

namespace isoshade::graph {

using support::Id;
using support::quote;
using Need = ObjectReader::Need;

/// The parameter that switches a pass: the text of "enabled".
std::optional<uint32_t> GraphBuilder::switch_of(const Json& json) {
  if (json.kind != Json::Kind::string) {
    diagnostics_.report(Id::wrong_type, document_.span(json),
                        "\"enabled\" is the name of a parameter, not " + std::string(kind_name(json.kind)));
    return std::nullopt;
  }
  std::vector<std::string_view> names;
  for (uint32_t i = 0; i < graph_.inputs.size(); ++i) {
    const Input& input = graph_.inputs[i];
    names.push_back(input.name);
    if (input.name != json.string) continue;
    const bool one =
        input.type == Type::boolean || input.type == Type::integer || input.type == Type::floating;
    if (one) return i;
    diagnostics_
        .report(Id::type_mismatch, document_.span(json),
                "a " + std::string(graph_.kind == DocumentKind::post ? "post" : "pass") +
                    " is switched by a boolean, an integer or a float, not by a " +
                    std::string(type_name(input.type)))
        .note(graph_.span(input.name_place), "the parameter");
    return std::nullopt;
  }
  diagnostics_.report_unknown(
      Id::unknown_parameter, document_.span(json),
      "the " + std::string(kind_name(graph_.kind)) + " has no parameter " + quote(json.string), json.string,
      names);
  return std::nullopt;
}

void GraphBuilder::read_pass(const Json& json) {
  Pass pass;
  pass.place = place_of(json);
  ObjectReader reader(document_, json, "a pass", diagnostics_);
  pass.name = reader.string("name");
  for (const interface::PassStateRow& row : interface::pass_states())
    row.set(pass.state, reader.choice(row.key, row.values, row.fallback));
  const Json* position = reader.value("position", Need::optional);
  if (position != nullptr) pass.position = link(*position, "position");
  pass.position_space =
      static_cast<PositionSpace>(reader.choice("position_space", {"world", "object", "view"}, 0));
  if (const Json* space = json.find("position_space"); space != nullptr && position == nullptr) {
    diagnostics_
        .report(Id::missing_key, document_.span(*space),
                "\"position_space\" says nothing without \"position\"")
        .suggest("link \"position\" to where vertices go, or leave this out");
  }
  if (const Json* enabled = reader.value("enabled", Need::optional)) pass.enabled = switch_of(*enabled);
  if (const Json* color = reader.value("color")) {
    if (std::optional<Link> found = this->color(*color)) pass.color = std::move(*found);
  }
  reader.finish();
  const Json* name = json.find("name");
  if (name != nullptr && name->kind == Json::Kind::string) {
    check_id(pass.name, place_of(*name), "a pass");
    for (const Pass& other : graph_.passes) {
      if (other.name != pass.name) continue;
      diagnostics_
          .report(Id::duplicate_name, document_.span(*name), "two passes are called " + quote(pass.name))
          .note(graph_.span(other.place), "the other one");
      break;
    }
  }
  graph_.passes.push_back(std::move(pass));
}

void GraphBuilder::read_passes(const Json& passes) {
  // Few enough to compare each with each; nobody draws a mesh so often.
  constexpr size_t most = 64;
  if (passes.items.empty()) {
    diagnostics_.report(Id::missing_key, document_.span(passes), "an effect needs at least one pass");
  } else if (passes.items.size() > most) {
    diagnostics_.report(Id::too_large, document_.span(passes),
                        "an effect has at most " + std::to_string(most) + " passes");
  } else {
    for (const Json& pass : passes.items) read_pass(pass);
  }
}

}  // namespace isoshade::graph
