// SPDX-License-Identifier: Apache-2.0
// What `isoshade check` says of errors and ranges is so where a host is asked, sums are long, results are flushed, and
// functions are used beyond their domains.
#include <gtest/gtest.h>

#include "compiler/prove/document.h"
#include "compiler/interface/binding.h"
#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

using prove::Proof;

Proof proof_of(const std::string& text, functions::Tier tier = functions::Tier::standard) {
  FrontEnd front_end(ISOSHADE_GRAPHS "/library");
  const auto graph = front_end.check(text);
  EXPECT_NE(graph, nullptr) << front_end.diagnostics.text();
  if (graph == nullptr) return {};
  const auto subjects = prove::subjects_of(*graph, front_end.diagnostics, tier);
  EXPECT_TRUE(subjects && !subjects->empty());
  return prove::prove(subjects->front().tape);
}

/// `ports`: what the code of the coordinate reads, "p" the position, "t" the texture coordinate.
Proof proof_of_image(const std::string& texcoord, const std::string& ports, const std::string& filter) {
  std::string read;
  for (const char port : ports) read += std::string(", \"") + port + "\": \"" + port + "\"";
  const std::string nodes = ports == "t" ? "" : R"("p": {"type": "position"}, )";
  return proof_of(
      R"({"isoshade": 1, "effect": "e", "parameters": {"picture": {"type": "filename", "value": ""}},
      "nodes": {)" +
      nodes + R"("t": {"type": "texcoord"}, "at": {"type": "expression", "code": ")" + texcoord + "\"" +
      read + R"(},
      "c": {"type": "image", "file": {"link": "picture"}, "texcoord": "at", "filtertype": ")" +
      filter + R"("}}, "passes": [{"name": "base", "color": "c"}]})");
}

TEST(Soundness, CoordinateErrorsReachTheTexel) {
  // The sum loses a sixteenth: that is many texels of a large picture.
  EXPECT_GE(proof_of_image("vector2((p.x + 1e6) - 1e6, t.y)", "pt", "linear").outputs[0].absolute, 1000);
  const Proof plain = proof_of_image("t * 1", "t", "linear");
  EXPECT_GT(plain.outputs[0].absolute, 1e-3) << "the place between texels is rounded";
  EXPECT_LT(plain.outputs[0].absolute, 8);
  EXPECT_GE(proof_of_image("t * 1", "t", "closest").outputs[0].absolute, 1000)
      << "rounding moves to the next texel";
}

TEST(Soundness, TippedComparisonsPropagateThroughLogic) {
  // The sum loses up to a sixteenth, so that exact arithmetic may find another truth.
  for (const char* code : {"((x + 1e6) - 1e6 > 0.5) != (y > 2) ? 1 : 0", "((x + 1e6) - 1e6 > 0.5) == (y > 2) ? 1 : 0",
                           "((x + 1e6) - 1e6 > 0.5) && (y < 2) ? 1 : 0", "!((x + 1e6) - 1e6 > 0.5) ? 1 : 0 * y"}) {
    const Proof proof = proof_of(
        R"({"isoshade": 1, "function": "f", "inputs": {"x": {"type": "float", "min": 0, "max": 1},
        "y": {"type": "float", "min": 0, "max": 1}}, "nodes": {"r": {"type": "expression", "code": ")" +
        std::string(code) + R"(", "x": "x", "y": "y"}}, "outputs": {"out": "r"}})");
    EXPECT_GE(proof.outputs[0].absolute, 1) << code;
  }
}

TEST(Soundness, LinearFilterMayRoundBeyondItsTexels) {
  EXPECT_GT(proof_of_image("t * 1", "t", "linear").outputs[0].hi, 1000);
  EXPECT_LT(proof_of_image("t * 1", "t", "linear").outputs[0].hi, 1000.01);
}

TEST(Soundness, RoundedOffsetsMayReadAnotherPixel) {
  const auto post = [](const std::string& offset) {
    return proof_of(
        R"({"isoshade": 1, "post": "p", "parameters": {"x": {"type": "float", "value": 1, "min": 0, "max": 9}},
        "nodes": {"o": {"type": "expression", "code": ")" +
        offset + R"(", "x": "x"},
        "c": {"type": "scenecolor", "offsetx": "o"}}, "outputs": {"color": "c"}})");
  };
  EXPECT_EQ(post("integer(x)").outputs[0].absolute, 0);
  EXPECT_GE(post("integer((x + 0.1) * 1.1)").outputs[0].absolute, 1e6);
}

