// SPDX-License-Identifier: Apache-2.0
// Functions that read the surface, lights, time or images: where they may be called from.
#include "compiler/check/stage_needs.h"
#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

std::string function(const std::string& name, const std::string& nodes, const std::string& inputs = "",
                     const std::string& out = "out") {
  return R"({"isoshade": 1, "function": ")" + name + R"(", "inputs": {)" + inputs + "},\n\"nodes\": {" + nodes +
         "},\n\"outputs\": {\"out\": \"" + out + "\"}}";
}

std::string effect(const std::string& nodes, const std::string& pass = R"({"name": "p", "color": "color"})") {
  return "{\"isoshade\": 1, \"effect\": \"e\", \"nodes\": {\n" + nodes + "},\n\"passes\": [" + pass + "]}";
}

std::string post(const std::string& nodes) {
  return "{\"isoshade\": 1, \"post\": \"p\", \"nodes\": {\n" + nodes + "},\n\"outputs\": {\"color\": \"color\"}}";
}

/// Functions that need something, each named after it.
class StageNeeds : public ::testing::Test {
 protected:
  StageNeeds() {
    const auto add = [&](const std::string& name, const std::string& nodes, const std::string& inputs = "") {
      front_end.library.add("library/" + name + ".json", function(name, nodes, inputs));
    };
    add("reads_normal", R"("out": {"type": "normal"})");
    add("reads_default", R"("out": {"type": "cellnoise2d"})");
    add("reads_corner", R"("out": {"type": "cornernormal1"})");
    add("reads_time", R"("out": {"type": "time"})");
    add("reads_image", R"("out": {"type": "image", "file": "a.png", "texcoord": [0, 0]})");
    add("reads_mips", R"("out": {"type": "image", "file": "a.png", "filtertype": "trilinear"})");
    add("sums_lights", R"("l": {"type": "lightcolor"}, "c": {"type": "multiply", "in1": "l", "in2": "k"},
"out": {"type": "sum_lights", "in": "c"})",
        R"("k": {"type": "float", "value": 1})");
    add("slope", R"("out": {"type": "fwidth", "in": "x"})", R"("x": {"type": "float"})");
    add("calls_normal", R"("out": {"type": "reads_normal"})");
    add("calls_twice", R"("out": {"type": "calls_normal"})");
  }

  std::string messages(const std::string& document) {
    front_end.diagnostics = support::Diagnostics();
    return front_end.messages(document);
  }

  FrontEnd front_end;
};

TEST_F(StageNeeds, EffectsCallFunctionsThatReadTheSurfaceLightsTimeAndImages) {
  for (const char* type : {"reads_normal", "reads_default", "reads_time", "reads_image", "reads_mips", "sums_lights",
                           "calls_twice"})
    EXPECT_EQ(messages(effect(R"("c": {"type": ")" + std::string(type) +
                              R"("}, "color": {"type": "convert", "in": "c", "to": "color3"})")),
              "")
        << type;
}

TEST_F(StageNeeds, PostsCallFunctionsThatReadTime) {
  EXPECT_EQ(messages(post(R"("c": {"type": "reads_time"}, "color": {"type": "convert", "in": "c", "to": "color3"})")),
            "");
}

TEST_F(StageNeeds, PostErrorShowsTheNodeAndEveryCall) {
  EXPECT_EQ(messages(post(R"("c": {"type": "calls_twice"}, "color": {"type": "convert", "in": "c", "to": "color3"})")),
            R"(test.json:2:15: error[misplaced-node]: a post cannot call "calls_twice": it depends on "normal"
  2 | "c": {"type": "calls_twice"}, "color": {"type": "convert", "in": "c", "to": "color3"}},
    |               ^^^^^^^^^^^^^ call it from an effect
library/calls_twice.json:2:27: note: which calls "calls_normal" here
  2 | "nodes": {"out": {"type": "calls_normal"}},
    |                           ^^^^^^^^^^^^^^
library/calls_normal.json:2:27: note: which calls "reads_normal" here
  2 | "nodes": {"out": {"type": "reads_normal"}},
    |                           ^^^^^^^^^^^^^^
library/reads_normal.json:2:27: note: which uses "normal" here
  2 | "nodes": {"out": {"type": "normal"}},
    |                           ^^^^^^^^
)");
}

