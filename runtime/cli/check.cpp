// SPDX-License-Identifier: Apache-2.0
// isoshade check: proves that a document computes finite numbers for all allowed inputs.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "compiler/driver/fixed_settings.h"
#include "compiler/prove/document.h"
#include "compiler/support/parse_number.h"
#include "compiler/support/visible.h"
#include "runtime/cli/session.h"
#include "runtime/scene/output_file.h"

namespace isoshade::cli {

namespace {

constexpr size_t max_json_diagnostics = 10'000;

/// The nearest float that is not less (not more) than the value, so that the printed bound holds.
std::string number_above(double value) {
  auto nearest = static_cast<float>(value);
  if (static_cast<double>(nearest) < value) nearest = std::nextafter(nearest, HUGE_VALF);
  return support::format_float(nearest);
}
std::string number_below(double value) {
  auto nearest = static_cast<float>(value);
  if (static_cast<double>(nearest) > value) nearest = std::nextafter(nearest, -HUGE_VALF);
  return support::format_float(nearest);
}

/// "error at most 1e-06, at most 3.5 ULP and 1.2e-38"
std::string error_text(const prove::Bound& bound) {
  if (bound.absolute > prove::largest) return "error unknown";
  const double ulps = bound.relative * 0x1p24;
  std::string text = "error at most " + number_above(bound.absolute);
  if (!(ulps > 0 && ulps < 1e6)) return text;
  // Results below 2^-126 are flushed to zero; for them only the absolute bound `slack` holds.
  text += ", at most " + support::format_float(static_cast<float>(std::ceil(10 * ulps) / 10)) + " ULP";
  return bound.slack > 0 ? text + " and " + number_above(bound.slack) : text;
}

bool is_weaker(const prove::Bound& a, const prove::Bound& b) {
  return a.absolute > b.absolute || std::min(a.relative, 1.0) > std::min(b.relative, 1.0);
}

void print_bounds(const prove::Tape& tape, const prove::Proof& proof) {
  const auto node = [&](uint32_t operation) {
    return support::quote(tape.places[tape.operations[operation].place].node);
  };
  bool tips = false;
  for (size_t i = 0; i < tape.outputs.size(); ++i) {
    const prove::Bound &bound = proof.outputs[i], &followed = proof.followed[i];
    const bool differs = proof.lost[i] == prove::none && is_weaker(bound, followed);
    std::string error = error_text(followed);
    if (proof.lost[i] != prove::none) error += ", lost at node " + node(proof.lost[i]);
    if (differs) error += "; where rounding tips a branch, " + error_text(bound);
    tips = tips || differs;
    std::printf("  %s in [%s, %s], %s\n", tape.outputs[i].name.c_str(), number_below(bound.lo).c_str(),
                number_above(bound.hi).c_str(), error.c_str());
  }
  std::string nodes;
  std::set<std::string> named;
  for (const uint32_t operation : proof.tipped)
    if (named.insert(node(operation)).second) nodes += (nodes.empty() ? "" : ", ") + node(operation);
  if (tips) std::printf("  branches that rounding may tip: %s\n", nodes.c_str());
}

std::string counted(size_t count, std::string_view what) {
  return count == 0 ? "" : ", " + std::to_string(count) + " " + std::string(what);
}

/// "not proved, 2 refuted, 1 undecided; ..."
std::string summary(const prove::Proof& proof, const prove::NotProved& counts) {
  std::string text =
      "not proved" + counted(counts.refuted, "refuted") + counted(counts.undecided, "undecided");
  text += counted(counts.later, "undecided that depend on these");
  if (proof.unfinished) text += "; the search stopped early, so there may be more";
  if (counts.shown < counts.refuted + counts.undecided)
    text += "; " + std::to_string(counts.shown) + " are shown, --diagnostics json prints all";
  return text;
}

/// The counterexamples as rows of a table for `isoshade eval`.
std::string table_of(const prove::Tape& tape, const prove::Proof& proof) {
  std::string text;
  for (size_t i = 0; i < tape.inputs.size(); ++i) text += (i == 0 ? "" : ",") + tape.inputs[i].name;
  text += "\n";
  for (const prove::Unproved& unproved : proof.unproved) {
    for (size_t i = 0; i < unproved.counterexample.size(); ++i) {
      const uint32_t word = unproved.counterexample[i];
      text += i == 0 ? "" : ",";
      text += tape.inputs[i].scalar == ir::Scalar::floating
                  ? support::format_hex_float(std::bit_cast<float>(word))
                  : std::to_string(static_cast<int32_t>(word));
    }
    text += unproved.counterexample.empty() ? "" : "\n";
  }
  return text;
}

/// The restrictions of --where. Reports a name that no subject has, and returns nothing.
std::optional<std::vector<prove::Restriction>> restrictions(const std::vector<prove::Subject>& subjects,
                                                               const std::vector<NamedRange>& where,
                                                               support::Diagnostics& diagnostics) {
  std::vector<std::string> known;
  for (const prove::Subject& subject : subjects)
    for (std::string& name : prove::sides_of(subject.tape)) known.push_back(std::move(name));
  const std::vector<std::string_view> names(known.begin(), known.end());
  std::vector<prove::Restriction> all;
  for (const NamedRange& range : where) {
    all.push_back({range.name, {static_cast<double>(range.lo), static_cast<double>(range.hi)}});
    if (std::ranges::find(known, range.name) != known.end()) continue;
    const std::string message = "no input, scalar product or clamp is called " + support::quote(range.name);
    diagnostics.report_unknown(support::Id::unknown_setting, {}, message, range.name, names);
    return std::nullopt;
  }
  return all;
}

enum class Result : uint8_t { proved, not_proved, error };

Result check_one(const std::string& path, const CheckArguments& arguments, const Common& common,
                 support::Diagnostics& diagnostics) {
  check::Library library = make_library(common);
  driver::CompileOptions options;
  options.library = &library;
  const support::Source source = graph::read_source(path, diagnostics);
  if (source == nullptr) return Result::error;
  const auto typed = driver::check_document(source, options, diagnostics);
  auto fixed = typed ? driver::fixed_words(*typed, arguments.settings, diagnostics) : std::nullopt;
  if (!fixed) return Result::error;
  if (!arguments.output.empty() && !may_write(arguments.output, diagnostics)) return Result::error;
  const auto subjects =
      prove::subjects_of(*typed, diagnostics, arguments.precision, driver::fixing(*typed, *std::move(fixed)));
  if (!subjects) return Result::error;
  Result result = Result::proved;
  const auto where = restrictions(*subjects, arguments.where, diagnostics);
  if (!where) return Result::error;
  const prove::Effort effort = prove::effort_for(*subjects);
  for (const prove::Subject& subject : *subjects) {
    const prove::Proof proof = prove::prove(subject.tape, effort, *where);
    if (proof.vacuous) {
      diagnostics.report(support::Id::out_of_range, "no input lies within both the ranges of " +
                                                        support::quote(path) + " and those of --where");
      return Result::error;
    }
    const bool proved = proof.unproved.empty();
    const bool is_effect = typed->graph.kind == graph::DocumentKind::effect;
    const bool is_function = typed->graph.kind == graph::DocumentKind::function;
    std::string outcome = "proved";
    if (!proved) {
      result = Result::not_proved;
      const auto detail = common.json ? prove::Detail::all : prove::Detail::brief;
      outcome = summary(proof, prove::report(*typed, subject, proof, diagnostics, detail));
    }
    std::printf("%s%s: %s\n", path.c_str(), is_effect ? (", " + subject.name).c_str() : "", outcome.c_str());
    if (proved && !common.quiet) print_bounds(subject.tape, proof);
    if (proved) continue;
    if (is_function && !arguments.output.empty() &&
        !scene::write_file(arguments.output, table_of(subject.tape, proof), diagnostics))
      return Result::error;
  }
  return result;
}

}  // namespace

int check_documents(const CheckArguments& arguments, const Common& common) {
  support::Diagnostics diagnostics =
      common.json ? make_diagnostics(common, max_json_diagnostics) : make_diagnostics(common);
  int exit = success;
  if (!read_standard_input_once(arguments.documents, diagnostics)) exit = failure;
  if (!arguments.output.empty() && arguments.documents.size() > 1) {
    diagnostics
        .report(support::Id::unwritable_file, support::quote(arguments.output) +
                                                  " would be overwritten by each of the " +
                                                  std::to_string(arguments.documents.size()) + " documents")
        .suggest("check one document at a time with -o");
    exit = failure;
  }
  for (const std::string& document : arguments.documents) {
    if (exit == failure) break;
    switch (check_one(document, arguments, common, diagnostics)) {
      case Result::proved: break;
      case Result::not_proved: exit = different; break;
      case Result::error: exit = failure; break;
    }
  }
  flush(diagnostics, common);
  return exit;
}

}  // namespace isoshade::cli
