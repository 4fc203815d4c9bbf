// SPDX-License-Identifier: Apache-2.0
// The passes of an effect, and the images and outputs of a post.
#include <algorithm>
#include <utility>

#include "compiler/graph/graph_builder.h"
#include "compiler/support/visible.h"

namespace isoshade::graph {

using support::Id;
using support::quote;
using Need = ObjectReader::Need;

std::optional<uint32_t> GraphBuilder::read_switch(const Json& json, std::string_view key) {
  if (json.kind != Json::Kind::string) {
    diagnostics_.report(Id::wrong_type, document_.span(json),
                        quote(key) + " must be the name of a parameter, not " + std::string(kind_name(json.kind)));
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
                quote(key) + " of a " + std::string(graph_.kind == DocumentKind::post ? "post" : "pass") +
                    " must name a boolean, integer or float parameter, not a " +
                    std::string(type_name(input.type)))
        .note(graph_.span(input.name_place), "the parameter is declared here");
    return std::nullopt;
  }
  diagnostics_.report_unknown(
      Id::unknown_parameter, document_.span(json),
      "the " + std::string(kind_name(graph_.kind)) + " has no parameter " + quote(json.string), json.string,
      names);
  return std::nullopt;
}

void GraphBuilder::read_repeat(const Json& json, Pass& pass) {
  constexpr int most = interface::max_repeats;
  const std::string range = "1 to " + std::to_string(most);
  if (json.kind == Json::Kind::number) {
    const int64_t count = json.integral ? document_.to_integer(json) : 0;
    if (count >= 1 && count <= most)
      pass.repeat.count = static_cast<int>(count);
    else
      diagnostics_.report(json.integral ? Id::out_of_range : Id::wrong_type, document_.span(json),
                          "\"repeat\" must be a whole number from " + range);
    return;
  }
  if (json.kind != Json::Kind::string) {
    diagnostics_.report(Id::wrong_type, document_.span(json),
                        "\"repeat\" must be a whole number from " + range + " or the name of a parameter, not " +
                            std::string(kind_name(json.kind)));
    return;
  }
  const std::optional<uint32_t> number = read_switch(json, "repeat");
  if (!number) return;
  const Input& input = graph_.inputs[*number];
  if (input.type == Type::boolean) {
    diagnostics_
        .report(Id::type_mismatch, document_.span(json), "\"repeat\" must name an integer or float parameter, not a boolean")
        .note(graph_.span(input.name_place), "the parameter is declared here");
  } else if (!input.min || !input.max || *input.min < 1 || *input.max > static_cast<float>(most)) {
    diagnostics_
        .report(Id::out_of_range, document_.span(json),
                "\"repeat\" needs a parameter whose \"min\" and \"max\" lie in the range " + range)
        .note(graph_.span(input.name_place), "the parameter is declared here");
  } else {
    pass.repeat.parameter = *number;
  }
}