TEST_F(StageNeeds, PostsCannotCallFunctionsOfEffects) {
  const std::pair<const char*, const char*> cases[] = {{"reads_default", R"("cellnoise2d" without "texcoord")"},
                                                       {"reads_corner", R"("cornernormal1")"},
                                                       {"reads_image", R"("image")"},
                                                       {"sums_lights", R"("lightcolor")"}};
  for (const auto& [type, cause] : cases)
    EXPECT_NE(messages(post(R"("c": {"type": ")" + std::string(type) +
                            R"("}, "color": {"type": "convert", "in": "c", "to": "color3"})"))
                  .find("error[misplaced-node]: a post cannot call \"" + std::string(type) + "\": it depends on " + cause),
              std::string::npos)
        << front_end.diagnostics.text();
  EXPECT_NE(messages(post(R"("c": {"type": "slope", "x": 1}, "color": {"type": "convert", "in": "c", "to": "color3"})"))
                .find("a post cannot call \"slope\": it depends on \"fwidth\""),
            std::string::npos);
}

TEST_F(StageNeeds, PositionsCannotCallFunctionsOfPixels) {
  const std::string pass = R"({"name": "p", "color": [1, 1, 1], "position": "at"})";
  const auto moved = [&](const std::string& type) {
    return messages(effect(R"("c": {"type": ")" + type + R"("}, "at": {"type": "convert", "in": "c", "to": "vector3"})", pass));
  };
  EXPECT_EQ(moved("reads_normal"), "");
  EXPECT_EQ(moved("reads_corner"), "");
  EXPECT_EQ(moved("reads_image"), "");
  const std::string lights = moved("sums_lights");
  EXPECT_NE(lights.find("the \"position\" of a pass cannot depend on \"sums_lights\""), std::string::npos) << lights;
  EXPECT_NE(lights.find("which uses \"lightcolor\" here"), std::string::npos) << lights;
  EXPECT_NE(lights.find("lights exist only for pixels"), std::string::npos) << lights;
  EXPECT_NE(moved("reads_mips").find("its mip level exists only for pixels"), std::string::npos);
  EXPECT_NE(messages(effect(R"("t": {"type": "time"}, "s": {"type": "slope", "x": "t"},
"at": {"type": "convert", "in": "s", "to": "vector3"})",
                            pass))
                .find("derivatives exist only for pixels"),
            std::string::npos);
}

TEST_F(StageNeeds, ColorsCannotCallFunctionsOfVertices) {
  const std::string text =
      messages(effect(R"("c": {"type": "reads_corner"}, "color": {"type": "convert", "in": "c", "to": "color3"})"));
  EXPECT_NE(text.find("the \"color\" of a pass cannot depend on \"reads_corner\""), std::string::npos) << text;
  EXPECT_NE(text.find("which uses \"cornernormal1\" here"), std::string::npos) << text;
}

