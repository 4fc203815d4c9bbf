// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "runtime/lanes/float_rules.h"
#include "tests/unit/scene_documents.h"

namespace isoshade {
namespace {

using scene::Instance;
using scene::Object;
using testing::parse_members;
using testing::parse_text;
using testing::ParsedScene;

constexpr const char* ball = R"("objects": {"ball": {"mesh": "sphere", "effect": "e.json"}})";

TEST(ParseScene, ReadsEveryPart) {
  const ParsedScene parsed = parse_text(R"({
    "$schema": "../schema/isoshade.schema.json", "isoshade": 1, "scene": "all", "doc": "All there is.",
    "size": [320, 200], "time": 1.5, "background": [0.1, 0.2, 0.3, 0.5], "posts": [], "extras": {"free": [1]},
    "camera": {"type": "orthographic", "position": [1, 2, 3], "target": [4, 5, 6], "up": [0, 0, 1],
               "height": 7, "near": 0.5, "far": 50},
    "lights": {
      "sun": {"type": "directional", "direction": [1, -1, 0], "color": [1, 0.5, 0.25], "intensity": 3},
      "lamp": {"type": "point", "position": [1, 2, 3], "range": 9},
      "torch": {"type": "spot", "position": [0, 1, 0], "direction": [0, -1, 0],
                "inner_angle": 10, "outer_angle": 20}},
    "objects": {
      "floor": {"mesh": {"type": "plane", "size": [8, 6], "segments": 4}, "effect": "../materials/m.json",
                "transform": {"translate": [0, -1, 0], "rotate": [90, 0, 45], "scale": 2},
                "parameters": {"roughness": 0.25, "base_color": [1, 0, 0], "flat": true, "map": "a.png"}},
      "crate": {"mesh": {"type": "box", "size": [1, 2, 3]}, "effect": "/abs/m.json",
                "transform": {"rotate": [0, 0, 0, 1], "scale": [1, -2, 3]}}},
    "output": {"encoding": "linear", "exposure": 2}})");
  ASSERT_TRUE(parsed.scene) << parsed.diagnostics.text();
  const scene::Scene& scene = *parsed.scene;
  EXPECT_EQ(scene.name, "all");
  EXPECT_EQ(scene.width, 320);
  EXPECT_EQ(scene.height, 200);
  EXPECT_EQ(scene.time, 1.5f);
  EXPECT_EQ(scene.background[3], 0.5f);
  EXPECT_EQ(scene.camera.projection, scene::Projection::orthographic);
  EXPECT_EQ(scene.camera.up, glm::vec3(0, 0, 1));
  EXPECT_EQ(scene.camera.far, 50.0f);
  ASSERT_EQ(scene.lights.size(), 3u);
  EXPECT_EQ(scene.lights[0].name, "sun");
  EXPECT_EQ(scene.lights[1].range, 9.0f);
  EXPECT_EQ(scene.lights[2].kind, scene::LightKind::spot);
  EXPECT_EQ(scene.lights[2].outer_angle, 20.0f);
  ASSERT_EQ(scene.objects.size(), 2u);
  const Object& floor = scene.objects[0];
  EXPECT_EQ(floor.effect, "materials/m.json");  // beside scenes/test.json
  EXPECT_EQ(floor.mesh.kind, scene::MeshKind::plane);
  EXPECT_EQ(floor.mesh.segments, 4);
  EXPECT_EQ(floor.transform.scale, glm::vec3(2));
  EXPECT_EQ(floor.transform.rotate, glm::vec3(90, 0, 45));
  ASSERT_EQ(floor.parameters.size(), 4u);
  EXPECT_EQ(floor.parameters[1].value.numbers, (std::vector<float>{1, 0, 0}));
  EXPECT_TRUE(floor.parameters[2].value.boolean);
  EXPECT_EQ(scene.objects[1].effect, "/abs/m.json");
  EXPECT_TRUE(scene.objects[1].transform.rotation);
  EXPECT_EQ(scene.output.encoding, scene::Encoding::linear);
}

TEST(ParseScene, RequiresOnlyACamera) {
  const ParsedScene parsed = parse_members("");
  ASSERT_TRUE(parsed.scene) << parsed.diagnostics.text();
  EXPECT_EQ(parsed.scene->background, (std::array<float, 4>{0, 0, 0, 1}));
  EXPECT_TRUE(parse_text(R"({"isoshade": 1, "scene": "s"})").fails_with("missing-key"));
}

TEST(ParseScene, RejectsOtherKindsOfDocument) {
  EXPECT_TRUE(parse_text(R"({"isoshade": 1, "effect": "e"})").fails_with("wrong-kind"));
  EXPECT_TRUE(parse_text(R"([1])").fails_with("wrong-type"));
}

TEST(ParseScene, FirstGridAxisVariesFastest) {
  const ParsedScene parsed = parse_members(R"("objects": {"balls": {"mesh": "sphere", "effect": "e.json",
    "transform": {"translate": [10, 0, 0]},
    "repeat": [{"count": 3, "step": [2, 0, 0], "parameters": {"roughness": {"from": 0.1, "to": 0.7}}},
               {"count": 2, "step": [0, -4, 0], "parameters": {
                 "tint": {"values": [[1, 0, 0], [0, 1, 0]]}}}]}})");
  ASSERT_TRUE(parsed.scene) << parsed.diagnostics.text();
  const Object& balls = parsed.scene->objects[0];
  ASSERT_EQ(scene::instance_count(balls), 6);
  const lanes::FpGuard guard;
  const Instance last = scene::instance(balls, 5);
  EXPECT_EQ(scene::instance_name(balls, last), "balls[2,1]");
  EXPECT_EQ(scene::instance_name(balls, scene::instance(balls, 1)), "balls[1,0]");
  EXPECT_EQ(scene::instance_translation(balls, last), glm::vec3(14, -4, 0));
  const scene::Variation& roughness = balls.repeat[0].variations[0];
  EXPECT_EQ(scene::variation_value(roughness, 0, 3).number, 0.1f);  // the ends exactly
  EXPECT_EQ(scene::variation_value(roughness, 1, 3).number, 0.4f);
  EXPECT_EQ(scene::variation_value(roughness, 2, 3).number, 0.7f);
  EXPECT_EQ(scene::variation_value(roughness, 0, 1).number, 0.1f);
  EXPECT_EQ(scene::variation_value(balls.repeat[1].variations[0], 1, 2).numbers,
            (std::vector<float>{0, 1, 0}));
}

