// SPDX-License-Identifier: Apache-2.0
#include "runtime/bench/measure.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <span>

#include "backends/interpreter/backend.h"
#include "compiler/ir/printer.h"
#include "runtime/bench/backends.h"
#include "runtime/bench/subject.h"
#include "runtime/render/clock.h"

namespace isoshade::bench {

namespace {

using functions::Tier;
using support::Diagnostics;

/// A subject with its programs, inputs and expected results.
struct Prepared {
  Subject subject;
  std::vector<driver::Program> programs;  ///< by tier
  driver::Program idle;
  std::vector<int32_t> inputs;
  size_t input_words = 0;
  std::vector<reference::Real> exact;
  std::vector<std::vector<int32_t>> expected;  ///< by tier: the results of the interpreter

  std::span<const int32_t> first_inputs(size_t rows) const {
    return std::span(inputs).first(rows * input_words);
  }
};

size_t words_of(const std::vector<driver::Field>& fields) {
  size_t words = 0;
  for (const driver::Field& field : fields) words += static_cast<size_t>(field.words);
  return words;
}

std::optional<Prepared> prepare(const Subject& subject, const BenchOptions& options, check::Library& library,
                                Diagnostics& diagnostics) {
  Prepared made{subject, {}, {}, {}, 0, {}, {}};
  for (const Tier tier : functions::tiers) {
    auto program = compile(subject, tier, library, diagnostics);
    if (!program) return std::nullopt;
    made.programs.push_back(*std::move(program));
  }
  made.idle = idle_program(made.programs[0]);
  made.input_words = words_of(made.programs[0].inputs);
  made.inputs = inputs_of(subject, made.programs[0], std::max(options.rows, options.vulkan_rows));
  auto exact = exact_results(subject, library, made.inputs, options.exact_rows, diagnostics);
  if (!exact) return std::nullopt;
  made.exact = *std::move(exact);
  const auto interpreter = interpreter::create();
  for (const driver::Program& program : made.programs)
    if (!interpreter->evaluate(program, made.first_inputs(options.exact_rows), options.exact_rows,
                               made.expected.emplace_back(), diagnostics))
      return std::nullopt;
  return made;
}

/// What is timed: a program on a device, or that device running the idle program on the same inputs.
struct Race {
  const Prepared* prepared;
  const driver::Program* program;
  const Contestant* contestant;
  std::vector<size_t> points = {};  ///< of all tiers with this program; empty: the idle program
  std::vector<double> samples = {};
};

/// Measures the time of one more row: the difference between a call with all rows and one with an eighth of them.
class Stopwatch {
 public:
  explicit Stopwatch(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  std::optional<double> per_row(const Race& race, size_t rows) {
    if (!seconds(race, rows, all_)) return std::nullopt;  // warms the caches
    const auto few = seconds(race, rows / 8, few_);
    const auto all = seconds(race, rows, all_);
    if (!few || !all) return std::nullopt;
    return (*all - *few) * 1e9 / static_cast<double>(rows - rows / 8);
  }

 private:
  std::optional<double> seconds(const Race& race, size_t rows, std::vector<int32_t>& results) {
    render::Clock clock;
    if (!race.contestant->device->evaluate(*race.program, race.prepared->first_inputs(rows), rows, results,
                                           diagnostics_))
      return std::nullopt;
    return clock.lap();
  }

  Diagnostics& diagnostics_;
  std::vector<int32_t> few_, all_;  ///< members, so that calls do not allocate
};

double quantile(const std::vector<double>& sorted, double q) {
  return sorted[static_cast<size_t>(q * static_cast<double>(sorted.size() - 1) + 0.5)];
}

class Bench {
 public:
  Bench(const BenchOptions& options, Diagnostics& diagnostics)
      : options_(options), diagnostics_(diagnostics), library_(options.library) {}

  std::optional<Report> run() {
    for (const Subject& subject : subjects(options_.graphs, options_.filter)) {
      options_.progress("reference of " + subject.effect + ", " + subject.form);
      auto made = prepare(subject, options_, library_, diagnostics_);
      if (!made) return std::nullopt;
      prepared_.push_back(std::make_unique<Prepared>(*std::move(made)));
    }
    for (const auto& prepared : prepared_)
      if (!prepared->subject.builtins.empty())
        built_ins_[&prepared->programs[static_cast<size_t>(Tier::standard)]] = prepared->subject.builtins;
    devices_ = contestants(options_, built_ins_, diagnostics_);
    if (devices_.empty()) return std::nullopt;
    for (const Contestant& contestant : devices_)
      if (!contestant.built_ins) report_.machines.push_back(contestant.device->description());
    for (const auto& prepared : prepared_)
      if (!enter(*prepared)) return std::nullopt;
    if (!time()) return std::nullopt;
    if (!measure_scenes(options_, devices_, plans_, report_, diagnostics_)) return std::nullopt;
    return std::move(report_);
  }