TEST_F(StageNeeds, ASumInsideAFunctionCannotTakeALightOfAnotherSum) {
  EXPECT_EQ(messages(effect(R"("s": {"type": "sums_lights"}, "l": {"type": "lightcolor"},
"p": {"type": "multiply", "in1": "l", "in2": "s"}, "color": {"type": "sum_lights", "in": "p"})")),
            "")
      << "the same for every light";
  const std::string text = messages(effect(R"("l": {"type": "lightcolor"}, "s": {"type": "sums_lights", "k": "l.r"},
"color": {"type": "sum_lights", "in": "s"})"));
  EXPECT_NE(text.find("test.json:2:44: error[misplaced-node]: \"sums_lights\" sums over lights, so its inputs cannot "
                      "depend on a light"),
            std::string::npos)
      << text;
}

TEST_F(StageNeeds, LightNodesOfFunctionsNeedASumInTheFunction) {
  EXPECT_NE(messages(function("f", R"("out": {"type": "lightcolor"})")).find("error[light-outside-sum]"),
            std::string::npos);
}

TEST_F(StageNeeds, UnusedNodesNeedNothing) {
  front_end.library.add("library/unused.json",
                        function("unused", R"("n": {"type": "normal"}, "out": {"type": "constant", "value": 1})"));
  EXPECT_EQ(messages(post(R"("c": {"type": "unused"}, "color": {"type": "convert", "in": "c", "to": "color3"})"))
                .find("misplaced"),
            std::string::npos);
}

TEST_F(StageNeeds, SecondDerivativesAreAllowedAndThirdOnesAreFoundAcrossCalls) {
  const std::string plain = R"("uv": {"type": "texcoord"},)", uv = plain + R"("d": {"type": "ddx", "in": "uv.x"},)";
  const std::string color = R"("color": {"type": "convert", "in": "t", "to": "color3"})";
  EXPECT_EQ(messages(effect(uv + R"("s": {"type": "slope", "x": "d"}, "t": {"type": "add", "in1": "s", "in2": "d"},)" +
                            color)),
            "");
  EXPECT_EQ(messages(effect(plain + R"("s": {"type": "slope", "x": "uv.x"}, "t": {"type": "ddy", "in": "s"},)" + color)),
            "");
  const std::string inner = messages(
      effect(uv + R"("e": {"type": "ddy", "in": "d"}, "t": {"type": "slope", "x": "e"},)" + color));
  EXPECT_NE(inner.find("error[third-derivative]: \"slope\" takes the derivative of its input \"x\", which depends on "
                       "the derivative \"e\""),
            std::string::npos)
      << inner;
  const std::string outer = messages(effect(R"("uv": {"type": "texcoord"}, "r": {"type": "slope", "x": "uv.x"},
"s": {"type": "slope", "x": "r"}, "t": {"type": "ddy", "in": "s"},)" + color));
  EXPECT_NE(outer.find("error[third-derivative]: \"ddy\" of a value that depends on the second derivative \"s\""),
            std::string::npos)
      << outer;
}

TEST_F(StageNeeds, LightsHaveNoSecondDerivatives) {
  const auto of_light = [&](const std::string& rest) {
    return messages(effect(R"("l": {"type": "lightcolor"}, "d": {"type": "ddx", "in": "l"},)" + rest +
                           R"("color": {"type": "sum_lights", "in": "x"})"));
  };
  EXPECT_EQ(of_light(R"("x": {"type": "add", "in1": "l", "in2": "d"},)"), "");
  const std::string twice = of_light(R"("x": {"type": "ddy", "in": "d"},)");
  EXPECT_NE(twice.find("error[unsupported]: a second derivative is taken of \"l\", which depends on lights"),
            std::string::npos)
      << twice;
}

TEST_F(StageNeeds, ARecursiveFunctionOfTheSurfaceIsAnError) {
  front_end.library.add("library/again.json", function("again", R"("n": {"type": "normal"}, "r": {"type": "again"},
"out": {"type": "add", "in1": "n", "in2": "r"})"));
  EXPECT_NE(messages(effect(R"("c": {"type": "again"}, "color": {"type": "convert", "in": "c", "to": "color3"})"))
                .find("error[recursion]: the function is recursive: library/again.json -> library/again.json"),
            std::string::npos);
}

TEST_F(StageNeeds, OnlyFunctionsWithoutAStageStandAlone) {
  const auto alone = [&](const std::string& document) {
    support::Diagnostics diagnostics;
    const auto typed = front_end.check(document);
    const bool stands = typed != nullptr && check::stands_alone(*typed, diagnostics);
    EXPECT_EQ(stands, diagnostics.all().empty());
    return diagnostics.text();
  };
  EXPECT_EQ(alone(function("f", R"("out": {"type": "add", "in1": "x", "in2": 1})", R"("x": {"type": "float"})")), "");
  EXPECT_EQ(alone(function("f", R"("out": {"type": "calls_normal"})")),
            R"(test.json:2:27: error[unsupported]: "f" cannot be evaluated by itself: it depends on "normal"
  2 | "nodes": {"out": {"type": "calls_normal"}},
    |                           ^^^^^^^^^^^^^^ call it from an effect
library/calls_normal.json:2:27: note: which calls "reads_normal" here
  2 | "nodes": {"out": {"type": "reads_normal"}},
    |                           ^^^^^^^^^^^^^^
library/reads_normal.json:2:27: note: which uses "normal" here
  2 | "nodes": {"out": {"type": "normal"}},
    |                           ^^^^^^^^
)");
  EXPECT_NE(alone(function("f", R"("out": {"type": "reads_time"})")).find("it depends on \"time\""), std::string::npos);
  EXPECT_NE(alone(function("f", R"("out": {"type": "constant", "value": 1})", R"("map": {"type": "filename"})"))
                .find("\"map\" is an image"),
            std::string::npos);
}

}  // namespace
}  // namespace isoshade
