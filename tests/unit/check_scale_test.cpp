// SPDX-License-Identifier: Apache-2.0
// Large graphs: no stack that grows with them, no time that grows faster.
#include <ctime>

#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

/// Of the processor: other programs do not count.
double seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// n0 = in * 0.5, n1 = n0 * 0.5, ...; written last first, so that every link points down.
std::string chain(int length, const std::string& first) {
  std::string text = R"({"isoshade": 1, "function": "f", "inputs": {"x": {"type": "vector3"}}, "nodes": {)";
  for (int i = length - 1; i >= 0; --i) {
    text += "\"n" + std::to_string(i) + R"(": {"type": "multiply", "in1": ")" +
            (i > 0 ? "n" + std::to_string(i - 1) : first) + R"(", "in2": 0.5})" + (i > 0 ? ",\n" : "");
  }
  return text + R"(}, "outputs": {"out": "n)" + std::to_string(length - 1) + "\"}}";
}

TEST(CheckScale, ChainOf100000NodesIsCheckedAndLowered) {
  FrontEnd front_end;
  const ir::Module module = front_end.lower(chain(100'000, "x"));
  EXPECT_EQ(ir::validate(module), "");
  EXPECT_GE(module.functions[0].instructions.size(), 100'000u);
}

TEST(CheckScale, CycleOf100000NodesIsReportedInOneLine) {
  FrontEnd front_end;
  const std::string messages = front_end.messages(chain(100'000, "n99999"));
  EXPECT_NE(messages.find(
                "error[cycle]: the nodes form a cycle: n99999 -> n99998 -> n99997 -> n99996 -> "
                "... 99992 more ... -> n3 -> n2 -> n1 -> n0 -> n99999"),
            std::string::npos)
      << messages.substr(0, 1000);
}

TEST(CheckScale, RejectsManySumsOverTheSameNodes) {
  std::string text =
      R"({"isoshade": 1, "effect": "e", "nodes": {"l": {"type": "lightcolor"}, "n0": {"type": "floor", "in": "l"},
    "t0": {"type": "floor", "in": "l"}, "s0": {"type": "sum_lights", "in": "l"})";
  constexpr int count = 4000;
  for (int i = 1; i < count; ++i) {
    const std::string number = std::to_string(i), before = std::to_string(i - 1);
    text += ", \"n" + number + R"(": {"type": "floor", "in": "n)" + before + "\"}";
    text += ", \"t" + number + R"(": {"type": "sum_lights", "in": "n)" + number + "\"}";
    text +=
        ", \"s" + number + R"(": {"type": "add", "in1": "t)" + number + R"(", "in2": "s)" + before + "\"}";
  }
  text += R"(}, "passes": [{"name": "p", "color": "s)" + std::to_string(count - 1) + "\"}]}";
  FrontEnd front_end;
  const double start = seconds();
  EXPECT_NE(front_end.messages(text).find("error[too-large]"), std::string::npos);
  EXPECT_LT(seconds() - start, 5);
}

TEST(CheckScale, ManyErrorsAreReportedQuickly) {
  std::string text = R"({"isoshade": 1, "function": "f", "nodes": {"n": {"type": "floor", "in": 1})";
  for (int i = 0; i < 50'000; ++i)
    text += ", \"n" + std::to_string(i) + R"(": {"type": "flor)" + std::to_string(i) + R"(", "inn": "m"})";
  text += R"(}, "outputs": {"out": "n"}})";
  FrontEnd front_end;
  const double start = seconds();
  front_end.check(text);
  EXPECT_LT(seconds() - start, 5);
  EXPECT_EQ(front_end.diagnostics.all().size(), 50u);
}

TEST(CheckScale, RejectsThousandsOfCallsWithThousandsOfInputs) {
  FrontEnd front_end;
  std::string wide = R"({"isoshade": 1, "function": "wide", "inputs": {"x": {"type": "float"})";
  for (int i = 0; i < 5'000; ++i) wide += ", \"i" + std::to_string(i) + R"(": {"type": "float", "value": 1})";
  front_end.library.add("library/wide.json", wide + R"(}, "outputs": {"out": "x"}})");
  std::string text = R"({"isoshade": 1, "function": "f", "nodes": {"n": {"type": "wide", "x": 1})";
  for (int i = 0; i < 5'000; ++i) text += ", \"n" + std::to_string(i) + R"(": {"type": "wide", "x": "n"})";
  EXPECT_NE(front_end.messages(text + R"(}, "outputs": {"out": "n"}})").find("error[too-large]"),
            std::string::npos);
}

TEST(CheckScale, LongReferencesFailQuickly) {
  for (const char* part : {"a/", "./", "../", "a"}) {
    std::string reference;
    while (reference.size() < 1'000'000) reference += part;
    FrontEnd front_end;
    const double start = seconds();
    EXPECT_NE(front_end.messages(R"({"isoshade": 1, "function": "f", "nodes": {"n": {"type": ")" + reference +
                                 R"(x.json"}}, "outputs": {"out": "n"}})"),
              "");
    EXPECT_LT(seconds() - start, 1);
    EXPECT_EQ(front_end.diagnostics.error_count(), 1u);
  }
}

}  // namespace
}  // namespace isoshade
