// SPDX-License-Identifier: Apache-2.0
// Where the nodes of the environment may stand.
#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

constexpr const char* nodes = R"("n": {"type": "normal"}, "e": {"type": "environment", "direction": "n"},
"bright": {"type": "extract", "in": "e"})";

std::string effect(const std::string& more, const std::string& pass = R"("color": "color")") {
  return "{\"isoshade\": 1, \"effect\": \"e\", \"nodes\": {\n" + more + (more.empty() ? "" : ", ") + nodes +
         "},\n\"passes\": [{\"name\": \"p\", " + pass + "}]}";
}

std::string messages_of(const std::string& document) {
  FrontEnd front_end;
  front_end.library.add("library/lit.json", R"({"isoshade": 1, "function": "lit", "inputs": {},
"nodes": {"i": {"type": "irradiance", "direction": [0, 1, 0]}}, "outputs": {"out": "i"}})");
  front_end.library.add("library/slope.json", R"({"isoshade": 1, "function": "slope", "inputs": {"x": {"type": "float"}},
"nodes": {"out": {"type": "fwidth", "in": "x"}}, "outputs": {"out": "out"}})");
  return front_end.messages(document);
}

bool says(const std::string& document, const std::string& part) {
  const std::string messages = messages_of(document);
  EXPECT_NE(messages.find(part), std::string::npos) << messages;
  return messages.find(part) != std::string::npos;
}

TEST(CheckEnvironment, StandsInColoursFunctionsAndPosts) {
  EXPECT_EQ(messages_of(effect(R"("l": {"type": "lit"}, "s": {"type": "multiply", "in1": "l", "in2": "bright"},
"color": {"type": "add", "in1": "s", "in2": "e"})")), "");
  EXPECT_EQ(messages_of(R"({"isoshade": 1, "post": "p", "nodes": {"ray": {"type": "viewray"}, "l": {"type": "lit"},
"e": {"type": "environment", "direction": "ray", "roughness": 0.5}, "color": {"type": "add", "in1": "l", "in2": "e"}},
"outputs": {"color": "color"}})"), "");
}

TEST(CheckEnvironment, APostMustGiveTheDirectionOfIrradiance) {
  says(R"({"isoshade": 1, "post": "p", "nodes": {"color": {"type": "irradiance"}}, "outputs": {"color": "color"}})",
       "missing-port");
}

TEST(CheckEnvironment, IsNotAvailableWherePositionsAndVisibilityAreDecided) {
  says(effect(R"("p": {"type": "multiply", "in1": "n", "in2": "bright"})", R"("color": "e", "position": "p")"),
       "the environment exists only for pixels");
  says(effect("", R"("color": "e", "cutout": "bright")"), "the \"cutout\" of a pass cannot depend on");
}

TEST(CheckEnvironment, HasNoDerivatives) {
  says(effect(R"("d": {"type": "ddx", "in": "bright"}, "color": {"type": "multiply", "in1": "e", "in2": "d"})"),
       "takes the derivative of \"bright\", which depends on the environment");
  says(effect(R"("d": {"type": "slope", "x": "bright"}, "color": {"type": "multiply", "in1": "e", "in2": "d"})"),
       "takes the derivative of \"bright\", which depends on the environment");
  says(effect(R"("uv": {"type": "combine2", "in1": "bright"}, "color": {"type": "image", "file": "a.png",
"texcoord": "uv", "filtertype": "trilinear"})"), "which depends on the environment");
  // A reflection may depend on a derivative.
  EXPECT_EQ(messages_of(effect(R"("x": {"type": "extract", "in": "n"}, "d": {"type": "ddx", "in": "x"},
"f": {"type": "environment", "direction": "n", "roughness": "d"}, "color": {"type": "multiply", "in1": "f", "in2": "bright"})")),
            "");
}

}  // namespace
}  // namespace isoshade
