// SPDX-License-Identifier: Apache-2.0
// The bounds that `isoshade check` prints, against what is measured: no value of any shipped graph is out of its range,
// and no error is larger than it is said to be, neither over all inputs nor at one.
#include <filesystem>
#include <gtest/gtest.h>

#include "compiler/prove/document.h"
#include "runtime/lanes/lanes.h"
#include "tests/accuracy/real_tape.h"
#include "tests/accuracy/subject.h"
#include "tests/unit/front_end.h"

namespace isoshade::accuracy {
namespace {

namespace fs = std::filesystem;
using prove::Bound;
using prove::Box;
using prove::Proof;
using prove::Tape;
using reference::Real;

constexpr int points = 400;

/// What is wrong with a bound at some input, and how near the errors come to it.
struct Verdict {
  std::string wrong;   ///< empty: nothing
  double nearest = 0;  ///< the largest measured error as a part of the bound over all inputs
  int compared = 0;
};

class Measurement {
 public:
  explicit Measurement(const Tape& tape)
      : tape_(tape), runner_(tape), exact_(tape, runner_), evaluator_(tape) {}

  /// Of the outputs, over all inputs for which the restrictions hold; without and with following branches.
  Verdict run(const std::vector<Bound>& own, const std::vector<Bound>& followed,
              const std::vector<prove::Restriction>& where = {}, int count = points) {
    for (const std::vector<uint32_t>& inputs : prove::samples(tape_, evaluator_.whole(), count)) {
      for (const bool follow : {false, true}) {
        {
          const lanes::FpGuard guard;
          runner_.run(inputs);
          if (!holds(where, inputs)) continue;
          evaluator_.follow_branches(follow);
          if (!evaluator_.walk(point(inputs))) continue;  // vectors may be off by more than is assumed
        }
        exact_.run(inputs, follow);
        for (size_t o = 0; o < tape_.outputs.size(); ++o) {
          const Bound& all = (follow ? followed : own)[o];
          const double error = compare(o, all, "over all inputs");
          if (all.absolute > 0) verdict_.nearest = std::max(verdict_.nearest, error / all.absolute);
          compare(o, evaluator_.bound(tape_.outputs[o].operation), "at this input");
        }
      }
    }
    return verdict_;
  }

 private:
  bool holds(const std::vector<prove::Restriction>& where, const std::vector<uint32_t>& inputs) const {
    for (const prove::Restriction& r : where) {
      for (size_t s = 0; s < evaluator_.side_count(); ++s) {
        if (evaluator_.side_name(s) != r.name) continue;
        const uint32_t word = s < inputs.size() ? inputs[s] : runner_.word(evaluator_.operation_of(s));
        const auto value = static_cast<double>(std::bit_cast<float>(word));
        if (value < r.range.lo || value > r.range.hi) return false;
      }
    }
    return true;
  }

  Box point(const std::vector<uint32_t>& inputs) const {
    Box box = evaluator_.whole();
    for (size_t i = 0; i < inputs.size(); ++i) {
      const bool is_float = tape_.inputs[i].scalar == ir::Scalar::floating;
      const double value = is_float ? static_cast<double>(std::bit_cast<float>(inputs[i]))
                                    : static_cast<double>(static_cast<int32_t>(inputs[i]));
      box[i] = {value, value};
    }
    return box;
  }

