// SPDX-License-Identifier: Apache-2.0
// The positions of passes: what they may be, and may not depend on.
#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

std::string messages_of(const std::string& nodes, const std::string& position) {
  FrontEnd front_end;
  return front_end.messages(
      R"({"isoshade": 1, "effect": "e", "parameters": {"tint": {"type": "color3", "value": [1, 1, 1]}},
          "nodes": {"p": {"type": "position"})" +
      nodes + R"(}, "passes": [{"name": "hull", "color": "tint", "position": ")" + position + R"("}]})");
}

TEST(CheckPositions, MustBeVector3AndMarkTheirNodesUsed) {
  EXPECT_EQ(messages_of("", "p"), "");
  EXPECT_EQ(messages_of(R"(, "t": {"type": "time"}, "up": {"type": "add", "in1": "p", "in2": "t"})", "up"),
            "");
  EXPECT_NE(messages_of("", "p.x").find("error[type-mismatch]: \"position\" must be vector3, not float"),
            std::string::npos);
  EXPECT_NE(messages_of("", "tint").find("error[type-mismatch]: \"position\" must be vector3, not color3"),
            std::string::npos);
  EXPECT_NE(messages_of("", "q").find("error[unknown-node]: there is no node or parameter \"q\""), std::string::npos);
}

TEST(CheckPositions, RejectNodesThatOnlyPixelsHave) {
  const std::string slope = messages_of(
      R"(, "d": {"type": "fwidth", "in": "p"}, "up": {"type": "add", "in1": "p", "in2": "d"})", "up");
  EXPECT_NE(slope.find("error[misplaced-node]: the \"position\" of a pass cannot depend on \"fwidth\""),
            std::string::npos)
      << slope;
  EXPECT_NE(slope.find("derivatives exist only for pixels"), std::string::npos) << slope;
  const std::string lit =
      messages_of(R"(, "l": {"type": "lightdirection"}, "up": {"type": "sum_lights", "in": "l"})", "up");
  EXPECT_NE(lit.find("cannot depend on \"sum_lights\""), std::string::npos) << lit;
  EXPECT_NE(lit.find("lights exist only for pixels"), std::string::npos) << lit;
  EXPECT_EQ(lit.find("light-outside-sum"), std::string::npos) << lit;
}

TEST(CheckPositions, AcceptCornerNormalsUnlikeColors) {
  const std::string nodes = R"(, "c": {"type": "cornernormal2"}, "up": {"type": "add", "in1": "p", "in2": "c"})";
  EXPECT_EQ(messages_of(nodes, "up"), "");
  FrontEnd front_end;
  const std::string text = front_end.messages(R"({"isoshade": 1, "effect": "e", "nodes": {
    "c": {"type": "cornernormal1"}, "color": {"type": "convert", "in": "c", "to": "color3"}},
    "passes": [{"name": "p", "color": "color"}]})");
  EXPECT_NE(text.find("error[misplaced-node]: the \"color\" of a pass cannot depend on \"cornernormal1\""),
            std::string::npos)
      << text;
}

}  // namespace
}  // namespace isoshade
