// SPDX-License-Identifier: Apache-2.0
#include "runtime/bench/measure.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <span>

#include "backends/interpreter/backend.h"
#include "compiler/ir/printer.h"
#include "runtime/bench/backends.h"
#include "runtime/bench/compute.h"
#include "runtime/bench/peers.h"
#include "runtime/bench/ports.h"
#include "runtime/bench/subject.h"
#include "runtime/render/clock.h"

namespace isoshade::bench {

namespace {

using functions::Tier;
using support::Diagnostics;

/// Rows of a compute program whose bits are compared with the interpreter's.
constexpr size_t checked_rows = 16;
/// A compute program evaluates its subject many times a row, so it runs over fewer rows.
constexpr size_t rows_divisor = 8;

/// A subject with its programs, inputs and expected results.
struct Prepared {
  Subject subject;
  std::vector<driver::Program> programs;  ///< by tier
  driver::Program idle;
  std::vector<driver::Program> compute;  ///< by tier
  driver::Program making;
  std::string function = {};  ///< the name of the subject's function in the programs
  std::vector<int32_t> inputs = {};
  size_t input_words = 0;
  std::vector<reference::Real> exact = {};
  std::vector<std::vector<int32_t>> expected = {}, expected_compute = {};  ///< by tier: the results of the interpreter

  std::span<const int32_t> first_inputs(size_t rows) const {
    return std::span(inputs).first(rows * input_words);
  }
};

size_t words_of(const std::vector<driver::Field>& fields) {
  size_t words = 0;
  for (const driver::Field& field : fields) words += static_cast<size_t>(field.words);
  return words;
}

std::vector<int32_t> row_numbers(size_t rows) {
  std::vector<int32_t> numbers(rows);
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

std::optional<Prepared> prepare(const Subject& subject, const BenchOptions& options, check::Library& library,
                                Diagnostics& diagnostics) {
  const auto base = lowered(subject, library, diagnostics);
  if (!base) return std::nullopt;
  Prepared made{subject, {}, {}, {}, {}};
  made.function = base->module.functions[base->function].name;
  for (const Tier tier : functions::tiers) {
    auto program = compile(subject, tier, library, diagnostics);
    if (!program) return std::nullopt;
    made.programs.push_back(*std::move(program));
    made.compute.push_back(compute_program(subject, made.programs[0].inputs, base->module, base->function, tier));
  }
  made.idle = idle_program(made.programs[0]);
  made.making = making_program(subject, made.programs[0].inputs);
  made.input_words = words_of(made.programs[0].inputs);
  made.inputs = inputs_of(subject, made.programs[0], std::max(options.rows, options.vulkan_rows));
  auto exact = exact_results(subject, library, made.inputs, options.exact_rows, diagnostics);
  if (!exact) return std::nullopt;
  made.exact = *std::move(exact);
  const auto interpreter = interpreter::create();
  const std::vector<int32_t> numbers = row_numbers(checked_rows);
  for (size_t t = 0; t < made.programs.size(); ++t)
    if (!interpreter->evaluate(made.programs[t], made.first_inputs(options.exact_rows), options.exact_rows,
                               made.expected.emplace_back(), diagnostics) ||
        !interpreter->evaluate(made.compute[t], numbers, checked_rows, made.expected_compute.emplace_back(), diagnostics))
      return std::nullopt;
  return made;
}

/// Runs a program over a table.
using Run = std::function<bool(std::span<const int32_t> inputs, size_t rows, std::vector<int32_t>& results)>;

/// What is timed: a program on a device.
struct Race {
  Run run;
  std::span<const int32_t> inputs;
  size_t rows;
  double evaluated;  ///< in a row
  std::vector<double> samples = {};
};

/// The races of the points that have the same machine code.
struct Timing {
  std::vector<size_t> points;
  size_t table, idle, compute, making;
  std::optional<PortBound> ports = {};
};

/// Measures the time of one more evaluation: the difference between a call with all rows and one with an eighth of them.
class Stopwatch {
 public:
  std::optional<double> per_evaluation(const Race& race) {
    const auto all = seconds(race, race.rows, all_);
    const auto few = seconds(race, race.rows / 8, few_);
    if (!few || !all) return std::nullopt;
    return (*all - *few) * 1e9 / (static_cast<double>(race.rows - race.rows / 8) * race.evaluated);
  }

 private:
  /// The shortest of a few calls: the first one fills the caches, and others may be interrupted.
  static std::optional<double> seconds(const Race& race, size_t rows, std::vector<int32_t>& results) {
    constexpr int calls = 3;
    const size_t words = race.inputs.size() / race.rows;
    double shortest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < calls; ++i) {
      render::Clock clock;
      if (!race.run(race.inputs.first(rows * words), rows, results)) return std::nullopt;
      shortest = std::min(shortest, clock.lap());
    }
    return shortest;
  }

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
        for (const auto* programs : {&prepared->programs, &prepared->compute})
          built_ins_[&(*programs)[static_cast<size_t>(Tier::standard)]] = prepared->subject.builtins;
    devices_ = contestants(options_, built_ins_, diagnostics_);
    if (devices_.empty()) return std::nullopt;
    for (const Contestant& contestant : devices_)
      if (!contestant.built_ins) report_.machines.push_back(contestant.device->description());
    numbers_ = row_numbers(std::max(options_.rows, options_.vulkan_rows) / rows_divisor);
    ports_ = PortAnalyser::find(options_.compiler, options_.build_timeout);
    if (!ports_) note("no port bound: there is no llvm-mca (Debian: package llvm)");
    for (const auto& prepared : prepared_)
      if (!enter(*prepared)) return std::nullopt;
    if (!time()) return std::nullopt;
    if (!measure_scenes(options_, devices_, plans_, report_, diagnostics_)) return std::nullopt;
    return std::move(report_);
  }