  /// The error that was measured.
  double compare(size_t output, const Bound& bound, const char* where) {
    const uint32_t operation = tape_.outputs[output].operation;
    const auto value = static_cast<double>(std::bit_cast<float>(runner_.word(operation)));
    const Real& exact = exact_.number(operation);
    ++verdict_.compared;
    // A decision is no number: where its operands have errors, it may go either way.
    if (tape_.operations[operation].scalar != ir::Scalar::floating) return 0;
    const auto wrong = [&](const std::string& what) {
      if (verdict_.wrong.empty())
        verdict_.wrong = tape_.outputs[output].name + " " + where + ": " + what + ", computed " +
                         std::to_string(value) + ", exactly " + exact.text(12);
    };
    if (!(value >= bound.lo && value <= bound.hi)) wrong("out of range");
    if (!exact.is_finite()) {
      if (bound.absolute < HUGE_VAL) wrong("no exact value");
      return 0;
    }
    const auto error = static_cast<double>(abs(Real(value) - exact));
    if (error > bound.absolute)
      wrong("off by " + std::to_string(error) + " of " + std::to_string(bound.absolute));
    const auto size = static_cast<double>(abs(exact));
    const auto [relative, slack] = bound.share();
    if (error > relative * size * (1 + 0x1p-50) + slack)
      wrong("off by " + std::to_string(error / size * 0x1p24) + " ULP of " +
            std::to_string(relative * 0x1p24));
    return error;
  }