TEST(Soundness, DerivativesOfRoundedValuesHaveUnknownError) {
  const auto effect = [](const std::string& of) {
    return proof_of(R"({"isoshade": 1, "effect": "e", "parameters": {}, "nodes": {"p": {"type": "position"},
        "of": {"type": "expression", "code": ")" +
                    of + R"(", "p": "p"}, "d": {"type": "ddx", "in": "of"},
        "c": {"type": "combine3", "in1": "d.x", "to": "color3"}}, "passes": [{"name": "base", "color": "c"}]})");
  };
  EXPECT_GT(effect("(p + vector3(1e6)) - vector3(1e6)").outputs[0].absolute, prove::largest);
}

TEST(Soundness, LightSumsCoverTheMaximumNumberOfLights) {
  const auto effect = [](const std::string& factor) {
    return proof_of(R"({"isoshade": 1, "effect": "e", "parameters": {}, "nodes": {"c": {"type": "lightcolor"},
        "s": {"type": "multiply", "in1": "c", "in2": )" +
                    factor + R"(}, "all": {"type": "sum_lights", "in": "s"}},
        "passes": [{"name": "base", "color": "all"}]})");
  };
  EXPECT_FALSE(effect("1e30").unproved.empty()) << "1e36 each: 1024 of them are more than a float holds";
  EXPECT_TRUE(effect("3e29").unproved.empty());
  EXPECT_GE(effect("1").outputs[0].hi, 1e6 * interface::max_lights);
}

TEST(Soundness, TapSumsCoverTheWrittenTaps) {
  const Proof proof = proof_of(R"({"isoshade": 1, "post": "p", "nodes": {"i": {"type": "tapindex"},
      "c": {"type": "scenecolor", "offsetx": "i"}, "sum": {"type": "sum_taps", "in": "c", "first": -2, "last": 2}},
      "outputs": {"color": "sum"}})");
  EXPECT_GE(proof.outputs[0].hi, 5e6);
  EXPECT_LT(proof.outputs[0].hi, 5.01e6);
}

Proof proof_of_code(const std::string& x, const std::string& code,
                    functions::Tier tier = functions::Tier::standard) {
  return proof_of(R"({"isoshade": 1, "function": "f", "inputs": {"x": {"type": "float", )" + x +
                      R"(}}, "nodes": {"r": {"type": "expression", "code": ")" + code +
                      R"(", "x": "x"}}, "outputs": {"out": "r"}})",
                  tier);
}

TEST(Soundness, BoundsIncludeFlushingToZero) {
  const prove::Bound small = proof_of_code(R"("min": 0, "max": 0.001)", "x * x").outputs[0];
  EXPECT_GE(small.slack, prove::smallest) << "no number of ULP holds for results that become 0";
  EXPECT_GE(small.absolute, prove::smallest);
  const prove::Bound normal = proof_of_code(R"("min": 1, "max": 2)", "x * x").outputs[0];
  EXPECT_EQ(normal.slack, 0);
  EXPECT_LE(normal.relative, 0x1.1p-24);
}

TEST(Soundness, FunctionsOutsideTheirDomainHaveLargerErrors) {
  const auto ulps = [](const std::string& x, const std::string& code) {
    return proof_of_code(x, code, functions::Tier::precise).outputs[0].relative * 0x1p23;
  };
  EXPECT_LT(ulps(R"("min": 0.1, "max": 8)", "pow(0.001, x)"), 1);
  EXPECT_GT(ulps(R"("min": 0.1, "max": 10)", "pow(0.001, x)"), 1.6);
  EXPECT_LT(ulps(R"("min": 0.01, "max": 1)", "srgb_encode(x)"), 1);
  EXPECT_GT(ulps(R"("min": 0.003, "max": 1)", "srgb_encode(x)"), 4);
  const prove::Bound far =
      proof_of_code(R"("min": 1e6, "max": 1e8)", "noise2d(vector2(x, 0.5))").outputs[0];
  EXPECT_GE(far.absolute, far.hi - far.lo) << "nothing is promised of noise so far away";
}

TEST(Soundness, RootsOfPossiblyNegativeValuesHaveUnknownError) {
  // In floats this is not negative; exactly it may be.
  const std::string t = "(x * 0.3 - (x * 0.1 + x * 0.2))";
  const Proof proof = proof_of_code(R"("min": 0, "max": 1)", t + " >= 0 ? sqrt" + t + " : 0");
  ASSERT_TRUE(proof.unproved.empty());
  EXPECT_GT(proof.followed[0].absolute, prove::largest);
}

}  // namespace
}  // namespace isoshade
