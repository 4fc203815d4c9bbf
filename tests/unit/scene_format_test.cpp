// SPDX-License-Identifier: Apache-2.0
// The table of the scene format against the parser: what one of them knows and the other does not fails here.
#include <gtest/gtest.h>

#include "runtime/scene/format.h"
#include "scene_documents.h"

namespace isoshade {
namespace {

namespace format = scene::format;
using format::KeyRow;
using format::Object;
using format::ObjectRow;

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

std::string numbers(size_t count, const std::string& each) {
  std::string text;
  for (size_t i = 0; i < count; ++i) text += (i == 0 ? "[" : ", ") + each;
  return text + "]";
}

/// The JSON of an object of this form, with all that it requires and the member `extra` ("key": value).
std::string object_json(Object object, size_t form, const std::string& key, const std::string& extra);

/// Some value of the type of a key; numbers in their ranges.
struct Sample {
  std::string operator()(const format::Boolean&) const { return "true"; }
  std::string operator()(const format::Integer& type) const { return number(type.range.low); }
  std::string operator()(const format::Number& type) const { return number(type.range.high); }
  template <size_t N>
  std::string operator()(const format::Numbers<N>& type) const {
    return numbers(N, number(type.range.high));
  }
  std::string operator()(const format::Size& type) const { return numbers(2, number(type.range.low)); }
  std::string operator()(const format::Samples& type) const { return number(type.values[0]); }
  std::string operator()(const format::Scale&) const { return "2"; }
  std::string operator()(const format::Rotation&) const { return "[0, 90, 0]"; }
  std::string operator()(const format::Choice& type) const {
    return "\"" + std::string(type.words[0]) + "\"";
  }
  std::string operator()(const format::Name&) const { return "\"scene\""; }
  std::string operator()(const format::Path&) const { return "\"a.json\""; }
  std::string operator()(const format::Literal&) const { return "1"; }
  std::string operator()(const format::Literals&) const { return "[1]"; }
  std::string operator()(const format::MapOfLiterals&) const { return "{}"; }
  std::string operator()(const format::MapOfNames&) const { return "{}"; }
  std::string operator()(const format::Keyframes&) const { return "[[0, 1]]"; }
  std::string operator()(const format::MapOfPaths&) const { return "{}"; }
  std::string operator()(const format::ObjectOf& type) const { return object_json(type.object, 0, "", ""); }
  std::string operator()(const format::MapOf&) const { return "{}"; }
  std::string operator()(const format::ListOf& type) const {
    return numbers(type.least, object_json(type.object, 0, "", ""));
  }
};

std::string sample(const KeyRow& key) { return std::visit(Sample{}, key.type); }

std::string object_json(Object object, size_t form, const std::string& key, const std::string& extra) {
  const ObjectRow& row = format::row_of(object);
  std::string text;
  const auto add = [&](const std::string& name, const std::string& value) {
    text += (text.empty() ? "{" : ", ") + ("\"" + name + "\": " + value);
  };
  if (object == Object::scene) add("isoshade", "1");
  for (const KeyRow* other : format::keys_of(object, format::of(form))) {
    if (other->name == key) continue;
    if (other->name == "type" && !row.forms.empty())
      add("type", "\"" + std::string(row.forms[form]) + "\"");
    else if (other->required)
      add(std::string(other->name), sample(*other));
  }
  if (!key.empty()) add(key, extra);
  return text.empty() ? "{}" : text + "}";
}

/// A scene that has this object.
std::string scene_with(Object object, const std::string& json) {
  if (object == Object::scene) return json;
  for (const ObjectRow& outer : format::objects()) {
    for (size_t form = 0; form < std::max<size_t>(1, outer.forms.size()); ++form) {
      for (const KeyRow* key : format::keys_of(outer.object, format::of(form))) {
        const auto* one = std::get_if<format::ObjectOf>(&key->type);
        const auto* map = std::get_if<format::MapOf>(&key->type);
        const auto* paths = std::get_if<format::MapOfPaths>(&key->type);
        const auto* list = std::get_if<format::ListOf>(&key->type);
        std::string value;
        if (one != nullptr && one->object == object) value = json;
        if (map != nullptr && map->object == object) value = "{\"a\": " + json + "}";
        if (paths != nullptr && paths->object == object) value = "{\"camera.near\": " + json + "}";
        if (list != nullptr && list->object == object)
          value = numbers(std::max<size_t>(1, list->least), json);
        if (!value.empty())
          return scene_with(outer.object, object_json(outer.object, form, std::string(key->name), value));
      }
    }
  }
  ADD_FAILURE() << "nothing has a " << format::row_of(object).name;
  return {};
}

/// The reports for an object in which a key has this value.
testing::ParsedScene parsed(Object object, size_t form, const std::string& key, const std::string& value) {
  return testing::parse_text(scene_with(object, object_json(object, form, key, value)));
}

bool reports(const testing::ParsedScene& parsed, support::Id id, const std::string& key) {
  for (const support::Diagnostic& report : parsed.diagnostics.all())
    if (report.id == id && report.message.find("\"" + key) != std::string::npos) return true;
  return false;
}

/// Calls a function with each key of each form of each object.
template <class Function>
void for_each_key(const Function& function) {
  for (const ObjectRow& object : format::objects()) {
    for (size_t form = 0; form < std::max<size_t>(1, object.forms.size()); ++form) {
      for (const KeyRow* key : format::keys_of(object.object, format::of(form))) {
        SCOPED_TRACE(std::string(object.name) + "." + std::string(key->name) + " of form " +
                     std::to_string(form));
        function(object.object, form, *key);
      }
    }
  }
}

TEST(SceneFormat, EveryKeyOfTheTableIsReadByTheParser) {
  for_each_key([](Object object, size_t form, const KeyRow& key) {
    const auto known = parsed(object, form, std::string(key.name), sample(key));
    EXPECT_FALSE(reports(known, support::Id::unknown_key, std::string(key.name))) << known.diagnostics.text();
    EXPECT_FALSE(reports(known, support::Id::wrong_type, std::string(key.name))) << known.diagnostics.text();
  });
}

TEST(SceneFormat, EveryObjectRejectsKeysOutsideTheTable) {
  for (const ObjectRow& object : format::objects()) {
    for (size_t form = 0; form < std::max<size_t>(1, object.forms.size()); ++form) {
      EXPECT_TRUE(reports(parsed(object.object, form, "stranger", "1"), support::Id::unknown_key, "stranger"))
          << object.name << " of form " << form;
    }
  }
}

TEST(SceneFormat, KeysOfOtherFormsAreRejected) {
  for_each_key([](Object object, size_t form, const KeyRow& key) {
    const size_t forms = format::row_of(object).forms.size();
    for (size_t other = 0; other < forms; ++other) {
      if (other == form || object == Object::variation) continue;
      bool has_it = false;
      for (const KeyRow* row : format::keys_of(object, format::of(other))) has_it |= row->name == key.name;
      if (has_it) continue;
      EXPECT_TRUE(reports(parsed(object, other, std::string(key.name), sample(key)), support::Id::unknown_key,
                          std::string(key.name)))
          << "form " << other;
    }
  });
}

TEST(SceneFormat, EveryRequiredKeyIsRequiredByTheParser) {
  for (const ObjectRow& object : format::objects()) {
    for (size_t form = 0; form < std::max<size_t>(1, object.forms.size()); ++form) {
      for (const KeyRow* key : format::keys_of(object.object, format::of(form))) {
        // These tell the form.
        if (object.object == Object::variation && key->name == "values") continue;
        if (object.object == Object::environment && key->name == "sky") continue;
        if (object.object == Object::scene && key->name == "scene") continue;  // tells the kind of document
        std::string without = object_json(object.object, form, std::string(key->name), "0");
        const size_t at = without.find("\"" + std::string(key->name) + "\": 0");
        without.replace(at, key->name.size() + 2, "\"extras\"");
        const auto result = testing::parse_text(scene_with(object.object, without));
        EXPECT_EQ(reports(result, support::Id::missing_key, std::string(key->name)), key->required)
            << object.name << "." << key->name << "\n"
            << result.diagnostics.text();
      }
    }
  }
}

TEST(SceneFormat, NoKeyTakesNull) {
  for_each_key([](Object object, size_t form, const KeyRow& key) {
    if (object == Object::scene && key.name == "extends") return;  // read when the scene is loaded
    EXPECT_FALSE(parsed(object, form, std::string(key.name), "null").diagnostics.all().empty());
  });
}

/// The ranges of the numbers of a type.
struct RangeOf {
  template <class T>
  std::optional<graph::Range> operator()(const T& type) const {
    if constexpr (requires { type.range; }) return type.range;
    return std::nullopt;
  }
};
struct WithNumber {
  std::string value;
  template <class T>
  std::string operator()(const T&) const {
    return value;
  }
  template <size_t N>
  std::string operator()(const format::Numbers<N>&) const {
    return numbers(N, value);
  }
  std::string operator()(const format::Size&) const { return numbers(2, value); }
  std::string operator()(const format::Rotation&) const { return numbers(3, value); }
};

TEST(SceneFormat, TheParserEnforcesTheRangesOfTheTable) {
  for_each_key([](Object object, size_t form, const KeyRow& key) {
    const auto range = std::visit(RangeOf{}, key.type);
    if (!range) return;
    const std::string name(key.name);
    const bool whole =
        std::holds_alternative<format::Integer>(key.type) || std::holds_alternative<format::Size>(key.type);
    const auto is_rejected = [&](double value) {
      const auto result = parsed(object, form, name, std::visit(WithNumber{number(value)}, key.type));
      for (const support::Diagnostic& report : result.diagnostics.all())
        if (report.id == support::Id::out_of_range && report.message.find("\"" + name) != std::string::npos &&
            report.message.find("must be ") != std::string::npos &&
            report.message.find("must be greater") == std::string::npos)
          return true;
      return false;
    };
    EXPECT_FALSE(is_rejected(range->low));
    EXPECT_FALSE(is_rejected(range->high));
    EXPECT_TRUE(is_rejected(whole ? range->low - 1 : range->low - std::abs(range->low) * 0.001 - 1e-9));
    EXPECT_TRUE(is_rejected(whole ? range->high + 1 : range->high * 1.001));
  });
}

TEST(SceneFormat, DefaultsAreThoseOfTheStructures) {
  const auto minimal = testing::parse_text(R"({"isoshade": 1, "scene": "s",
    "camera": {"position": [0, 0, 1], "target": [0, 0, 0]},
    "lights": {"spot": {"type": "spot", "position": [0, 0, 0], "direction": [0, 0, 1]}},
    "objects": {"o": {"mesh": "sphere", "effect": "e.json", "transform": {}}},
    "posts": [{"name": "p", "effect": "p.json"}], "output": {}})");
  ASSERT_TRUE(minimal.scene) << minimal.diagnostics.text();
  const scene::Scene& scene = *minimal.scene;
  const scene::Scene none;
  EXPECT_EQ(scene.width, none.width);
  EXPECT_EQ(scene.height, none.height);
  EXPECT_EQ(scene.samples, none.samples);
  EXPECT_EQ(scene.time, none.time);
  EXPECT_EQ(scene.background, none.background);
  EXPECT_EQ(scene.camera.projection, none.camera.projection);
  EXPECT_EQ(scene.camera.up, none.camera.up);
  EXPECT_EQ(scene.camera.near, none.camera.near);
  EXPECT_EQ(scene.camera.fov, none.camera.fov);
  EXPECT_EQ(scene.output.encoding, none.output.encoding);
  EXPECT_EQ(scene.output.exposure, none.output.exposure);
  const scene::Light light;
  EXPECT_EQ(scene.lights[0].color, light.color);
  EXPECT_EQ(scene.lights[0].intensity, light.intensity);
  EXPECT_EQ(scene.lights[0].range, light.range);
  EXPECT_EQ(scene.lights[0].inner_angle, light.inner_angle);
  EXPECT_EQ(scene.lights[0].outer_angle, light.outer_angle);
  const scene::Transform transform;
  EXPECT_EQ(scene.objects[0].transform.translate, transform.translate);
  EXPECT_EQ(scene.objects[0].transform.rotate, transform.rotate);
  EXPECT_EQ(scene.objects[0].transform.scale, transform.scale);
  EXPECT_EQ(scene.objects[0].mesh, scene::MeshShape{});
  EXPECT_EQ(scene.posts[0].size, scene::Post{}.size);
}

}  // namespace
}  // namespace isoshade
