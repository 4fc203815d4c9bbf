// SPDX-License-Identifier: Apache-2.0
#include "compiler/nodes/schema.h"

#include "compiler/graph/expression.h"
#include "compiler/graph/extend.h"
#include "compiler/graph/image_document.h"
#include "compiler/nodes/example.h"
#include "compiler/nodes/manual.h"
#include "compiler/nodes/schema_json.h"

namespace isoshade::nodes {

SchemaJson closed_schema(const std::vector<SchemaKey>& keys) {
  SchemaJson properties = SchemaJson::object();
  std::vector<std::string_view> required;
  for (const SchemaKey& key : keys) {
    properties[std::string(key.name)] = key.schema;
    if (key.required) required.push_back(key.name);
  }
  SchemaJson schema{{"type", "object"}};
  if (!required.empty()) schema["required"] = required;
  schema["properties"] = std::move(properties);
  schema["additionalProperties"] = false;
  return schema;
}

SchemaJson object_schema(const std::vector<SchemaKey>& keys) {
  SchemaJson schema = closed_schema(keys);
  schema["properties"]["extras"] = true;
  return schema;
}

SchemaJson map_schema(SchemaJson value) {
  return {{"type", "object"}, {"propertyNames", reference("id")}, {"additionalProperties", std::move(value)}};
}

SchemaJson variants_schema(std::string_view key, bool required,
                           const std::vector<std::pair<std::string_view, std::vector<SchemaKey>>>& kinds) {
  std::vector<std::string_view> names;
  std::vector<SchemaJson> branches;
  const std::string tag(key);
  for (const auto& [name, keys] : kinds) {
    std::vector<SchemaKey> all{{key, true}};
    all.insert(all.end(), keys.begin(), keys.end());
    SchemaJson condition{{"properties", {{tag, {{"const", name}}}}}};
    if (!names.empty() || required) condition["required"] = {tag};
    branches.push_back({{"if", condition}, {"then", object_schema(all)}});
    names.push_back(name);
  }
  SchemaJson schema{{"type", "object"}};
  if (required) schema["required"] = {tag};
  schema["properties"] = {{tag, one_of(names)}};
  schema["allOf"] = branches;
  return schema;
}

std::vector<SchemaKey> document_keys(std::string_view kind) {
  return {{"$schema", string_schema()},
          {"isoshade", {{"const", 1}}, true},
          {kind, reference("id"), true},
          {"doc", string_schema()}};
}

namespace {

/// The values of a port of these types: a link, or a literal of one of them.
SchemaJson value_schema(TypeSet accepts) {
  std::vector<SchemaJson> forms{reference("link")};
  const auto has = [&](TypeSet types) { return (accepts.bits & types.bits) != 0; };
  if (accepts == only(Type::filename))
    forms = {string_schema(), object_schema({{"link", string_schema(), true}})};
  if (has(only(Type::boolean))) forms.push_back(boolean_schema());
  if (accepts == only(Type::integer)) {
    forms.push_back({{"type", "integer"}});
  } else if (has(float_types | only(Type::integer))) {
    forms.push_back(number_schema());
  }
  if (has(only(Type::vector2))) forms.push_back(numbers_schema(2));
  if (has(only(Type::vector3) | only(Type::color3))) forms.push_back(numbers_schema(3));
  if (has(only(Type::vector4) | only(Type::color4))) forms.push_back(numbers_schema(4));
  if (has(only(Type::matrix33))) forms.push_back(numbers_schema(9));
  if (has(only(Type::matrix44))) forms.push_back(numbers_schema(16));
  return any_of(std::move(forms));
}

SchemaJson port_schema(const Port& port) {
  std::string doc = std::string(port.doc) + ": " + type_text(port.type);
  const std::string value = default_text(port);
  if (!value.empty()) doc += "; default " + value;
  switch (port.type.kind) {
    case PortType::Kind::type_name: {
      std::vector<std::string_view> names;
      for (const Type type : types_in(port.type.accepts)) names.push_back(graph::type_name(type));
      return described(one_of(names), doc);
    }
    case PortType::Kind::choice:
      if (port.takes_input)
        return described(any_of({one_of(port.choices), object_schema({{"link", string_schema(), true}})}), doc);
      return described(one_of(port.choices), doc);
    case PortType::Kind::component: return described({{"type", "integer"}, {"minimum", 0}}, doc);
    case PortType::Kind::integer: return described({{"type", "integer"}}, doc);
    case PortType::Kind::image: return described(reference("id"), doc);
    case PortType::Kind::value: break;
  }
  return described(value_schema(port.type.accepts), doc);
}

SchemaJson row_schema(const Row& row) {
  std::vector<SchemaKey> keys{{"type", true, true}, {"doc", string_schema()}};
  for (const Port& port : row.ports) keys.push_back({port.name, port_schema(port), port.required(true)});
  return object_schema(keys);
}

SchemaJson node_schema(std::span<const Row> library) {
  std::vector<SchemaJson> types, branches;
  const auto add = [&](std::string_view name, std::string_view doc, SchemaJson schema) {
    types.push_back({{"const", name}, {"description", doc}});
    branches.push_back({{"if", {{"properties", {{"type", {{"const", name}}}}}, {"required", {"type"}}}},
                        {"then", std::move(schema)}});
  };
  for (const Row& row : table()) add(row.name, row.doc, row_schema(row));
  for (const Row& row : library) add(row.name, row.doc, row_schema(row));
  add(graph::expression_type, graph::expression_doc,
      {{"required", {"code"}},
       {"properties",
        {{"code", {{"description", "such as \"a*a / (pi * t*t)\""}, {"type", "string"}}},
         {"doc", string_schema()},
         {"extras", true}}},
       {"additionalProperties", reference("port")}});
  types.push_back({{"pattern", "\\.json$"},
                   {"description", "a function document: a path that ends in .json"},
                   {"type", "string"}});
  return {{"type", "object"},
          {"required", {"type"}},
          {"properties", {{"type", {{"anyOf", types}}}, {"doc", string_schema()}, {"extras", true}}},
          {"additionalProperties", reference("port")},
          {"allOf", branches}};
}

std::vector<SchemaKey> input_keys(bool is_parameter) {
  std::vector<std::string_view> types = graph::all_type_names();
  if (!is_parameter) types.push_back(graph::any_type_name);
  std::vector<SchemaKey> keys{{"type", one_of(types), true},
                              {"min", described(number_schema(), "the least that a component may be")},
                              {"max", described(number_schema(), "the greatest that a component may be")},
                              {"enum", described(array_schema(reference("id"), 1, 64),
                                                 "what the values 0, 1, ... of an integer are called")},
                              {"value", reference("literal"), is_parameter},
                              {"doc", string_schema()}};
  if (!is_parameter) keys.push_back({"unit", described(boolean_schema(), "a vector of length 1")});
  if (is_parameter)
    keys.push_back({"dynamic", described(boolean_schema(), "whether it changes often: then no program is compiled for one "
                                                           "value of it")});
  return keys;
}

SchemaJson or_null(SchemaJson schema) { return any_of({std::move(schema), null_schema()}); }

/// A map of changes to the members of a base; null removes one.
SchemaJson changes_schema(SchemaJson change) { return or_null(map_schema(or_null(std::move(change)))); }

/// What an effect that extends another one says of a parameter of that one.
SchemaJson parameter_change_schema() {
  std::vector<SchemaKey> keys = input_keys(true);
  for (SchemaKey& key : keys) key = {key.name, or_null(std::move(key.schema))};
  return object_schema(keys);
}

/// And of a node: a whole node, or ports alone. Whether a node of the type has these ports is not checked.
SchemaJson node_change_schema() {
  return {{"if", {{"required", {"type"}}}},
          {"then", reference("node")},
          {"else",
           {{"type", "object"},
            {"properties", {{"doc", or_null(string_schema())}, {"extras", true}}},
            {"additionalProperties", or_null(reference("port"))}}}};
}

SchemaJson color_schema() {
  return any_of({reference("link"), number_schema(), numbers_schema(3), numbers_schema(4)});
}

SchemaJson pass_schema() {
  std::vector<SchemaKey> keys{{"name", reference("id"), true}};
  for (const interface::PassStateRow& row : interface::pass_states())
    keys.push_back({row.key, described(one_of(row.values), row.doc)});
  keys.insert(keys.end(), {{"position", described(reference("link"), "where vertices go; else they stay")},
                           {"position_space", one_of({"world", "object", "view"})},
                           {"enabled", described(string_schema(), "a parameter: drawn where it is not 0 or false")},
                           {"double_sided",
                            described(string_schema(), "a parameter: nothing is culled where it is not 0 or false")},
                           {"blended",
                            described(string_schema(), "a parameter: the pass is opaque where it is 0 or false")},
                           {"repeat", described(any_of({integer_schema(1, interface::max_repeats), string_schema()}),
                                                "how often the pass is drawn, or the parameter that says it: default 1")},
                           {"cutout", described(reference("link"),
                                                "drawn where it holds: a boolean, or a float of at least \"cutoff\"")},
                           {"cutoff", described(any_of({reference("link"), number_schema()}),
                                                "of a float \"cutout\": default 0.5; 0: drawn everywhere")},
                           {"casts_shadow", described(boolean_schema(),
                                                      "whether lights with shadows see it: default true, but false for "
                                                      "a pass that culls front faces, as outlines do, and where "
                                                      "the pass is blended")},
                           {"receives_shadow", described(boolean_schema(), "whether shadows fall on it: default true")},
                           {"color", color_schema(), true}});
  return object_schema(keys);
}

SchemaJson with_one_key(SchemaJson map) {
  map["minProperties"] = 1;
  return map;
}

SchemaJson graph_schema(std::string_view kind, const std::vector<SchemaKey>& rest) {
  std::vector<SchemaKey> keys = document_keys(kind);
  keys.insert(keys.end(), rest.begin(), rest.end());
  keys.push_back({"nodes", map_schema(reference("node"))});
  return object_schema(keys);
}

}  // namespace

std::string json_schema(std::span<const Row> library, const DocumentSchema& scene) {
  constexpr std::string_view id = "[A-Za-z_][A-Za-z0-9_]{0,127}";
  const std::string link = "^" + std::string(id) + "(\\." + std::string(id) + "){0,2}$";
  SchemaJson definitions;
  definitions["id"] = {{"type", "string"}, {"pattern", "^" + std::string(id) + "$"}};
  definitions["link"] = {{"description", "\"node\", \"node.output\" or \"node.xyz\""},
                         {"anyOf",
                          {{{"type", "string"}, {"pattern", link}},
                           object_schema({{"link", {{"type", "string"}, {"pattern", link}}, true}})}}};
  definitions["literal"] =
      any_of({boolean_schema(), number_schema(), string_schema(), array_schema(number_schema(), 1, 16)});
  definitions["port"] = any_of({reference("literal"), reference("link")});
  definitions["node"] = node_schema(library);
  definitions["input"] = object_schema(input_keys(false));
  definitions["parameter"] = object_schema(input_keys(true));
  definitions["pass"] = pass_schema();
  const SchemaJson outputs = with_one_key(map_schema(reference("link")));
  const SchemaJson parameters = map_schema(reference("parameter"));
  definitions["function"] =
      graph_schema("function", {{"inputs", map_schema(reference("input"))}, {"outputs", outputs, true}});
  const SchemaJson passes = array_schema(reference("pass"), 1, 64);
  std::vector<SchemaKey> changes = document_keys("effect");
  changes.insert(changes.end(),
                 {{graph::extends_key, described(string_schema(), "path of the effect that this one changes"), true},
                  {"parameters", changes_schema(parameter_change_schema())},
                  {"passes", passes},
                  {"nodes", changes_schema(node_change_schema())}});
  definitions["effect"] = {{"if", {{"required", {graph::extends_key}}}},
                           {"then", object_schema(changes)},
                           {"else", graph_schema("effect", {{"parameters", parameters}, {"passes", passes, true}})}};
  definitions["post"] = graph_schema(
      "post",
      {{"parameters", parameters},
       {"images", described(array_schema(reference("id"), 0, 8), "names of further images that it reads")},
       {"enabled", described(reference("id"), "a parameter: where it is 0, the post is not run")},
       {"outputs", object_schema({{"color", color_schema(), true}}), true}});
  const SchemaJson layer = object_schema(
      {{"file", described(string_schema(), "path of an image file: the largest mip level; the others are computed")},
       {"levels", described(array_schema(string_schema(), 1, graph::max_image_levels),
                            "instead of `file`: of each mip level, from the largest on, each half the size")},
       {"count", described(integer_schema(1, graph::max_image_layers),
                           "how many layers stand in each file, one below the other; default 1")}});
  SchemaJson image_layers = array_schema(layer, 1, graph::max_image_layers);
  definitions["image"] = graph_schema("image", {{"layers", described(std::move(image_layers), "in order"), true}});
  definitions["image"]["properties"].erase("nodes");
  definitions.update(SchemaJson::parse(scene.definitions));
  struct Kind {
    std::string_view key, doc;
  };
  const Kind kinds[] = {{"function", "a function that graphs use as a node, and its name"},
                        {"effect", "an effect that draws a mesh, and its name"},
                        {"post", "a full-screen effect over a finished image, and its name"},
                        {scene.kind, scene.doc},
                        {"image", "an image of several layers or with mip levels of its own, and its name"}};
  // Editors complete the keys in "properties"; the other keys depend on the kind of document.
  SchemaJson properties{{"$schema", string_schema()}, {"isoshade", {{"const", 1}}}};
  std::vector<SchemaJson> one, branches;
  for (const Kind& kind : kinds) {
    const SchemaJson has{{"required", {kind.key}}};
    properties[std::string(kind.key)] = described(reference("id"), kind.doc);
    one.push_back(has);
    branches.push_back({{"if", has}, {"then", reference(kind.key)}});
  }
  const SchemaJson schema{{"$schema", "http://json-schema.org/draft-07/schema#"},
                          {"title", "isoshade document"},
                          {"type", "object"},
                          {"required", {"isoshade"}},
                          {"properties", properties},
                          {"oneOf", one},
                          {"allOf", branches},
                          {"definitions", definitions}};
  return schema.dump(1) + "\n";
}

}  // namespace isoshade::nodes