TEST(ParseScene, SuggestsTheNearestKey) {
  const ParsedScene parsed = parse_members(R"("objects": {"ball": {"mesh": "sphere", "efect": "e.json"}})");
  EXPECT_FALSE(parsed.scene);
  EXPECT_NE(parsed.diagnostics.text().find("\"effect\""), std::string::npos) << parsed.diagnostics.text();
  EXPECT_TRUE(parse_members(R"("objects": {"b": {"mesh": "shpere", "effect": "e"}})").fails_with("shpere"));
}

TEST(ParseScene, ReadsEveryMeshType) {
  const auto mesh_of = [](const std::string& mesh) {
    const ParsedScene parsed = parse_members(R"("objects": {"b": {"mesh": )" + mesh + R"(, "effect": "e"}})");
    EXPECT_TRUE(parsed.scene) << mesh;
    return parsed.scene ? parsed.scene->objects[0].mesh : scene::MeshShape{};
  };
  using scene::MeshKind;
  for (const char* name : {"sphere", "plane", "box", "icosphere", "cylinder", "cone", "torus"}) {
    const std::string word = std::string("\"") + name + "\"";
    EXPECT_EQ(mesh_of(word), mesh_of(R"({"type": )" + word + "}")) << name;
  }
  EXPECT_EQ(mesh_of(R"({"type": "icosphere", "radius": 2, "subdivisions": 3})"),
            (scene::MeshShape{MeshKind::icosphere, {2, 2, 2}, 1, 3}));
  EXPECT_EQ(
      mesh_of(R"({"type": "cylinder", "radius": 2, "height": 3, "segments": 5, "rings": 4, "caps": false})"),
      (scene::MeshShape{MeshKind::cylinder, {2, 3, 1}, 5, 4, false}));
  EXPECT_EQ(mesh_of(R"({"type": "cone", "height": 3})"),
            (scene::MeshShape{MeshKind::cone, {1, 3, 1}, 64, 1}));
  EXPECT_EQ(mesh_of(R"({"type": "torus", "tube": 0.5, "rings": 7})"),
            (scene::MeshShape{MeshKind::torus, {1, 0.5f, 1}, 64, 7}));
  EXPECT_EQ(mesh_of(R"({"type": "gltf", "file": "/a/x.glb", "fit": true})").file, "/a/x.glb");
  EXPECT_EQ(mesh_of(R"({"type": "lathe", "smooth": false, "segments": 9,
                        "profile": [[0, -1], {"at": [1, 0], "smooth": true}, [0.5, 1]]})")
                .profile,
            (std::vector<scene::ProfilePoint>{{0, -1, false}, {1, 0, true}, {0.5f, 1, false}}));
}

