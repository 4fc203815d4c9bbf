// SPDX-License-Identifier: Apache-2.0
// Building blocks of JSON schemas.
#pragma once

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace isoshade::nodes {

using SchemaJson = nlohmann::ordered_json;

/// A key of an object.
struct SchemaKey {
  std::string_view name;
  SchemaJson schema;
  bool required = false;
};

inline SchemaJson described(SchemaJson schema, std::string_view doc) {
  SchemaJson result{{"description", doc}};
  result.update(schema);
  return result;
}
inline SchemaJson reference(std::string_view definition) {
  return {{"$ref", "#/definitions/" + std::string(definition)}};
}
inline SchemaJson any_of(std::vector<SchemaJson> schemas) { return {{"anyOf", std::move(schemas)}}; }
inline SchemaJson one_of(std::vector<std::string_view> words) { return {{"enum", std::move(words)}}; }
inline SchemaJson string_schema() { return {{"type", "string"}}; }
inline SchemaJson number_schema() { return {{"type", "number"}}; }
inline SchemaJson null_schema() { return {{"type", "null"}}; }
inline SchemaJson boolean_schema() { return {{"type", "boolean"}}; }
inline SchemaJson number_schema(double low, double high) {
  return {{"type", "number"}, {"minimum", low}, {"maximum", high}};
}
inline SchemaJson integer_schema(int64_t low, int64_t high) {
  return {{"type", "integer"}, {"minimum", low}, {"maximum", high}};
}
inline SchemaJson array_schema(SchemaJson item, size_t least, size_t most) {
  return {{"type", "array"}, {"items", std::move(item)}, {"minItems", least}, {"maxItems", most}};
}
inline SchemaJson numbers_schema(size_t count) { return array_schema(number_schema(), count, count); }

/// An object with these keys and no other.
SchemaJson closed_schema(const std::vector<SchemaKey>& keys);
/// An object with these keys, `extras` and no other.
SchemaJson object_schema(const std::vector<SchemaKey>& keys);
/// An object whose keys are ids.
SchemaJson map_schema(SchemaJson value);
/// An object of several kinds; the value of `key` selects the kind. Without the key, if it is optional, it is the first.
SchemaJson variants_schema(std::string_view key, bool required,
                           const std::vector<std::pair<std::string_view, std::vector<SchemaKey>>>& kinds);

/// The keys of every document: those that all kinds share, and the one that states the kind.
std::vector<SchemaKey> document_keys(std::string_view kind);

}  // namespace isoshade::nodes