void GraphBuilder::read_cutout(ObjectReader& reader, Pass& pass) {
  const Json* cutout = reader.value("cutout", Need::optional);
  if (cutout != nullptr) pass.cutout = link(*cutout, "cutout");
  const Json* cutoff = reader.value("cutoff", Need::optional);
  if (cutoff == nullptr) return;
  if (cutout == nullptr) {
    diagnostics_
        .report(Id::missing_key, document_.span(*cutoff), "\"cutoff\" has no effect without \"cutout\"")
        .suggest("add \"cutout\", or remove this key");
  } else if (cutoff->kind == Json::Kind::string || cutoff->kind == Json::Kind::object) {
    pass.cutoff = link(*cutoff, "cutoff");
  } else if (cutoff->kind != Json::Kind::number) {
    diagnostics_.report(Id::wrong_type, document_.span(*cutoff),
                        "\"cutoff\" must be a number or a link, not " + std::string(kind_name(cutoff->kind)));
  } else if (auto value = parse_literal(document_, *cutoff, "cutoff", diagnostics_)) {
    pass.cutoff = constant(*std::move(value), "cutoff", Type::floating, place_of(*cutoff));
  }
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
                "\"position_space\" has no effect without \"position\"")
        .suggest("add \"position\", or remove this key");
  }
  for (const auto& [key, parameter] : {std::pair("enabled", &pass.enabled), std::pair("double_sided", &pass.double_sided),
                                      std::pair("blended", &pass.blended)})
    if (const Json* named = reader.value(key, Need::optional)) *parameter = read_switch(*named, key);
  for (const std::string_view key : {"blended", "depth_write"}) {
    const Json* useless = json.find(key);
    if (useless == nullptr || pass.state.blend != interface::Blend::none) continue;
    const bool is_none = json.find("blend") != nullptr;
    diagnostics_
        .report(Id::missing_key, document_.span(*useless),
                quote(key) + " has no effect " + (is_none ? "where \"blend\" is \"none\"" : "without \"blend\""))
        .suggest(is_none ? "choose another \"blend\", or remove this key" : "add \"blend\", or remove this key");
  }
  if (const Json* repeat = reader.value("repeat", Need::optional)) read_repeat(*repeat, pass);
  read_cutout(reader, pass);
  // A hull around an object, which shows its back faces as an outline, has no shadow of its own, and light shines through
  // what is blended.
  const bool may_be_opaque = pass.state.blend == interface::Blend::none || pass.blended;
  pass.casts_shadow = reader.boolean("casts_shadow", pass.state.cull != interface::Cull::front && may_be_opaque);
  pass.casts_blended_shadow = pass.casts_shadow && json.find("casts_shadow") != nullptr;
  pass.receives_shadow = reader.boolean("receives_shadow", true);
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
          .report(Id::duplicate_name, document_.span(*name), "two passes have the name " + quote(pass.name))
          .note(graph_.span(other.place), "the other one is here");
      break;
    }
  }
  graph_.passes.push_back(std::move(pass));
}

void GraphBuilder::read_passes(const Json& passes) {
  // A generous limit, small enough for the quadratic search for duplicate names.
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

void GraphBuilder::read_images(const Json& images) {
  constexpr size_t most = 8;
  if (images.items.size() > most) {
    diagnostics_.report(Id::too_large, document_.span(images),
                        "\"images\" of a post has at most " + std::to_string(most) + " names");
    return;
  }
  for (const Json& item : images.items) {
    if (item.kind != Json::Kind::string) {
      diagnostics_.report(Id::wrong_type, document_.span(item),
                          "\"images\" must be an array of names, but contains " + std::string(kind_name(item.kind)));
      continue;
    }
    check_id(item.string, place_of(item), "an image");
    const auto same = std::ranges::find(graph_.images, item.string, &InputImage::name);
    const bool reserved = item.string == post_output;
    if (same != graph_.images.end() || reserved) {
      support::Diagnostic& report =
          diagnostics_.report(Id::duplicate_name, document_.span(item),
                              reserved ? "\"color\" is reserved for the image that the post processes"
                                       : "two images have the name " + quote(item.string));
      if (!reserved) report.note(graph_.span(same->place), "the other one is here");
      continue;
    }
    graph_.images.push_back({item.string, place_of(item)});
  }
}

void GraphBuilder::read_post(ObjectReader& reader) {
  if (const Json* images = reader.array("images", Need::optional)) read_images(*images);
  const auto motion = std::ranges::find(graph_.nodes, motion_image_name, &Node::type);
  const bool is_listed = std::ranges::find(graph_.images, motion_image_name, &InputImage::name) != graph_.images.end();
  if (motion != graph_.nodes.end() && !is_listed)
    graph_.images.push_back({std::string(motion_image_name), motion->type_place});
  if (const Json* enabled = reader.value("enabled", Need::optional)) graph_.enabled = read_switch(*enabled, "enabled");
  for (const Output& output : graph_.outputs) {
    if (output.name == post_output) continue;
    diagnostics_
        .report(Id::unknown_output, graph_.span(output.name_place),
                "a post has no output " + quote(output.name))
        .note("its only output is \"color\"");
  }
}

}  // namespace isoshade::graph