TEST(ParseScene, RejectsDegenerateMeshes) {
  const auto fails_with = [](const std::string& mesh, const char* text) {
    return parse_members(R"("objects": {"b": {"mesh": )" + mesh + R"(, "effect": "e"}})").fails_with(text);
  };
  const auto profile_fails_with = [&](const std::string& points, const char* text) {
    return fails_with(R"({"type": "lathe", "profile": [)" + points + "]}", text);
  };
  EXPECT_TRUE(fails_with(R"("lathe")", "needs a profile"));
  EXPECT_TRUE(fails_with(R"("gltf")", "is a file"));
  EXPECT_TRUE(fails_with(R"({"type": "lathe"})", "missing-key"));
  EXPECT_TRUE(fails_with(R"({"type": "torus", "tube": 1})", "out-of-range"));
  EXPECT_TRUE(fails_with(R"({"type": "icosphere", "subdivisions": 9})", "out-of-range"));
  EXPECT_TRUE(fails_with(R"({"type": "cone", "radius": 0})", "out-of-range"));
  EXPECT_TRUE(profile_fails_with("[1, 0]", "2 to 256 points"));
  EXPECT_TRUE(profile_fails_with("[0, 0], [0, 1]", "along the axis"));
  EXPECT_TRUE(profile_fails_with("[1, 0], [1, 0], [2, 0]", "coincide"));
  EXPECT_TRUE(profile_fails_with("[1, 0], [0, 1], [1, 2]", "only at its ends"));
  EXPECT_TRUE(profile_fails_with("[-1, 0], [1, 1]", "out-of-range"));
  EXPECT_TRUE(profile_fails_with("[1e-9, 0], [1, 1]", "out-of-range"));
  EXPECT_TRUE(profile_fails_with("[1, 0, 2], [1, 1]", "a point of a profile"));
  EXPECT_TRUE(profile_fails_with("[1, 0], \"x\"", "a point of a profile"));
  EXPECT_TRUE(profile_fails_with("[1, 0], {\"smooth\": true}", "missing-key"));
}

TEST(ParseScene, ReportsSeveralErrorsWithPositions) {
  const ParsedScene parsed =
      parse_members("\"size\": [0, 1],\n\"background\": [1],\n\"lights\": {\"1x\": {}}");
  EXPECT_FALSE(parsed.scene);
  EXPECT_GE(parsed.diagnostics.error_count(), 4u);
  for (const support::Diagnostic& diagnostic : parsed.diagnostics.all())
    EXPECT_GT(diagnostic.where.line(), 0u) << diagnostic.message;
}

TEST(ParseScene, RejectsPostsWithoutNames) {
  EXPECT_TRUE(parse_members(R"("posts": [{"name": "", "effect": "p.json"}])").fails_with("bad-id"));
  EXPECT_TRUE(parse_members(R"("posts": [{"effect": "p.json"}])").fails_with("missing-key"));
}

