// SPDX-License-Identifier: Apache-2.0
// Post documents: where the nodes of the screen may stand, taps, images, and what a post gives.
#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

std::string post(const std::string& nodes, const std::string& more = "",
                 const std::string& outputs = R"("color": "color")") {
  return "{\"isoshade\": 1, \"post\": \"p\", " + more + "\"nodes\": {\n" + nodes + "},\n\"outputs\": {" +
         outputs + "}}";
}

std::string messages_of(const std::string& document) {
  FrontEnd front_end;
  return front_end.messages(document);
}

bool says(const std::string& document, const std::string& part) {
  return messages_of(document).find(part) != std::string::npos;
}

TEST(CheckPosts, RejectsSurfaceAndLightNodes) {
  for (const char* type : {"normal", "lightcolor", "position", "texcoord"})
    EXPECT_TRUE(
        says(post("\"color\": {\"type\": \"" + std::string(type) + "\"}"),
             "error[misplaced-node]: \"" + std::string(type) + "\" is not available in a post document"))
        << type;
  EXPECT_TRUE(says(post(R"("n": {"type": "time"}, "d": {"type": "ddx", "in": "n"},
    "color": {"type": "combine3", "in1": "d"})"),
                   "\"ddx\" is not available in a post document"));
  EXPECT_EQ(messages_of(
                post(R"("t": {"type": "time"}, "color": {"type": "combine3", "in1": "t", "to": "color3"})")),
            "");
}

TEST(CheckPosts, RejectsScreenNodesOutsidePosts) {
  for (const char* type :
       {"scenecolor", "scenedepth", "worldposition", "viewray", "pixelcoord", "cameraposition"}) {
    const std::string nodes = "\"n\": {\"type\": \"" + std::string(type) + "\"}";
    const bool reads_picture = std::string(type).starts_with("scene");  // see check_blending_test.cpp
    if (!reads_picture) {
      EXPECT_TRUE(says(R"({"isoshade": 1, "effect": "e", "nodes": {)" + nodes +
                           R"(}, "passes": [{"name": "p", "color": "n"}]})",
                       "\" is not available in an effect document"))
          << type;
    }
    EXPECT_TRUE(
        says(R"({"isoshade": 1, "function": "f", "nodes": {)" + nodes + R"(}, "outputs": {"out": "n"}})",
             "\" is not available in a function document"))
        << type;
  }
}

TEST(CheckPosts, RequiresPortsThatDefaultToTheSurface) {
  EXPECT_TRUE(
      says(post(R"("c": {"type": "cellnoise2d"}, "color": {"type": "combine3", "in1": "c", "to": "color3"})"),
           "error[missing-port]"));
}

TEST(CheckPosts, TapIndexRequiresASumWithAValidRange) {
  EXPECT_TRUE(says(post(R"("i": {"type": "tapindex"}, "color": {"type": "scenecolor", "offsetx": "i"})"),
                   "error[tap-outside-sum]: \"tapindex\" is used outside of sum_taps"));
  const auto sum = [](const std::string& range) {
    return post(R"("i": {"type": "tapindex"}, "c": {"type": "scenecolor", "offsetx": "i"},
      "color": {"type": "sum_taps", "in": "c", )" +
                range + "}");
  };
  EXPECT_EQ(messages_of(sum(R"("first": -4, "last": 4)")), "");
  EXPECT_EQ(messages_of(sum(R"("last": 63)")), "");
  EXPECT_EQ(messages_of(sum(R"("first": 5, "last": 5)")), "");
  EXPECT_TRUE(says(sum(R"("last": 64)"), "error[out-of-range]: \"sum_taps\" has 65 taps, more than 64"));
  EXPECT_TRUE(
      says(sum(R"("last": 0.5)"), "must be a literal integer of 32 bits, not a number with a fraction"));
  EXPECT_TRUE(says(sum(R"("last": "c")"), "must be a literal integer of 32 bits, not a string"));
  EXPECT_TRUE(says(sum(R"("first": 1, "last": 0)"), "error[out-of-range]: \"last\" of \"sum_taps\" is less"));
  EXPECT_TRUE(says(sum(R"("first": -2147483648, "last": 2147483647)"), "error[out-of-range]"));
  EXPECT_TRUE(says(sum(R"("first": 1)"), "error[missing-port]"));
  EXPECT_TRUE(says(sum(R"("last": {"link": "i"})"), "error[not-literal]"));
}

TEST(CheckPosts, RejectsUnlistedAndInvalidImages) {
  const std::string glow = R"("color": {"type": "scenecolor", "image": "glow"})";
  EXPECT_EQ(messages_of(post(glow, R"("images": ["glow"], )")), "");
  EXPECT_TRUE(says(post(glow), "error[unknown-image]: the document has no image \"glow\""));
  EXPECT_TRUE(says(post(glow, R"("images": ["glow", "glow"], )"), "error[duplicate-name]"));
  EXPECT_TRUE(says(post(glow, R"("images": ["glow", "color"], )"), "error[duplicate-name]"));
  EXPECT_TRUE(says(post(glow, R"("images": ["glow", "a b"], )"), "error[bad-id]"));
  EXPECT_TRUE(says(post(glow, R"("images": ["glow", 1], )"), "error[wrong-type]"));
}

TEST(CheckPosts, RejectsOutputsOtherThanColor) {
  const std::string color = R"("color": {"type": "scenecolor"}, "d": {"type": "scenedepth"})";
  EXPECT_TRUE(
      says(post(color, "", R"("out": "color")"), "error[unknown-output]: a post has no output \"out\""));
  EXPECT_TRUE(says(post(color, "", R"("color": "d.issky")"), "error[type-mismatch]"));
  EXPECT_EQ(messages_of(post(R"("d": {"type": "scenedepth"})", "", R"("color": "d.linear")")), "");
}

TEST(CheckPosts, EnabledMustNameAScalarParameter) {
  const auto switched = [](const std::string& name) {
    return post(
        R"("color": {"type": "multiply", "in1": "tint", "in2": "gain"})",
        R"("parameters": {"gain": {"type": "float", "value": 1}, "tint": {"type": "color3", "value": [1, 1, 1]}},
                   "enabled": )" +
            name + ", ");
  };
  EXPECT_EQ(messages_of(switched("\"gain\"")), "");
  EXPECT_TRUE(says(switched("\"gian\""), "error[unknown-parameter]: the post has no parameter \"gian\""));
  EXPECT_TRUE(says(switched("\"tint\""), "error[type-mismatch]: \"enabled\" of a post must name"));
  EXPECT_TRUE(says(switched("1"), "error[wrong-type]"));
}

}  // namespace
}  // namespace isoshade