 private:
  bool enter(const Prepared& prepared) {
    for (const Contestant& contestant : devices_) {
      options_.progress(prepared.subject.effect + ", " + prepared.subject.form + " on " + contestant.backend +
                        " " + contestant.lanes);
      races_.push_back({&prepared, &prepared.idle, &contestant});
      idle_of_[{&prepared, &contestant}] = races_.size() - 1;
      for (const Tier tier : functions::tiers) {
        if (contestant.built_ins && (tier != Tier::standard || prepared.subject.builtins.empty())) continue;
        if (!enter(prepared, contestant, tier)) return false;
      }
    }
    return true;
  }

  bool enter(const Prepared& prepared, const Contestant& contestant, Tier tier) {
    const auto t = static_cast<size_t>(tier);
    Point point{prepared.subject.effect, prepared.subject.form, std::string(functions::tier_name(tier)),
                contestant.backend, contestant.lanes};
    if (contestant.built_ins) point.precision = "built-ins";
    std::vector<int32_t> results;
    const size_t rows = rows_on(contestant);
    if (!contestant.device->evaluate(prepared.programs[t], prepared.first_inputs(rows), rows, results,
                                     diagnostics_))
      return false;
    const auto compared = std::span(results).first(prepared.exact.size());
    point.identical =
        std::ranges::equal(compared, prepared.expected[t]) && same_as_first(prepared, t, results);
    const Errors errors = errors_of(compared, prepared.exact);
    point.max_ulp = errors.max_ulp;
    point.mean_ulp = errors.mean_ulp;
    point.max_absolute = errors.max_absolute;
    race_of(prepared, tier, contestant).points.push_back(report_.points.size());
    report_.points.push_back(std::move(point));
    return true;
  }

  /// Tiers that compile to the same program are timed together.
  Race& race_of(const Prepared& prepared, Tier tier, const Contestant& contestant) {
    const driver::Program& program = prepared.programs[static_cast<size_t>(tier)];
    for (Race& race : races_)
      if (race.prepared == &prepared && race.contestant == &contestant && !race.points.empty() &&
          ir::print(race.program->module) == ir::print(program.module))
        return race;
    return races_.emplace_back(Race{&prepared, &program, &contestant});
  }

  size_t rows_on(const Contestant& contestant) const {
    return contestant.backend == "vulkan" ? options_.vulkan_rows : options_.rows;
  }

  /// Compares the rows that both have with the results of the first device that ran this program.
  bool same_as_first(const Prepared& prepared, size_t tier, const std::vector<int32_t>& results) {
    const auto [found, is_first] = first_results_.try_emplace({&prepared, tier}, results);
    if (is_first) return true;
    const size_t both = std::min(results.size(), found->second.size());
    return std::ranges::equal(std::span(results).first(both), std::span(found->second).first(both));
  }

  bool time() {
    Stopwatch stopwatch(diagnostics_);
    std::mt19937 random;  // shuffles the order, so that no race always follows the same other one
    std::vector<size_t> order(races_.size());
    std::iota(order.begin(), order.end(), size_t{0});
    for (int i = 0; i < options_.repetitions; ++i) {
      options_.progress("timing, " + std::to_string(i + 1) + " of " + std::to_string(options_.repetitions));
      std::shuffle(order.begin(), order.end(), random);
      for (const size_t index : order) {
        Race& race = races_[index];
        const auto sample = stopwatch.per_row(race, rows_on(*race.contestant));
        if (!sample) return false;
        race.samples.push_back(*sample);
      }
    }
    for (Race& race : races_) std::ranges::sort(race.samples);
    for (const Race& race : races_) {
      for (const size_t index : race.points) {
        Point& point = report_.points[index];
        point.transfer =
            std::max(0.0, quantile(races_[idle_of_[{race.prepared, race.contestant}]].samples, 0.5));
        point.nanoseconds = std::max(0.0, quantile(race.samples, 0.5));
        point.spread = quantile(race.samples, 0.75) - quantile(race.samples, 0.25);
      }
    }
    return true;
  }

  const BenchOptions& options_;
  Diagnostics& diagnostics_;
  check::Library library_;
  std::vector<std::unique_ptr<Prepared>> prepared_;
  BuiltIns built_ins_;
  std::deque<render::Plan> plans_;
  std::vector<Contestant> devices_;
  Report report_;
  std::vector<Race> races_;
  std::map<std::pair<const Prepared*, const Contestant*>, size_t> idle_of_;
  std::map<std::pair<const Prepared*, size_t>, std::vector<int32_t>> first_results_;
};

}  // namespace

std::optional<Report> measure(const BenchOptions& options, Diagnostics& diagnostics) {
  return Bench(options, diagnostics).run();
}

bool all_identical(const Report& report) {
  return std::ranges::all_of(
      report.points, [](const Point& point) { return point.identical || point.precision == "built-ins"; });
}

}  // namespace isoshade::bench