TEST(ParseScene, RejectsDegenerateCameras) {
  const auto camera = [](const std::string& members) {
    return parse_members("\"camera\": {" + members + "}");
  };
  EXPECT_TRUE(camera(R"("position": [1, 2, 3], "target": [1, 2, 3])").fails_with("degenerate"));
  EXPECT_TRUE(camera(R"("position": [0, 5, 0], "target": [0, 0, 0])").fails_with("degenerate"));
  EXPECT_TRUE(
      camera(R"("position": [0, 0, 5], "target": [0, 0, 0], "up": [0, 0, 0])").fails_with("degenerate"));
  EXPECT_TRUE(
      camera(R"("position": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1e-9, -1])").fails_with("degenerate"));
  EXPECT_TRUE(camera(R"("position": [0, 0, 1e9], "target": [0, 0, 0], "up": [0, 1e-30, 0])").scene);
  EXPECT_TRUE(camera(R"("position": [0, 0, 5], "target": [0, 0, 0], "fov": 180)").fails_with("out-of-range"));
  EXPECT_TRUE(camera(R"("position": [0, 0, 5], "target": [0, 0, 0], "near": 0)").fails_with("out-of-range"));
  EXPECT_TRUE(camera(R"("type": "orthographic", "position": [0, 0, 5], "target": [0, 0, 0], "height": 1,
                        "near": 5, "far": 5)")
                  .fails_with("\"far\""));
}

TEST(ParseScene, RefusesScalesAndDirectionsOfZero) {
  const auto transform = [](const std::string& members) {
    return parse_members(R"("objects": {"b": {"mesh": "box", "effect": "e", "transform": {)" + members +
                         "}}}");
  };
  EXPECT_TRUE(transform(R"("scale": 0)").fails_with("degenerate"));
  EXPECT_TRUE(transform(R"("scale": [1, 0, 1])").fails_with("degenerate"));
  EXPECT_TRUE(transform(R"("scale": [1, 1e-44, 1])").fails_with("degenerate"));
  EXPECT_EQ(transform(R"("scale": 2e6)").diagnostics.error_count(), 1u);
  EXPECT_TRUE(transform(R"("rotate": [0, 0, 0, 0])").fails_with("quaternion"));
  EXPECT_TRUE(transform(R"("rotate": [1e9, 0, 0])").fails_with("out-of-range"));
  EXPECT_TRUE(parse_members(R"("lights": {"l": {"type": "directional", "direction": [0, 0, 0]}})")
                  .fails_with("degenerate"));
  const auto tiny = parse_members(R"("lights": {"l": {"type": "directional", "direction": [1e-300, 0, 0]}})");
  EXPECT_TRUE(tiny.fails_with("\"direction\" of light \"l\" is zero, or too short to have a direction"));
  const support::Span where = tiny.diagnostics.all().at(0).where;
  EXPECT_EQ(where.file->text().substr(where.begin, where.end - where.begin), "[1e-300, 0, 0]");
  EXPECT_TRUE(parse_members(R"("lights": {"l": {"type": "spot", "direction": [0, 0, 1], "position": [0, 0, 0],
                                                "inner_angle": 30, "outer_angle": 30}})")
                  .fails_with("outer_angle"));
}

TEST(ParseScene, RejectsNumbersOutOfRange) {
  EXPECT_TRUE(parse_members(R"("size": [8193, 1])").fails_with("out-of-range"));
  EXPECT_TRUE(parse_members(R"("size": [99999999999999999999, 1])").fails_with("wrong-type"));
  EXPECT_TRUE(parse_members(R"("size": [1.5, 1])").fails_with("wrong-type"));
  EXPECT_TRUE(parse_members(R"("background": [1e39, 0, 0, 1])").fails_with("out-of-range"));
  EXPECT_TRUE(parse_members(R"("background": [null, 0, 0, 1])").fails_with("wrong-type"));
  EXPECT_TRUE(parse_members(R"("objects": {"b": {"mesh": {"type": "sphere", "segments": 2000000000},
                                                 "effect": "e"}})")
                  .fails_with("out-of-range"));
  EXPECT_TRUE(parse_members(R"("objects": {"b": {"mesh": "box", "effect": "e", "parameters": {"p": 1e300}}})")
                  .fails_with("out-of-range"));
}

