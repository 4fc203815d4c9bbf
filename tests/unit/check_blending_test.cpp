// SPDX-License-Identifier: Apache-2.0
// Passes that are blended: their states, the parameter that switches blending, and what they may read of the picture.
#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

std::string effect(const std::string& pass, const std::string& nodes = "", const std::string& more_passes = "") {
  return R"({"isoshade": 1, "effect": "e", "parameters": {
    "tint": {"type": "color4", "value": [1, 1, 1, 1]}, "clear": {"type": "boolean", "value": true}},
  "nodes": {"seen": {"type": "scenecolor"}, "far": {"type": "scenedepth"}, "t": {"type": "texcoord"})" +
         nodes + R"(}, "passes": [{"name": "p", )" + pass + "}" + more_passes + "]}";
}

std::string messages_of(const std::string& pass, const std::string& nodes = "", const std::string& more_passes = "") {
  FrontEnd front_end;
  return front_end.messages(effect(pass, nodes, more_passes));
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(CheckBlending, TakesEachWayToBlend) {
  for (const std::string blend : {"over", "add", "multiply", "premultiplied"})
    EXPECT_FALSE(has(messages_of(R"("color": "tint", "depth_write": "on", "blend": ")" + blend + '"'), "error")) << blend;
  const std::string unknown = messages_of(R"("color": "tint", "blend": "multiplied")");
  EXPECT_TRUE(has(unknown, "error")) << unknown;
  EXPECT_TRUE(has(unknown, "multiply")) << unknown;
}

TEST(CheckBlending, RejectsKeysWithoutEffect) {
  for (const std::string key : {R"("blended": "clear")", R"("depth_write": "on")"}) {
    const std::string found = messages_of(R"("color": "tint", )" + key);
    EXPECT_TRUE(has(found, "has no effect without \"blend\"")) << found;
    const std::string none = messages_of(R"("color": "tint", "blend": "none", )" + key);
    EXPECT_TRUE(has(none, "has no effect where \"blend\" is \"none\"")) << none;
  }
  EXPECT_TRUE(has(messages_of(R"("color": "tint", "blend": "over", "blended": "tint")"),
                  "must name a boolean, integer or float parameter, not a color4"));
  EXPECT_TRUE(has(messages_of(R"("color": "tint", "blend": "over", "blended": "cleer")"), "did you mean \"clear\""));
}

TEST(CheckBlending, LetsTheColorReadThePicture) {
  EXPECT_FALSE(has(messages_of(R"("blend": "over", "color": "seen")"), "error"));
  EXPECT_FALSE(has(messages_of(R"("blend": "add", "color": "c")",
                               R"j(, "c": {"type": "expression", "code": "color3(z)", "z": "far.linear"})j"),
                   "error"));
}

TEST(CheckBlending, RejectsReadingThePictureWhereThereIsNone) {
  const std::string opaque = messages_of(R"("color": "seen")");
  EXPECT_TRUE(has(opaque, "the \"color\" of pass \"p\" cannot depend on \"scenecolor\"")) << opaque;
  EXPECT_TRUE(has(opaque, "give the pass a \"blend\"")) << opaque;
  const std::string switched = messages_of(R"("color": "seen", "blend": "over", "blended": "clear")");
  EXPECT_TRUE(has(switched, "remove \"blended\"")) << switched;
  const std::string cutout = messages_of(R"("color": "tint", "blend": "over", "cutout": "seen.a")");
  EXPECT_TRUE(has(cutout, "the \"cutout\" of pass \"p\" cannot depend on \"scenecolor\"")) << cutout;
  const std::string moved = messages_of(R"("color": "tint", "blend": "over", "position": "at")",
                                        R"(, "at": {"type": "convert", "in": "seen.rgb", "to": "vector3"})");
  EXPECT_TRUE(has(moved, "the \"position\" of pass \"p\" cannot depend on \"scenecolor\"")) << moved;
  const std::string second = messages_of(R"("color": "seen", "blend": "over")", "", R"(, {"name": "q", "color": "seen"})");
  EXPECT_TRUE(has(second, "the \"color\" of pass \"q\"")) << second;
  EXPECT_FALSE(has(second, "of pass \"p\"")) << second;
}

TEST(CheckBlending, RejectsDerivativesOfThePicture) {
  const std::string found = messages_of(R"("color": "c", "blend": "over")",
                                        R"j(, "w": {"type": "fwidth", "in": "seen.r"},
    "c": {"type": "expression", "code": "color3(w)", "w": "w"})j");
  EXPECT_TRUE(has(found, "\"fwidth\" takes the derivative of a value that depends on \"seen\"")) << found;
}

TEST(CheckBlending, RejectsFunctionsThatReadThePicture) {
  FrontEnd front_end;
  const std::string found = front_end.messages(R"({"isoshade": 1, "function": "f", "nodes": {"s": {"type": "scenedepth"}},
    "outputs": {"out": "s"}})");
  EXPECT_TRUE(has(found, "\"scenedepth\" is not available in a function document")) << found;
}

}  // namespace
}  // namespace isoshade