  const Tape& tape_;
  prove::TapeRunner runner_;
  RealTape exact_;
  prove::Evaluator evaluator_;
  Verdict verdict_;
};

std::vector<std::string> documents() {
  std::vector<std::string> paths;
  for (const char* folder : {"library", "materials", "effects", "source_forms"})
    for (const auto& file : fs::recursive_directory_iterator(fs::path(ISOSHADE_GRAPHS) / folder))
      if (file.path().extension() == ".json") paths.push_back(file.path().string());
  std::ranges::sort(paths);
  return paths;
}

class ShippedGraph : public testing::TestWithParam<std::string> {};

TEST_P(ShippedGraph, MeasuredErrorStaysWithinProvedBound) {
  FrontEnd front_end(ISOSHADE_GRAPHS "/library");
  const auto graph = front_end.check_file(GetParam());
  ASSERT_NE(graph, nullptr) << front_end.diagnostics.text();
  const auto subjects = prove::subjects_of(*graph, front_end.diagnostics);
  ASSERT_TRUE(subjects);
  for (const prove::Subject& subject : *subjects) {
    const Proof proof = prove::prove(subject.tape);
    if (!proof.unproved.empty()) continue;
    const Verdict verdict = Measurement(subject.tape).run(proof.outputs, proof.followed);
    EXPECT_EQ(verdict.wrong, "") << subject.name;
    EXPECT_GT(verdict.compared, points);
  }
}

std::string name_of(const testing::TestParamInfo<std::string>& info) {
  std::string name = fs::relative(info.param, ISOSHADE_GRAPHS).replace_extension().string();
  std::ranges::replace_if(
      name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Graphs, ShippedGraph, testing::ValuesIn(documents()), name_of);

struct Proved {
  prove::Subject subject;
  Proof proof;
};

Proved proved(const std::string& document) {
  FrontEnd front_end(ISOSHADE_GRAPHS "/library");
  auto subjects = prove::subjects_of(*front_end.check_file(graph_path(document)), front_end.diagnostics);
  Proved proved{std::move(subjects->front()), {}};
  proved.proof = prove::prove(proved.subject.tape);
  return proved;
}

TEST(Bound, HoldsInEveryTier) {
  std::vector<double> errors;
  for (const functions::Tier tier : functions::tiers) {
    FrontEnd front_end(ISOSHADE_GRAPHS "/library");
    const auto graph = front_end.check(R"=({"isoshade": 1, "function": "f", "inputs": {
        "x": {"type": "float", "min": 0.01, "max": 10}, "v": {"type": "vector3", "min": -4, "max": 4}}, "nodes": {
        "a": {"type": "expression", "code": "pow(x, 2.4) + exp(-x) * log2(x)", "x": "x"},
        "b": {"type": "expression", "code": "sin(x * 7) * cos(x)", "x": "x"},
        "c": {"type": "expression", "code": "length(v + vector3(5)) * normalize(v + vector3(5))", "v": "v"}},
        "outputs": {"a": "a", "b": "b", "c": "c"}})=");
    ASSERT_NE(graph, nullptr) << front_end.diagnostics.text();
    const auto subjects = prove::subjects_of(*graph, front_end.diagnostics, tier);
    const Proof proof = prove::prove(subjects->front().tape);
    ASSERT_TRUE(proof.unproved.empty()) << functions::tier_name(tier);
    const Verdict verdict = Measurement(subjects->front().tape).run(proof.outputs, proof.followed);
    EXPECT_EQ(verdict.wrong, "") << functions::tier_name(tier);
    EXPECT_GT(verdict.nearest, 0.01) << functions::tier_name(tier);
    errors.push_back(proof.outputs[0].absolute);
  }
  EXPECT_GT(errors[0], 10 * errors[1]);
  EXPECT_GT(errors[1], 1.2 * errors[2]);
}

TEST(Bound, HoldsForRestrictedInputs) {
  const std::vector<prove::Restriction> where = {
      {"n_dot_l", {0.1, 1}}, {"n_dot_v", {0.1, 1}}, {"roughness", {0.1, 1}}, {"h2", {0.1, 4.1}}};
  FrontEnd front_end(ISOSHADE_GRAPHS "/library");
  const auto graph = front_end.check_file(graph_path("library/brdf/cook_torrance"));
  const auto subjects = prove::subjects_of(*graph, front_end.diagnostics);
  const Tape& tape = subjects->front().tape;
  const Proof proof = prove::prove(tape, {}, where);
  for (size_t o = 0; o < 3; ++o) EXPECT_LT(proof.outputs[o].absolute, 1) << "of up to 1000";
  const Verdict verdict = Measurement(tape).run(proof.outputs, proof.followed, where, 5000);
  EXPECT_EQ(verdict.wrong, "");
  EXPECT_GT(verdict.compared, points);
}

// What finds nothing wrong must be able to: a bound of a half of what is measured is refuted.
TEST(Bound, IsRefutedWhenHalved) {
  for (const char* document : {"library/brdf/ggx_d", "library/brdf/schlick_f", "library/tonemap/aces"}) {
    const Proved it = proved(document);
    const Verdict right = Measurement(it.subject.tape).run(it.proof.outputs, it.proof.followed);
    std::vector<Bound> halved = it.proof.outputs;
    for (Bound& bound : halved) bound.absolute *= 0.5 * right.nearest;
    EXPECT_NE(Measurement(it.subject.tape).run(halved, halved).wrong, "") << document;
  }
}

// But for the sign of zeros the same floats as the interpreter's, and the same numbers as the reference backend's: what is compared above is what
// these compute.
TEST(Tape, MatchesInterpreterAndReferenceBackend) {
  for (const char* document :
       {"library/brdf/ggx_d", "library/brdf/cook_torrance", "library/brdf/smith_g_correlated",
        "library/fog/height_density", "library/toon/highlight", "library/tonemap/aces", "library/sky"}) {
    const Proved it = proved(document);
    const Tape& tape = it.subject.tape;
    const Subject subject = Subject::document(document);
    prove::TapeRunner runner(tape);
    RealTape exact(tape, runner);
    for (const std::vector<uint32_t>& inputs :
         prove::samples(tape, prove::Evaluator(tape).whole(), 50)) {
      std::vector<float> row;
      for (const uint32_t word : inputs) row.push_back(std::bit_cast<float>(word));
      const std::vector<float> floats = subject.on_one_backend(row);
      const std::vector<Real> reals = subject.exact(row);
      {
        const lanes::FpGuard guard;
        runner.run(inputs);
      }
      exact.run(inputs, false);
      for (size_t o = 0; o < tape.outputs.size(); ++o) {
        const uint32_t operation = tape.outputs[o].operation;
        EXPECT_EQ(std::bit_cast<float>(runner.word(operation)), floats[o]) << document;
        EXPECT_LE(static_cast<double>(abs(exact.number(operation) - reals[o])),
                  1e-30 * static_cast<double>(abs(reals[o])))
            << document;
      }
    }
  }
}

}  // namespace
}  // namespace isoshade::accuracy
