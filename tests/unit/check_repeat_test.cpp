// SPDX-License-Identifier: Apache-2.0
// Passes that are repeated: how often, and the nodes that tell the repetitions apart.
#include "compiler/interface/host.h"
#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

std::string effect(const std::string& pass, const std::string& nodes = "") {
  return R"json({"isoshade": 1, "effect": "e", "parameters": {
    "shells": {"type": "integer", "value": 4, "min": 2, "max": 16},
    "layers": {"type": "float", "value": 4, "min": 1.5, "max": 8.75},
    "free": {"type": "integer", "value": 1}, "low": {"type": "float", "value": 1, "min": 0.5, "max": 8},
    "high": {"type": "integer", "value": 1, "min": 1, "max": 257},
    "on": {"type": "boolean", "value": true}, "tint": {"type": "color3", "value": [1, 1, 1]}},
  "nodes": {"i": {"type": "passindex"}, "n": {"type": "passcount"},
    "share": {"type": "expression", "code": "float(i) / float(n)", "i": "i", "n": "n"},
    "p": {"type": "position"}, "moved": {"type": "multiply", "in1": "p", "in2": "share"},
    "color": {"type": "multiply", "in1": "tint", "in2": "share"})json" +
         nodes + R"(}, "passes": [{"name": "p", "color": "color", )" + pass + "}]}";
}

std::string messages_of(const std::string& pass) {
  FrontEnd front_end;
  return front_end.messages(effect(pass));
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(CheckRepeat, TakesAWholeNumberOrAParameterOfSuchARange) {
  for (const char* repeat : {"1", "32", "256", "\"shells\"", "\"layers\""})
    EXPECT_FALSE(has(messages_of(R"("repeat": )" + std::string(repeat)), "error")) << repeat;
}

TEST(CheckRepeat, RejectsOtherNumbers) {
  for (const char* repeat : {"0", "-1", "257", "1000000000000"})
    EXPECT_TRUE(has(messages_of(R"("repeat": )" + std::string(repeat)),
                    "error[out-of-range]: \"repeat\" must be a whole number from 1 to 256"))
        << repeat;
  EXPECT_TRUE(has(messages_of(R"("repeat": 2.5)"), "error[wrong-type]: \"repeat\" must be a whole number from 1 to 256"));
  EXPECT_TRUE(has(messages_of(R"("repeat": [2])"),
                  "error[wrong-type]: \"repeat\" must be a whole number from 1 to 256 or the name of a parameter, not an array"));
}

TEST(CheckRepeat, RejectsParametersThatAreNoCounts) {
  EXPECT_TRUE(has(messages_of(R"("repeat": "shels")"), "error[unknown-parameter]: the effect has no parameter \"shels\""));
  EXPECT_TRUE(has(messages_of(R"("repeat": "on")"),
                  "error[type-mismatch]: \"repeat\" must name an integer or float parameter, not a boolean"));
  EXPECT_TRUE(has(messages_of(R"("repeat": "tint")"), "error[type-mismatch]: \"repeat\" of a pass must name"));
  for (const char* name : {"free", "low", "high"}) {
    const std::string text = messages_of(R"("repeat": ")" + std::string(name) + '"');
    EXPECT_TRUE(has(text, "error[out-of-range]: \"repeat\" needs a parameter whose \"min\" and \"max\" lie in the range 1 to 256"))
        << text;
    EXPECT_TRUE(has(text, "the parameter is declared here")) << text;
  }
}

TEST(CheckRepeat, NumbersOfRepetitionsAreForEveryPartOfAPass) {
  EXPECT_EQ(messages_of(R"("repeat": 8, "position": "moved", "cutout": "share", "cutoff": "share", "blend": "over")")
                .find("error"),
            std::string::npos);
}

TEST(CheckRepeat, PostsHaveNoRepetitions) {
  FrontEnd front_end;
  EXPECT_TRUE(has(front_end.messages(R"({"isoshade": 1, "post": "p", "nodes": {"i": {"type": "passindex"},
    "c": {"type": "convert", "in": "i", "to": "color3"}}, "outputs": {"color": "c"}})"),
                  "error[misplaced-node]"));
  front_end.library.add("library/shell.json", R"({"isoshade": 1, "function": "shell",
    "nodes": {"n": {"type": "passcount"}}, "outputs": {"out": "n"}})");
  front_end.diagnostics = support::Diagnostics();
  EXPECT_TRUE(has(front_end.messages(R"({"isoshade": 1, "post": "p", "nodes": {"i": {"type": "shell"},
    "c": {"type": "convert", "in": "i", "to": "color3"}}, "outputs": {"color": "c"}})"),
                  "a post cannot call \"shell\": it depends on \"passcount\""));
}

/// What is assumed of the number and the count in the color of the effect's pass.
std::vector<interface::Assumption> assumed(const std::string& pass) {
  FrontEnd front_end;
  const auto graph = front_end.check(effect(pass));
  EXPECT_NE(graph, nullptr) << front_end.diagnostics.text();
  std::vector<interface::Assumption> all;
  const lower::Lowered made = lower::lower(*graph);
  for (const interface::Binding& binding : made.interface.bindings)
    if (std::holds_alternative<interface::source::PassRepetition>(binding.source)) all.push_back(binding.assumed);
  EXPECT_EQ(all.size(), 2u);
  return all;
}

TEST(CheckRepeat, NumbersOfRepetitionsHaveTheRangesOfTheirPass) {
  const auto expect = [](const char* pass, double most_index, double least_count, double most_count) {
    const auto [index, count] = std::array{assumed(pass)[0], assumed(pass)[1]};
    EXPECT_EQ(index.lo, 0) << pass;
    EXPECT_EQ(index.hi, most_index) << pass;
    EXPECT_EQ(count.lo, least_count) << pass;
    EXPECT_EQ(count.hi, most_count) << pass;
  };
  expect(R"("cull": "back")", 0, 1, 1);
  expect(R"("repeat": 32)", 31, 32, 32);
  expect(R"("repeat": "shells")", 15, 2, 16);
  expect(R"("repeat": "layers")", 7, 1, 8);
}

TEST(CheckRepeat, PureShadersAskTheirHost) {
  for (const auto what : {interface::Repetition::index, interface::Repetition::count}) {
    const auto place = interface::place_of(interface::bind_repetition(what, {}), false);
    const auto* host = std::get_if<interface::place::Host>(&place);
    ASSERT_NE(host, nullptr);
    EXPECT_EQ(interface::row(host->call).name, what == interface::Repetition::index ? "pass_index" : "pass_count");
  }
}

}  // namespace
}  // namespace isoshade
