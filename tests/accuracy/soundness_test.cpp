// SPDX-License-Identifier: Apache-2.0
// Documents made at random, of every node: where `check` proves one, no row of hundreds gives a number that is not finite,
// lies out of its range, or errs by more than its bound, against 57 digits.
//
// With ISOSHADE_FULL set there are 20,000; ISOSHADE_SEEDS=first,last runs some alone, ISOSHADE_SHOW=1 prints them.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <random>

#include "compiler/prove/document.h"
#include "compiler/lower/lower.h"
#include "runtime/lanes/lanes.h"
#include "tests/accuracy/document_runs.h"
#include "tests/accuracy/random_graph.h"
#include "tests/accuracy/real_tape.h"
#include "tests/unit/front_end.h"

namespace isoshade::accuracy {
namespace {

using prove::Bound;
using prove::Box;
using prove::Proof;
using prove::Side;
using prove::Tape;
using reference::Real;

constexpr size_t normal_count = 500, full_count = 20'000;
constexpr int normal_rows = 200, full_rows = 300;
/// Small documents need little; what this does not prove is not looked at.
constexpr prove::Effort effort{.proof = 40'000, .error = 20'000, .tries = 20};

std::string decimal(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

/// What the bound says that is not so; empty: nothing.
std::string lie(const Bound& bound, double value, const Real& exact, bool is_float = true) {
  if (!(value >= bound.lo && value <= bound.hi))
    return decimal(value) + " is not in [" + decimal(bound.lo) + ", " + decimal(bound.hi) + "]";
  const std::string both = ": computed " + decimal(value) + ", exactly " + exact.text(12);
  if (!exact.is_finite()) return bound.absolute < HUGE_VAL ? "no exact value" + both : "";
  const Real error = abs(Real(value) - exact);
  if (error > Real(bound.absolute))
    return "errs by " + error.text(6) + ", not at most " + decimal(bound.absolute) + both;
  if (is_float && std::isfinite(bound.relative) && std::isfinite(bound.slack) &&
      error > Real(bound.relative) * abs(exact) + Real(bound.slack))
    return "errs by " + error.text(6) + ", not at most " + decimal(bound.relative) + " of it and " +
           decimal(bound.slack) + both;
  return "";
}

/// Rows of inputs: those of the prover, and numbers of special structure.
class Rows {
 public:
  Rows(const Tape& tape, uint64_t seed, int count) : tape_(tape), random_(seed) {
    rows_ = prove::samples(tape, prove::Evaluator(tape).whole(), count);
    for (size_t r = 0; r < rows_.size(); ++r)
      for (size_t i = 0; i < rows_[r].size(); ++i)
        if (tape.inputs[i].vector == prove::none && r % 3 != 0) rows_[r][i] = word(rows_[r], i);
  }
  const std::vector<std::vector<uint32_t>>& rows() const { return rows_; }

 private:
  double unit() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  uint32_t word(const std::vector<uint32_t>& row, size_t i);

  const Tape& tape_;
  std::mt19937_64 random_;
  std::vector<std::vector<uint32_t>> rows_;
};

uint32_t Rows::word(const std::vector<uint32_t>& row, size_t i) {
  const prove::Input& input = tape_.inputs[i];
  if (input.scalar != ir::Scalar::floating) {
    if (random_() % 3 != 0) return row[i];
    const double value =
        random_() % 2 == 0 ? input.lo : std::min(input.hi, input.lo + static_cast<double>(random_() % 4));
    return static_cast<uint32_t>(static_cast<int64_t>(value));
  }
  const double lo = input.lo, hi = input.hi;
  double value = 0;
  switch (random_() % 8) {
    case 0: value = std::round(lo + (hi - lo) * unit()) + (random_() % 2 == 0 ? 0 : 0.5); break;
    case 1: value = std::exp2(std::round(254 * unit() - 127)) * (random_() % 2 == 0 ? 1 : -1); break;
    case 2: value = std::exp2(std::round(12 * unit() - 6)) * (random_() % 2 == 0 ? 1 : -1); break;
    case 3: {
      const size_t other = random_() % (i + 1);
      const bool is_float = tape_.inputs[other].scalar == ir::Scalar::floating;
      value = is_float && other != i ? static_cast<double>(std::bit_cast<float>(row[other])) : 1.0;
      break;
    }
    case 4: value = random_() % 2 == 0 ? lo : hi; break;
    case 5: value = lo > 0 ? lo * std::pow(hi / lo, unit()) : hi * std::exp2(-140 * unit()); break;
    case 6: value = std::round(8 * unit() - 4) * 0.25; break;
    default: value = lo + (hi - lo) * unit(); break;
  }
  auto rounded = static_cast<float>(std::clamp(value, lo, hi));
  const uint64_t step = random_() % 4;
  if (step == 0) rounded = std::nextafter(rounded, 3e38f);
  if (step == 1) rounded = std::nextafter(rounded, -3e38f);
  rounded = std::clamp(rounded, static_cast<float>(lo), static_cast<float>(hi));
  return std::abs(rounded) < 0x1p-126f ? std::bit_cast<uint32_t>(rounded) & 0x80000000u
                                       : std::bit_cast<uint32_t>(rounded);
}

struct Count {
  size_t documents = 0, invalid = 0, proved = 0, rows = 0, bounds = 0, lies = 0;
};

class Examination {
 public:
  Examination(const check::TypedGraph& graph, const prove::Subject& subject, const Proof& proof,
              uint64_t seed)
      : tape_(subject.tape),
        proof_(proof),
        bindings_(subject.interface.bindings),
        runs_(subject.tape.module, lower::lower(graph).module, subject.interface),
        runner_(tape_),
        exact_tape_(tape_, runner_),
        evaluator_(tape_),
        random_(seed) {
    const bool is_function = graph.graph.kind == graph::DocumentKind::function;
    alone_ = is_function;
    for (const prove::Operation& o : tape_.operations)
      if (o.kind == prove::Kind::sum || o.kind == prove::Kind::unknown) alone_ = false;
    for (const ir::Parameter& p : runs_.parameters()) parameter_words_ += p.type.width;
  }

  std::string run(int count, Count& counted) {
    const Rows rows(tape_, random_(), count);
    for (std::vector<uint32_t> row : rows.rows()) {
      tidy(row);
      const std::span<const uint32_t> arguments(row.data(), parameter_words_);
      {
        const lanes::FpGuard guard;
        if (!runs_.run_floats(arguments)) continue;
      }
      runs_.run_exact(arguments);
      ++counted.rows;
      std::string wrong = whole(counted);
      if (wrong.empty()) wrong = boxes(row, counted);
      if (wrong.empty() && alone_) wrong = tape(row, counted);
      if (wrong.empty()) continue;
      for (size_t i = 0; i < parameter_words_; ++i)
        wrong +=
            (i == 0 ? "\n  where " : ", ") + tape_.inputs[i].name + " = " +
            (tape_.inputs[i].scalar == ir::Scalar::floating ? decimal(std::bit_cast<float>(row[i]))
                                                            : std::to_string(static_cast<int32_t>(row[i])));
      return wrong;
    }
    return "";
  }

 private:
  /// Numbers of textures and lights that there are, and a camera as there are.
  void tidy(std::vector<uint32_t>& row) {
    size_t next = 0;
    const bool perspective = random_() % 2 == 0;
    const auto set = [&](float first, float second) {
      row[next] = std::bit_cast<uint32_t>(first);
      row[next + 1] = std::bit_cast<uint32_t>(second);
    };
    namespace source = interface::source;
    for (const interface::Binding& binding : bindings_) {
      if (std::holds_alternative<source::Image>(binding.source))
        row[next] = static_cast<uint32_t>(static_cast<int>(random_() % (Surroundings::textures + 1)) - 1);
      if (const auto* screen = std::get_if<source::ScreenValue>(&binding.source)) {
        if (screen->value == interface::Screen::depth_numerator)
          set(perspective ? 0.1f : 1000, perspective ? 0 : -999.9f);
        if (screen->value == interface::Screen::depth_denominator)
          set(perspective ? 0 : 1, perspective ? 1 : 0);
      }
      if (std::holds_alternative<source::LightCount>(binding.source) && random_() % 16 != 0)
        row[next] = static_cast<uint32_t>(random_() % 5);
      next += binding.parameter.type.width;
    }
  }

  double computed(size_t output) const {
    const prove::Operation& o = tape_.operations[tape_.outputs[output].operation];
    const uint32_t word = runs_.floats()[output];
    return o.scalar == ir::Scalar::floating ? static_cast<double>(std::bit_cast<float>(word))
                                            : static_cast<double>(static_cast<int32_t>(word));
  }
  Real exact(size_t output) const {
    const prove::Operation& o = tape_.operations[tape_.outputs[output].operation];
    const reference::Cell& cell = runs_.exact()[output];
    return o.scalar == ir::Scalar::floating ? cell.number : Real(static_cast<int32_t>(cell.word));
  }
  std::string compare(const Bound& bound, size_t output, const char* where, Count& counted) {
    ++counted.bounds;
    const auto scalar = tape_.operations[tape_.outputs[output].operation].scalar;
    const std::string wrong = lie(bound, computed(output), exact(output), scalar == ir::Scalar::floating);
    return wrong.empty() ? "" : tape_.outputs[output].name + " " + where + ": " + wrong;
  }

  std::string whole(Count& counted) {
    for (size_t o = 0; o < tape_.outputs.size(); ++o)
      if (std::string wrong = compare(proof_.outputs[o], o, "over all inputs", counted); !wrong.empty())
        return wrong;
    return "";
  }

  /// The row alone, and boxes of any size around it.
  std::string boxes(const std::vector<uint32_t>& row, Count& counted) {
    for (const bool alone : {true, false}) {
      Box box = evaluator_.whole();
      for (size_t i = 0; i < parameter_words_; ++i) {
        const bool is_float = tape_.inputs[i].scalar == ir::Scalar::floating;
        const double at = is_float ? static_cast<double>(std::bit_cast<float>(row[i]))
                                   : static_cast<double>(static_cast<int32_t>(row[i]));
        const bool is_count =
            tape_.inputs[i].name == "light_count" || tape_.inputs[i].name.starts_with("images.");
        if (is_count || (!alone && random_() % 3 == 0)) continue;
        Side& side = box[i];
        if (alone) {
          side = {at, at};
        } else if (is_float) {
          const double below = (at - side.lo) * std::exp2(-40 * unit()),
                       above = (side.hi - at) * std::exp2(-40 * unit());
          side = {std::max(side.lo, prove::rounded(at - below)),
                  std::min(side.hi, prove::rounded(at + above))};
          side = {std::min(side.lo, at), std::max(side.hi, at)};
        }
      }
      const lanes::FpGuard guard;
      evaluator_.follow_branches(false);
      if (!evaluator_.walk(box) || !evaluator_.findings().empty())
        continue;  // vectors may be off by more than is assumed
      for (size_t o = 0; o < tape_.outputs.size(); ++o) {
        const Bound& bound = evaluator_.bound(tape_.outputs[o].operation);
        if (std::string wrong = compare(bound, o, alone ? "at this row" : "in a box", counted);
            !wrong.empty())
          return wrong;
      }
    }
    return "";
  }

  /// Where nothing is asked of a host, the tape runs alone: every operation that is looked at is finite, the outputs are
  /// what the interpreter computes, and errors hold that follow branches.
  std::string tape(const std::vector<uint32_t>& row, Count& counted) {
    {
      const lanes::FpGuard guard;
      for (const prove::TapeRunner::Broken& broken : runner_.run(row))
        return tape_.places[tape_.operations[broken.operation].place].node + ": " +
               std::string(words(broken.breach));
    }
    exact_tape_.run(row, true);
    for (size_t o = 0; o < tape_.outputs.size(); ++o) {
      const uint32_t operation = tape_.outputs[o].operation;
      const uint32_t word = runner_.word(operation);
      const bool is_float = tape_.operations[operation].scalar == ir::Scalar::floating;
      if (word != runs_.floats()[o] &&
          (!is_float || std::bit_cast<float>(word) != std::bit_cast<float>(runs_.floats()[o])))
        return tape_.outputs[o].name + ": the tape computes another number than the interpreter";
      if (!is_float) continue;
      ++counted.bounds;
      const std::string wrong = lie(proof_.followed[o], computed(o), exact_tape_.number(operation));
      if (!wrong.empty()) return tape_.outputs[o].name + " following branches: " + wrong;
    }
    return "";
  }

  double unit() { return static_cast<double>(random_() >> 11) * 0x1p-53; }

  const Tape& tape_;
  const Proof& proof_;
  const std::vector<interface::Binding>& bindings_;
  DocumentRuns runs_;
  prove::TapeRunner runner_;
  RealTape exact_tape_;
  prove::Evaluator evaluator_;
  std::mt19937_64 random_;
  bool alone_ = false;
  size_t parameter_words_ = 0;
};

/// What is wrong with the document of a seed; empty: nothing. `part`: of the errors that are proved.
std::string examine(uint64_t seed, functions::Tier tier, int rows, Count& counted, double part = 1) {
  const std::string text = random_document(seed, ISOSHADE_GRAPHS "/library");
  static const bool show = std::getenv("ISOSHADE_SHOW") != nullptr;
  if (show) std::printf("seed %lu: %s", static_cast<unsigned long>(seed), text.c_str());
  FrontEnd front_end(ISOSHADE_GRAPHS "/library");
  ++counted.documents;
  const auto graph = front_end.check(text);
  if (graph == nullptr) {
    ++counted.invalid;
    if (show) std::printf("%s\n", front_end.diagnostics.text().c_str());
    return "";
  }
  const auto subjects = prove::subjects_of(*graph, front_end.diagnostics, tier);
  if (!subjects) return "no tape";
  const prove::Subject& subject = subjects->front();
  Proof proof = prove::prove(subject.tape, effort);
  if (!proof.unproved.empty() || proof.vacuous) return "";
  ++counted.proved;
  for (std::vector<Bound>* const bounds : {&proof.outputs, &proof.followed})
    for (Bound& bound : *bounds) bound.absolute *= part;
  const std::string wrong = Examination(*graph, subject, proof, seed).run(rows, counted);
  return wrong.empty() ? ""
                       : "seed " + std::to_string(seed) + ", " + std::string(functions::tier_name(tier)) +
                             ": " + wrong + "\n" + text;
}

TEST(RandomDocuments, SatisfyTheirProofs) {
  const bool full = std::getenv("ISOSHADE_FULL") != nullptr;
  uint64_t first = 0, last = ~0ull;
  if (const char* given = std::getenv("ISOSHADE_SEEDS")) std::sscanf(given, "%lu,%lu", &first, &last);
  const size_t wanted = full ? full_count : normal_count;
  Count counted;
  for (uint64_t seed = first; seed < last && counted.proved < wanted; ++seed) {
    const functions::Tier tier = functions::tiers[seed / 4 % functions::tiers.size()];
    const std::string wrong = examine(seed, tier, full ? full_rows : normal_rows, counted);
    if (wrong.empty()) continue;
    ++counted.lies;
    ADD_FAILURE() << wrong;
  }
  std::printf("    %zu documents, %zu of them invalid, %zu proved; %zu rows, %zu bounds, %zu broken\n",
              counted.documents, counted.invalid, counted.proved, counted.rows, counted.bounds, counted.lies);
  EXPECT_LT(counted.invalid * 20, counted.documents);
}

// What finds nothing wrong must be able to: of bounds that are half as large many are refuted.
TEST(RandomDocuments, RefuteHalvedBounds) {
  Count counted;
  for (uint64_t seed = 0; seed < 100; ++seed)
    if (!examine(seed, functions::Tier::standard, normal_rows, counted, 0.5).empty()) ++counted.lies;
  std::printf("    %zu of %zu\n", counted.lies, counted.proved);
  EXPECT_GE(counted.lies, 5u);
}

}  // namespace
}  // namespace isoshade::accuracy
