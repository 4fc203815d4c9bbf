// SPDX-License-Identifier: Apache-2.0
// The cut-outs of passes: what they may be, what they may not depend on, and the function that they become.
#include <cmath>
#include <limits>

#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

std::string effect(const std::string& pass, const std::string& nodes = "") {
  return R"({"isoshade": 1, "effect": "e", "parameters": {
    "tint": {"type": "color4", "value": [1, 1, 1, 1]}, "level": {"type": "float", "value": 0.25},
    "steps": {"type": "integer", "value": 1}, "on": {"type": "boolean", "value": true}},
  "nodes": {"uv": {"type": "texcoord"})" +
         nodes + R"(}, "passes": [{"name": "p", "color": "tint", )" + pass + "}]}";
}

std::string messages_of(const std::string& pass, const std::string& nodes = "") {
  FrontEnd front_end;
  return front_end.messages(effect(pass, nodes));
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(CheckCutouts, TakeABooleanOrAFloatAndMarkTheirNodesUsed) {
  EXPECT_EQ(messages_of(R"("cutout": "front")", R"(, "front": {"type": "frontfacing"})").find("error"), std::string::npos);
  EXPECT_FALSE(has(messages_of(R"("cutout": "front")", R"(, "front": {"type": "frontfacing"})"), "node \"front\""));
  EXPECT_FALSE(has(messages_of(R"("cutout": "tint.a", "cutoff": 0.75)"), "error"));
  EXPECT_FALSE(has(messages_of(R"("cutout": "uv.x", "cutoff": "level")"), "error"));
  EXPECT_FALSE(has(messages_of(R"("cutout": "steps", "cutoff": "steps")"), "error"));
}

TEST(CheckCutouts, RejectOtherTypes) {
  EXPECT_TRUE(has(messages_of(R"("cutout": "uv")"), "error[type-mismatch]: \"cutout\" must be boolean or float, not vector2"));
  EXPECT_TRUE(has(messages_of(R"("cutout": "uv.x", "cutoff": "tint")"),
                  "error[type-mismatch]: \"cutoff\" must be float, not color4"));
  const std::string both = messages_of(R"("cutout": "on", "cutoff": 0.5)");
  EXPECT_TRUE(has(both, "error[type-mismatch]: \"cutoff\" belongs to a float \"cutout\", and this one is a boolean")) << both;
  EXPECT_TRUE(has(both, "remove \"cutoff\"")) << both;
}

TEST(CheckCutouts, RejectLightsAndCornersOfVertices) {
  const std::string lit = messages_of(R"("cutout": "shade.x")",
                                      R"(, "l": {"type": "lightdirection"}, "shade": {"type": "sum_lights", "in": "l"})");
  EXPECT_TRUE(has(lit, "error[misplaced-node]: the \"cutout\" of a pass cannot depend on \"sum_lights\"")) << lit;
  EXPECT_TRUE(has(lit, "it decides what is seen, and lights exist only for what is seen")) << lit;
  const std::string level = messages_of(R"("cutout": "uv.x", "cutoff": "shade.x")",
                                        R"(, "l": {"type": "lightdirection"}, "shade": {"type": "sum_lights", "in": "l"})");
  EXPECT_TRUE(has(level, "the \"cutoff\" of a pass cannot depend on \"sum_lights\"")) << level;
  const std::string corner = messages_of(R"("cutout": "c.x")", R"(, "c": {"type": "cornernormal1"})");
  EXPECT_TRUE(has(corner, "the \"cutout\" of a pass cannot depend on \"cornernormal1\"")) << corner;
}

TEST(CheckCutouts, TakeDerivatives) {
  EXPECT_FALSE(has(messages_of(R"("cutout": "w", "cutoff": 0.1)", R"(, "w": {"type": "fwidth", "in": "uv.x"})"), "error"));
}

TEST(CheckPositions, HaveNoFrontOrBack) {
  const std::string text = messages_of(
      R"("position": "moved")",
      R"(, "front": {"type": "frontfacing"}, "p": {"type": "position"},
          "moved": {"type": "ifequal", "value1": "front", "value2": true, "in1": "p", "in2": [0, 0, 0]})");
  EXPECT_TRUE(has(text, "error[misplaced-node]: the \"position\" of a pass cannot depend on \"frontfacing\"")) << text;
}

/// Whether a value is drawn, by the function that the pass's cut-out becomes.
bool is_drawn(const std::string& pass, const std::vector<float>& arguments) {
  FrontEnd front_end;
  const auto graph = front_end.check(effect(pass));
  EXPECT_NE(graph, nullptr) << front_end.diagnostics.text();
  if (graph == nullptr) return false;
  const auto [module, interface] = lower::lower(*graph, {.part = lower::PassPart::coverage});
  EXPECT_EQ(module.functions[interface.entry].name, "coverage");
  Program program(module);
  return std::bit_cast<uint32_t>(program(arguments).at(0)) != 0;
}

TEST(LowerCutouts, HoldWhereTheValueReachesTheCutoff) {
  const std::string half = R"("cutout": "uv.x")";
  EXPECT_TRUE(is_drawn(half, {0.5f, 0}));
  EXPECT_FALSE(is_drawn(half, {std::nextafter(0.5f, 0.0f), 0}));
  EXPECT_FALSE(is_drawn(half, {std::numeric_limits<float>::quiet_NaN(), 0}));
  const std::string written = R"("cutout": "uv.x", "cutoff": 0.75)";
  EXPECT_TRUE(is_drawn(written, {0.75f, 0}));
  EXPECT_FALSE(is_drawn(written, {0.7f, 0}));
}

TEST(LowerCutouts, HoldEverywhereWhereTheCutoffIsNotAboveZero) {
  const std::string by_parameter = R"("cutout": "uv.x", "cutoff": "level")";
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(is_drawn(by_parameter, {0.25f, 0, /* level */ 0.25f}));
  EXPECT_FALSE(is_drawn(by_parameter, {0.2f, 0, 0.25f}));
  for (const float level : {0.0f, -1.0f})
    for (const float value : {1.0f, 0.0f, -5.0f, nan}) EXPECT_TRUE(is_drawn(by_parameter, {value, 0, level}));
}

TEST(LowerCutouts, AskOnlyForWhatTheyDependOn) {
  FrontEnd front_end;
  const auto graph = front_end.check(effect(R"("cutout": "front")", R"(, "front": {"type": "frontfacing"})"));
  ASSERT_NE(graph, nullptr) << front_end.diagnostics.text();
  const auto [module, interface] = lower::lower(*graph, {.part = lower::PassPart::coverage});
  const std::vector<ir::Parameter>& parameters = module.functions[interface.entry].parameters;
  ASSERT_EQ(parameters.size(), 1u);
  EXPECT_EQ(parameters[0].name, "front_facing");
  EXPECT_EQ(parameters[0].type, ir::bool_type);
}

}  // namespace
}  // namespace isoshade
