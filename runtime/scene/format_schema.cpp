// SPDX-License-Identifier: Apache-2.0
// The JSON Schema of scene documents, made from format.def.
#include "compiler/nodes/schema_json.h"
#include "runtime/scene/format.h"

namespace isoshade::scene::format {
namespace {

using nodes::SchemaJson;
using nodes::SchemaKey;

const SchemaJson null_schema = nodes::null_schema();
const SchemaJson any_object{{"type", "object"}};

SchemaJson definition(Object object) {
  return nodes::reference(object == Object::scene ? "scene" : "scene_" + std::string(row_of(object).name));
}

SchemaJson bounded(SchemaJson number, const Range& range) {
  number["minimum"] = range.low;
  number["maximum"] = range.high;
  return number;
}
SchemaJson number(const Range& range) { return bounded(nodes::number_schema(), range); }
SchemaJson numbers(size_t count, const Range& range) {
  return nodes::array_schema(number(range), count, count);
}
SchemaJson integer(const Range& range) {
  return nodes::integer_schema(static_cast<int64_t>(range.low), static_cast<int64_t>(range.high));
}

/// An object whose keys are paths of two or more names.
SchemaJson by_path(SchemaJson value) {
  return {{"type", "object"},
          {"propertyNames", {{"pattern", "^[A-Za-z0-9_]+(\\.[A-Za-z0-9_]+)*$"}}},
          {"additionalProperties", std::move(value)}};
}

/// One overload for each type: one that is missing does not compile.
struct TypeSchema {
  SchemaJson operator()(const Boolean&) const { return nodes::boolean_schema(); }
  SchemaJson operator()(const Integer& type) const { return integer(type.range); }
  SchemaJson operator()(const Number& type) const { return number(type.range); }
  template <size_t N>
  SchemaJson operator()(const Numbers<N>& type) const {
    return numbers(N, type.range);
  }
  SchemaJson operator()(const Size& type) const { return nodes::array_schema(integer(type.range), 2, 2); }
  SchemaJson operator()(const Samples& type) const { return {{"enum", type.values}}; }
  SchemaJson operator()(const Scale& type) const {
    return nodes::any_of({number(type.range), numbers(3, type.range)});
  }
  SchemaJson operator()(const Rotation& type) const {
    return nodes::any_of({numbers(3, type.range), numbers(4, {-1, 1})});
  }
  SchemaJson operator()(const Choice& type) const {
    return nodes::one_of({type.words.begin(), type.words.end()});
  }
  SchemaJson operator()(const Name&) const { return nodes::reference("id"); }
  SchemaJson operator()(const Path&) const { return nodes::string_schema(); }
  SchemaJson operator()(const Literal&) const { return nodes::reference("literal"); }
  SchemaJson operator()(const Literals&) const {
    return {{"type", "array"}, {"items", nodes::reference("literal")}, {"minItems", 1}};
  }
  SchemaJson operator()(const MapOfLiterals&) const { return nodes::map_schema(nodes::reference("literal")); }
  SchemaJson operator()(const MapOfNames&) const { return nodes::map_schema(nodes::reference("id")); }
  SchemaJson operator()(const Keyframes&) const {
    const SchemaJson key{{"type", "array"},
                         {"items", SchemaJson::array({number(coordinates), nodes::reference("literal")})},
                         {"minItems", 2},
                         {"maxItems", 2}};
    return {{"type", "array"}, {"items", key}, {"minItems", 1}};
  }
  SchemaJson operator()(const MapOfPaths& type) const { return by_path(definition(type.object)); }
  SchemaJson operator()(const ObjectOf& type) const { return definition(type.object); }
  SchemaJson operator()(const MapOf& type) const {
    SchemaJson schema = nodes::map_schema(definition(type.object));
    if (type.most != no_limit) schema["maxProperties"] = type.most;
    return schema;
  }
  SchemaJson operator()(const ListOf& type) const {
    return nodes::array_schema(definition(type.object), type.least, type.most);
  }
};

SchemaJson schema_of(const KeyRow& key) {
  SchemaJson schema = std::visit(TypeSchema{}, key.type);
  return key.doc.empty() ? schema : nodes::described(std::move(schema), key.doc);
}

std::vector<SchemaKey> keys_with_schemas(Object object, Forms forms) {
  std::vector<SchemaKey> keys;
  for (const KeyRow* key : keys_of(object, forms))
    keys.push_back({key->name, schema_of(*key), key->required});
  return keys;
}

const KeyRow* key_named(Object object, std::string_view name) {
  for (const KeyRow* key : keys_of(object))
    if (key->name == name) return key;
  return nullptr;
}

/// What may stand in place of an object: the value of its shorthand, for those forms that need no other key.
SchemaJson shorthand_schema(const ObjectRow& object) {
  const KeyRow& key = *key_named(object.object, object.shorthand);
  if (object.forms.empty()) return schema_of(key);
  std::vector<std::string_view> names;
  for (size_t i = 0; i < object.forms.size(); ++i) {
    const std::vector<const KeyRow*> keys = keys_of(object.object, of(i));
    const bool enough = std::ranges::all_of(
        keys, [&](const KeyRow* other) { return !other->required || other->name == object.shorthand; });
    if (enough) names.push_back(object.forms[i]);
  }
  return nodes::one_of(names);
}

SchemaJson object_schema_of(const ObjectRow& object) {
  const KeyRow* tag = key_named(object.object, "type");
  SchemaJson schema;
  if (object.forms.empty()) {
    schema = nodes::object_schema(keys_with_schemas(object.object, every));
  } else if (tag == nullptr) {
    std::vector<SchemaJson> forms;
    for (size_t i = 0; i < object.forms.size(); ++i)
      forms.push_back(nodes::object_schema(keys_with_schemas(object.object, of(i))));
    schema = nodes::any_of(std::move(forms));
  } else {
    std::vector<std::pair<std::string_view, std::vector<SchemaKey>>> forms;
    for (size_t i = 0; i < object.forms.size(); ++i) {
      forms.emplace_back(object.forms[i], keys_with_schemas(object.object, of(i)));
      std::erase_if(forms.back().second, [&](const SchemaKey& key) { return key.name == tag->name; });
    }
    schema = nodes::variants_schema(tag->name, tag->required, forms);
  }
  if (!object.shorthand.empty()) schema = nodes::any_of({shorthand_schema(object), std::move(schema)});
  return object.doc.empty() ? schema : nodes::described(std::move(schema), object.doc);
}

/// An object of a scene that extends another one: no key is required, and null removes one. The keys of objects that
/// have a type are not checked, as the type may be that of the other scene's object.
SchemaJson changes_of(Object object) {
  const ObjectRow& row = row_of(object);
  if (!row.shorthand.empty()) return nodes::any_of({definition(object), any_object});
  if (!row.forms.empty()) return any_object;
  std::vector<SchemaKey> keys;
  for (const KeyRow* key : keys_of(object)) {
    SchemaJson schema = schema_of(*key);
    if (const auto* part = std::get_if<ObjectOf>(&key->type)) schema = changes_of(part->object);
    if (const auto* map = std::get_if<MapOf>(&key->type))
      schema = nodes::map_schema(nodes::any_of({changes_of(map->object), null_schema}));
    if (const auto* map = std::get_if<MapOfPaths>(&key->type))
      schema = by_path(nodes::any_of({changes_of(map->object), null_schema}));
    if (std::holds_alternative<MapOfLiterals>(key->type))
      schema = nodes::map_schema(nodes::any_of({nodes::reference("literal"), null_schema}));
    keys.push_back({key->name, nodes::any_of({std::move(schema), null_schema})});
  }
  return nodes::object_schema(keys);
}

std::vector<SchemaKey> with_document_keys(std::vector<SchemaKey> keys) {
  std::vector<SchemaKey> all = nodes::document_keys("scene");
  for (SchemaKey& key : keys)
    if (key.name != "scene") all.push_back(std::move(key));
  return all;
}

}  // namespace

nodes::DocumentSchema schema() {
  SchemaJson definitions;
  for (const ObjectRow& object : objects())
    if (object.object != Object::scene)
      definitions["scene_" + std::string(object.name)] = object_schema_of(object);
  const SchemaJson changes = changes_of(Object::scene);
  std::vector<SchemaKey> whole = keys_with_schemas(Object::scene, every), changed;
  for (const SchemaKey& key : whole)
    changed.push_back(key.name == scene::extends.name
                          ? SchemaKey{key.name, key.schema, true}
                          : SchemaKey{key.name, changes["properties"][std::string(key.name)]});
  definitions["scene"] = {{"if", {{"required", {scene::extends.name}}}},
                          {"then", nodes::object_schema(with_document_keys(changed))},
                          {"else", nodes::object_schema(with_document_keys(whole))}};
  return {"scene", "a scene to render, and its name", definitions.dump()};
}

}  // namespace isoshade::scene::format
