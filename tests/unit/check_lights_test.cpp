// SPDX-License-Identifier: Apache-2.0
// Light nodes and their sums, spaces, and input types that are not supported yet.
#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

std::string effect(const std::string& nodes, const std::string& pass = R"({"name": "p", "color": "color"})") {
  return "{\"isoshade\": 1, \"effect\": \"e\", \"nodes\": {\n" + nodes + "},\n\"passes\": [" + pass + "]}";
}

std::string messages_of(const std::string& document) {
  FrontEnd front_end;
  return front_end.messages(document);
}

TEST(CheckLights, RejectsLightNodesOutsideASumWithAFix) {
  EXPECT_EQ(
      messages_of(effect(R"("l": {"type": "lightcolor"}, "half": {"type": "multiply", "in1": "l", "in2": 0.5},
"sum": {"type": "sum_lights", "in": "half"}, "color": {"type": "add", "in1": "sum", "in2": "half"})")),
      R"(test.json:2:15: error[light-outside-sum]: "lightcolor" is used outside of sum_lights
  2 | "l": {"type": "lightcolor"}, "half": {"type": "multiply", "in1": "l", "in2": 0.5},
    |               ^^^^^^^^^^^^ link the value that depends on it to a sum_lights node
  note: an output depends on it: l -> half -> color
)");
}

TEST(CheckLights, AcceptsNestedAndSeveralSums) {
  EXPECT_EQ(messages_of(effect(R"("l": {"type": "lightcolor"}, "s": {"type": "sum_lights", "in": "l"},
    "ls": {"type": "multiply", "in1": "l", "in2": "s"}, "color": {"type": "sum_lights", "in": "ls"})")),
            "");
}

TEST(CheckLights, RejectsUnknownSpaces) {
  EXPECT_NE(messages_of(effect(R"("color": {"type": "position", "space": "wrld"})"))
                .find("error[unknown-choice]: \"space\" of \"position\" cannot be \"wrld\""),
            std::string::npos);
}

TEST(CheckLights, RejectsMatrixParametersAsUnsupported) {
  EXPECT_NE(
      messages_of(R"({"isoshade": 1, "effect": "e", "parameters": {"f": {"type": "matrix33", "value": [1, 0, 0, 0, 1, 0, 0, 0, 1]},
                           "c": {"type": "color3", "value": [1, 1, 1]}}, "passes": [{"name": "p", "color": "c"}]})")
          .find("error[unsupported]: a parameter of type matrix33"),
      std::string::npos);
}

}  // namespace
}  // namespace isoshade