TEST(ParseScene, AcceptsOneFourOrSixteenSamples) {
  EXPECT_EQ(parse_members("").scene->samples, 1);
  for (const int samples : {1, 4, 16}) {
    const ParsedScene parsed = parse_members("\"samples\": " + std::to_string(samples));
    ASSERT_TRUE(parsed.scene) << parsed.diagnostics.text();
    EXPECT_EQ(parsed.scene->samples, samples);
  }
  for (const char* samples : {"0", "2", "9", "64", "-4"}) {
    const ParsedScene parsed = parse_members("\"samples\": " + std::string(samples));
    EXPECT_TRUE(parsed.fails_with("out-of-range: a pixel has 1, 4 or 16 samples")) << samples;
    EXPECT_EQ(parsed.diagnostics.error_count(), 1u);
  }
  EXPECT_TRUE(parse_members("\"samples\": 4.5").fails_with("wrong-type"));
  EXPECT_TRUE(parse_members("\"samples\": \"4\"").fails_with("wrong-type"));
}

TEST(ParseScene, LimitsTheNumberOfCopies) {
  const auto grid = [](const std::string& count) {
    const std::string axis = R"({"count": )" + count + R"(, "step": [1, 0, 0]})";
    return parse_members(R"("objects": {"b": {"mesh": "box", "effect": "e", "repeat": [)" + axis + "," +
                         axis + "," + axis + "]}}");
  };
  EXPECT_TRUE(grid("1000000000").fails_with("out-of-range"));
  EXPECT_TRUE(grid("65536").fails_with("too-large"));
  EXPECT_TRUE(grid("40").scene);
  EXPECT_TRUE(grid("0").fails_with("out-of-range"));
  EXPECT_TRUE(grid("-1").fails_with("out-of-range"));
}

TEST(ParseScene, LimitsTheNumberOfLights) {
  std::string lights;
  for (size_t i = 0; i <= scene::max_lights; ++i) {
    lights += (i == 0 ? "" : ",") + ("\"l" + std::to_string(i)) +
              R"(": {"type": "directional", "direction": [0, -1, 0]})";
  }
  EXPECT_TRUE(parse_members("\"lights\": {" + lights + "}").fails_with("too-large"));
}

TEST(ParseScene, RefusesAParameterThatIsSetTwice) {
  const ParsedScene parsed = parse_members(R"("objects": {"b": {"mesh": "box", "effect": "e",
    "parameters": {"roughness": 0.5},
    "repeat": [{"count": 2, "step": [1, 0, 0], "parameters": {"roughness": {"from": 0, "to": 1}}}]}})");
  EXPECT_TRUE(parsed.fails_with("duplicate-name")) << parsed.first_error();
}