 private:
  void note(const std::string& text) {
    if (std::ranges::find(report_.notes, text) == report_.notes.end()) report_.notes.push_back(text);
  }

  bool enter(const Prepared& prepared) {
    for (const Contestant& contestant : devices_) {
      options_.progress(prepared.subject.effect + ", " + prepared.subject.form + " on " + contestant.backend +
                        " " + contestant.lanes);
      const size_t idle = add_table(run_of(contestant, prepared.idle), prepared, contestant);
      const size_t making = add_loop(run_of(contestant, prepared.making), contestant);
      std::map<std::string, size_t> timing_of;  // tiers that compile to the same program are timed together
      for (const Tier tier : functions::tiers) {
        if (contestant.built_ins && (tier != Tier::standard || prepared.subject.builtins.empty())) continue;
        const auto t = static_cast<size_t>(tier);
        const auto [found, is_new] =
            timing_of.try_emplace(ir::print(prepared.programs[t].module), timings_.size());
        if (is_new)
          timings_.push_back({{},
                              add_table(run_of(contestant, prepared.programs[t]), prepared, contestant),
                              idle,
                              add_loop(run_of(contestant, prepared.compute[t]), contestant),
                              making});
        Timing& timing = timings_[found->second];
        if (is_new && ports_ && contestant.lanes == widest_cpu())
          timing.ports = ports_->analyse(driver::cpp(prepared.compute[t]), *cpu::lane_count(contestant.lanes));
        if (!enter(prepared, contestant, tier, timing)) return false;
      }
    }
    if (options_.peers)
      for (const PeerKind kind : {PeerKind::glm, PeerKind::spirv_cross})
        if (has_peer(kind, prepared.subject)) enter_peer(prepared, kind);
    return true;
  }

