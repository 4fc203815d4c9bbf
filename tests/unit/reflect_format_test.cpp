// SPDX-License-Identifier: Apache-2.0
// The format of reflections: JSON, schema and manual come from one table. schema_test.py validates the reflections of
// all shipped documents.
#include <functional>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <set>

#include "compiler/reflect/reflection.h"

namespace isoshade::reflect {
namespace {

using nlohmann::ordered_json;

/// A reflection that holds one of everything.
Reflection sample() {
  Reflection made;
  made.kind.text = "effect";
  made.name = "fur";
  made.document = "effects/fur.json";
  made.prefix = "fur";
  made.precision.text = "default";
  made.division.text = "native";
  made.files = {{"effects/fur.json", FileRole::document, "00"}, {"t.png", FileRole::image, {}}};
  Parameter parameter;
  parameter.name = "length";
  parameter.type.text = "float";
  parameter.min = 0.5;
  parameter.fields = {"length"};
  made.parameters = {parameter};
  Pass pass;
  pass.name = "base";
  pass.enabled = "length";
  made.passes = {pass};
  return made;
}

ordered_json json_of(const Reflection& reflection) { return ordered_json::parse(json(reflection)); }

ordered_json default_of(graph::Type type, graph::Literal literal) {
  Reflection made = sample();
  made.parameters[0].value = Value{type, std::move(literal)};
  return json_of(made)["parameters"][0]["value"];
}

TEST(ReflectionFormat, WritesEveryRequiredKeyInOrderAndOmitsAbsentOnes) {
  const ordered_json written = json_of(sample());
  EXPECT_EQ(written.begin().key(), "isoshade_reflection");
  EXPECT_EQ(written["isoshade_reflection"], 1);
  EXPECT_FALSE(written.contains("doc"));
  EXPECT_FALSE(written.contains("proofs"));
  EXPECT_EQ(written["files"][0],
            ordered_json({{"path", "effects/fur.json"}, {"role", "document"}, {"sha256", "00"}}));
  EXPECT_FALSE(written["files"][1].contains("sha256"));
  EXPECT_EQ(written["functions"], ordered_json::array()) << "a list is written, even if it is empty";
  EXPECT_EQ(written["parameters"][0]["min"], 0.5);
  const ordered_json schema = ordered_json::parse(isoshade::reflect::schema());
  for (const ordered_json& key : schema["definitions"]["reflection"]["required"])
    EXPECT_TRUE(written.contains(key.get<std::string>())) << key;
}

TEST(ReflectionFormat, WritesDefaultsAsValuesOfTheirType) {
  graph::Literal literal;
  literal.number = 0.1f;
  EXPECT_EQ(default_of(graph::Type::floating, literal).dump(), "0.1")
      << "the shortest number for the same float";
  literal.number = 3;
  EXPECT_EQ(default_of(graph::Type::integer, literal).dump(), "3");
  EXPECT_EQ(default_of(graph::Type::floating, literal).dump(), "3.0");
  literal.kind = graph::Literal::Kind::boolean;
  EXPECT_EQ(default_of(graph::Type::boolean, literal).dump(), "false");
  literal.kind = graph::Literal::Kind::numbers;
  literal.numbers = {1, 0.2f};
  EXPECT_EQ(default_of(graph::Type::vector2, literal).dump(), "[1.0,0.2]");
  literal.kind = graph::Literal::Kind::string;
  literal.string = "a\"</script>.png";
  EXPECT_EQ(default_of(graph::Type::filename, literal), literal.string);
}

TEST(ReflectionFormat, WritesEveryStateOfAPass) {
  const ordered_json states = json_of(sample())["passes"][0]["states"];
  EXPECT_EQ(states.size(), interface::pass_states().size());
  for (const interface::PassStateRow& row : interface::pass_states())
    EXPECT_EQ(states[std::string(row.key)], row.values[row.fallback]);
}

TEST(ReflectionFormat, SchemaAllowsNoUndeclaredKey) {
  const ordered_json schema = ordered_json::parse(isoshade::reflect::schema());
  size_t objects = 0;
  const std::function<void(const ordered_json&)> walk = [&](const ordered_json& part) {
    if (part.is_object() && part.contains("properties") && part["type"] == "object") {
      ++objects;
      EXPECT_EQ(part["additionalProperties"], false) << part.dump();
    }
    if (part.is_structured())
      for (const ordered_json& child : part) walk(child);
  };
  walk(schema);
  EXPECT_GT(objects, schema["definitions"].size());
}

TEST(ReflectionFormat, DocumentsEveryKeyOnce) {
  const ordered_json schema = ordered_json::parse(isoshade::reflect::schema());
  const std::string manual = markdown();
  for (const auto& [record, definition] : schema["definitions"].items()) {
    EXPECT_FALSE(definition["description"].get<std::string>().empty()) << record;
    for (const auto& [key, value] : definition["properties"].items()) {
      EXPECT_FALSE(value["description"].get<std::string>().empty()) << record << "." << key;
      EXPECT_NE(manual.find("| `" + key + "` | "), std::string::npos) << record << "." << key;
    }
  }
}

}  // namespace
}  // namespace isoshade::reflect