TEST(ParseScene, RejectsInvalidVariations) {
  const auto varied = [](const std::string& variation) {
    return parse_members(R"("objects": {"b": {"mesh": "box", "effect": "e",
      "repeat": [{"count": 3, "step": [1, 0, 0], "parameters": {"p": )" +
                         variation + "}}]}}");
  };
  EXPECT_TRUE(varied(R"({"values": [1, 2]})").fails_with("3 places"));
  EXPECT_TRUE(varied(R"({"from": 1})").fails_with("missing-key"));
  EXPECT_TRUE(varied(R"({"from": 1, "to": [1, 2]})").fails_with("differ in size"));
  EXPECT_TRUE(varied(R"({"from": true, "to": false})").fails_with("wrong-type"));
  EXPECT_TRUE(varied(R"([0, 1])").fails_with("wrong-type"));
  EXPECT_TRUE(varied(R"({"values": [true, false, true]})").scene);
}

TEST(ParseScene, VariationsStayBetweenTheirEnds) {
  const auto number = [](float value) {
    graph::Literal literal;
    literal.number = value;
    return literal;
  };
  const std::pair<float, float> ends[] = {{0.1f, 0.9f}, {0.9f, 0.9f}, {0.7f, -0.3f}, {0.3f, 0.30000004f}};
  for (const auto& [from, to] : ends) {
    scene::Variation variation;
    variation.values = {number(from), number(to)};
    for (int64_t count = 2; count < 200; ++count) {
      for (int64_t place = 0; place < count; ++place) {
        const float value = scene::variation_value(variation, place, count).number;
        ASSERT_GE(value, std::min(from, to)) << place << " of " << count;
        ASSERT_LE(value, std::max(from, to)) << place << " of " << count;
      }
    }
  }
}

TEST(ParseScene, RefusesDuplicateNames) {
  EXPECT_TRUE(parse_members(std::string(ball) +
                            R"(, "lights": {"ball": {"type": "directional", "direction": [0, -1, 0]}})")
                  .fails_with("duplicate-name"));
  EXPECT_TRUE(parse_members(R"("objects": {"output": {"mesh": "box", "effect": "e"}})").fails_with("bad-id"));
  EXPECT_TRUE(parse_members(R"("objects": {"a b": {"mesh": "box", "effect": "e"}})").fails_with("bad-id"));
}

TEST(ParseScene, ReadsPostsInOrder) {
  const auto parsed = parse_members(R"("posts": [
    {"name": "small", "effect": "blur.json", "size": 0.5, "parameters": {"radius": 3}},
    {"name": "glow", "effect": "../fx/glow.json", "inputs": {"color": "scene", "blurred": "small"}}])");
  ASSERT_TRUE(parsed.scene) << parsed.diagnostics.text();
  const std::vector<scene::Post>& posts = parsed.scene->posts;
  ASSERT_EQ(posts.size(), 2u);
  EXPECT_EQ(posts[0].name, "small");
  EXPECT_EQ(posts[0].effect, "scenes/blur.json");
  EXPECT_EQ(posts[0].size, 0.5f);
  ASSERT_EQ(posts[0].parameters.size(), 1u);
  EXPECT_EQ(posts[0].parameters[0].value.number, 3.0f);
  EXPECT_EQ(posts[1].effect, "fx/glow.json");
  EXPECT_EQ(posts[1].size, 1.0f);
  ASSERT_EQ(posts[1].inputs.size(), 2u);
  EXPECT_EQ(posts[1].inputs[0].image, "color");
  EXPECT_EQ(posts[1].inputs[0].source, scene::scene_image);
  EXPECT_EQ(posts[1].inputs[1].image, "blurred");
  EXPECT_EQ(posts[1].inputs[1].source, 0);
}

TEST(ParseScene, PostsReadOnlyImagesOfEarlierPosts) {
  const auto reading = [](const std::string& image) {
    return parse_members(R"("posts": [{"name": "first", "effect": "e", "inputs": {"color": ")" + image +
                         R"("}}, {"name": "second", "effect": "e"}])");
  };
  EXPECT_TRUE(reading("scene").scene);
  EXPECT_TRUE(reading("second").fails_with("unknown-image"));
  EXPECT_TRUE(reading("first").fails_with("unknown-image"));
  EXPECT_TRUE(reading("frist").fails_with("unknown-image"));
  EXPECT_TRUE(parse_members(R"("posts": [{"name": "a", "effect": "e", "inputs": {"color": 1}}])")
                  .fails_with("wrong-type"));
}

TEST(ParseScene, RejectsPostsWithDuplicateNamesOrBadSizes) {
  const auto posts = [](const std::string& list) { return parse_members("\"posts\": [" + list + "]"); };
  EXPECT_TRUE(
      posts(R"({"name": "a", "effect": "e"}, {"name": "a", "effect": "e"})").fails_with("duplicate-name"));
  EXPECT_TRUE(posts(R"({"name": "scene", "effect": "e"})").fails_with("bad-id"));
  EXPECT_TRUE(posts(R"({"name": "output", "effect": "e"})").fails_with("bad-id"));
  EXPECT_TRUE(posts(R"({"effect": "e"})").fails_with("missing-key"));
  EXPECT_TRUE(posts(R"({"name": "a", "effect": "e", "size": 0})").fails_with("out-of-range"));
  EXPECT_TRUE(posts(R"({"name": "a", "effect": "e", "size": 1.5})").fails_with("out-of-range"));
  EXPECT_TRUE(posts(R"("fog.json")").fails_with("wrong-type"));
  EXPECT_TRUE(parse_members(R"("lights": {"fog": {"type": "directional", "direction": [0, -1, 0]}},
    "posts": [{"name": "fog", "effect": "e"}])")
                  .fails_with("duplicate-name"));
}

}  // namespace
}  // namespace isoshade