  bool enter(const Prepared& prepared, const Contestant& contestant, Tier tier, Timing& timing) {
    const auto t = static_cast<size_t>(tier);
    Point point{prepared.subject.effect, prepared.subject.form, std::string(functions::tier_name(tier)),
                contestant.backend, contestant.lanes};
    if (contestant.built_ins) point.precision = "built-ins";
    std::vector<int32_t> results, folded;
    const Race &table = races_[timing.table], &compute = races_[timing.compute];
    if (!table.run(table.inputs, table.rows, results) || !compute.run(compute.inputs, compute.rows, folded)) return false;
    const auto compared = std::span(results).first(prepared.exact.size());
    point.identical = std::ranges::equal(compared, prepared.expected[t]) &&
                      std::ranges::equal(std::span(folded).first(checked_rows), prepared.expected_compute[t]) &&
                      same_as_first(first_results_, prepared, t, results) &&
                      same_as_first(first_folded_, prepared, t, folded);
    add_errors(point, compared, prepared);
    timing.points.push_back(report_.points.size());
    report_.points.push_back(std::move(point));
    return true;
  }

  /// A peer that is missing is noted.
  void enter_peer(const Prepared& prepared, PeerKind kind) {
    constexpr auto standard = static_cast<size_t>(Tier::standard);
    const Subject& subject = prepared.subject;
    options_.progress(subject.effect + " by " + name(kind));
    const driver::Program* const programs[] = {&prepared.programs[standard], &prepared.compute[standard]};
    Run runs[2];
    for (size_t i = 0; i < 2; ++i) {
      std::string why;
      std::shared_ptr<PeerProgram> made = PeerProgram::make(kind, subject, *programs[i], *programs[0], prepared.function,
                                                            options_.compiler, options_.build_timeout, why);
      if (!made) return note(std::string("no ") + name(kind) + " of " + subject.effect + ": " + why);
      runs[i] = [made](std::span<const int32_t> inputs, size_t rows, std::vector<int32_t>& results) {
        made->run(inputs, rows, results);
        return true;
      };
    }
    // What is not the peer's is that of the cpu with one lane, where that is measured.
    const auto scalar = std::ranges::find_if(devices_, [](const Contestant& c) { return c.lanes == "1"; });
    if (scalar == devices_.end()) return note(std::string("no ") + name(kind) + ": it needs --lanes 1, with which it is compared");
    Timing timing{{report_.points.size()},
                  add_table(runs[0], prepared, *scalar),
                  add_table(run_of(*scalar, prepared.idle), prepared, *scalar),
                  add_loop(runs[1], *scalar),
                  add_loop(run_of(*scalar, prepared.making), *scalar)};
    Point point{subject.effect, subject.form, "peer", name(kind), "1"};
    std::vector<int32_t> results;
    runs[0](prepared.first_inputs(options_.exact_rows), options_.exact_rows, results);
    point.identical = std::ranges::equal(results, prepared.expected[standard]);
    add_errors(point, results, prepared);
    report_.points.push_back(std::move(point));
    timings_.push_back(std::move(timing));
  }

  static void add_errors(Point& point, std::span<const int32_t> results, const Prepared& prepared) {
    const Errors errors = errors_of(results, prepared.exact);
    point.max_ulp = errors.max_ulp;
    point.mean_ulp = errors.mean_ulp;
    point.max_absolute = errors.max_absolute;
  }

  /// The lanes of the last contestant of the cpu, which are the fastest.
  std::string widest_cpu() const {
    std::string lanes;
    for (const Contestant& contestant : devices_)
      if (contestant.backend == "cpu") lanes = contestant.lanes;
    return lanes;
  }

  Run run_of(const Contestant& contestant, const driver::Program& program) {
    return [this, &contestant, &program](std::span<const int32_t> inputs, size_t rows, std::vector<int32_t>& results) {
      return contestant.device->evaluate(program, inputs, rows, results, diagnostics_);
    };
  }

  size_t rows_on(const Contestant& contestant) const {
    return contestant.backend == "vulkan" ? options_.vulkan_rows : options_.rows;
  }

  size_t add_race(Run run, std::span<const int32_t> inputs, size_t input_words, int evaluated) {
    races_.push_back({std::move(run), inputs, inputs.size() / input_words, static_cast<double>(evaluated)});
    return races_.size() - 1;
  }
  /// Of a program with the inputs and results of the subject, and of one that makes its inputs.
  size_t add_table(Run run, const Prepared& prepared, const Contestant& contestant) {
    return add_race(std::move(run), prepared.first_inputs(rows_on(contestant)), prepared.input_words, 1);
  }
  size_t add_loop(Run run, const Contestant& contestant) {
    return add_race(std::move(run), std::span(numbers_).first(rows_on(contestant) / rows_divisor), 1, evaluations);
  }

  /// Compares the rows that both have with the results of the first device that ran this program.
  using FirstResults = std::map<std::pair<const Prepared*, size_t>, std::vector<int32_t>>;
  static bool same_as_first(FirstResults& first, const Prepared& prepared, size_t tier,
                            const std::vector<int32_t>& results) {
    const auto [found, is_first] = first.try_emplace({&prepared, tier}, results);
    if (is_first) return true;
    const size_t both = std::min(results.size(), found->second.size());
    return std::ranges::equal(std::span(results).first(both), std::span(found->second).first(both));
  }

  bool time() {
    Stopwatch stopwatch;
    std::mt19937 random;  // shuffles the order, so that no race always follows the same other one
    std::vector<size_t> order(races_.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::vector<double> clocks;
    for (int i = 0; i < options_.repetitions; ++i) {
      options_.progress("timing, " + std::to_string(i + 1) + " of " + std::to_string(options_.repetitions));
      std::shuffle(order.begin(), order.end(), random);
      for (const size_t index : order) {
        const auto sample = stopwatch.per_evaluation(races_[index]);
        if (!sample) return false;
        races_[index].samples.push_back(*sample);
      }
      clocks.push_back(clock_frequency());
    }
    std::ranges::sort(clocks);
    if (!clocks.empty()) report_.gigahertz = quantile(clocks, 0.5);
    for (const Timing& timing : timings_)
      for (const size_t point : timing.points) fill(report_.points[point], timing);
    return true;
  }

  void fill(Point& point, const Timing& timing) const {
    const auto samples_of = [&](size_t race) { return races_[race].samples; };
    std::vector<double> table = samples_of(timing.table), idle = samples_of(timing.idle),
                        evaluation = samples_of(timing.compute), making = samples_of(timing.making), differences;
    for (size_t i = 0; i < evaluation.size(); ++i) differences.push_back(evaluation[i] - making[i]);
    for (auto* samples : {&table, &idle, &evaluation, &making, &differences}) std::ranges::sort(*samples);
    const auto median = [](const std::vector<double>& sorted) { return std::max(0.0, quantile(sorted, 0.5)); };
    const auto range = [](const std::vector<double>& sorted) { return quantile(sorted, 0.75) - quantile(sorted, 0.25); };
    point.nanoseconds = median(table);
    point.spread = range(table);
    point.transfer = median(idle);
    point.compute = median(differences);
    point.compute_spread = range(differences);
    point.evaluation = median(evaluation);
    point.making = median(making);
    if (!timing.ports) return;
    point.cycles = point.evaluation * report_.gigahertz;
    point.port_cycles = timing.ports->cycles;
    point.simulated_cycles = timing.ports->simulated;
    point.spills = timing.ports->spills;
    point.busiest = timing.ports->resource;
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
  std::vector<Timing> timings_;
  std::vector<int32_t> numbers_;  ///< of rows: the inputs of compute programs
  std::unique_ptr<PortAnalyser> ports_;
  FirstResults first_results_, first_folded_;
};

}  // namespace

std::optional<Report> measure(const BenchOptions& options, Diagnostics& diagnostics) {
  return Bench(options, diagnostics).run();
}

bool all_identical(const Report& report) {
  return std::ranges::all_of(report.points,
                             [](const Point& point) { return point.identical || is_foreign(point.precision); });
}

}  // namespace isoshade::bench
