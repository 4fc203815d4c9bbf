// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <unordered_map>

#include "compiler/prove/document.h"
#include "compiler/support/parse_number.h"
#include "compiler/support/visible.h"
#include "runtime/lanes/lanes.h"

namespace isoshade::prove {
namespace {

using check::TypedGraph;
using support::quote;

constexpr size_t most_shown = 20;  ///< of what is not proved of a subject
constexpr size_t most_named = 12;  ///< numbers in a note

/// The documents that a subject uses, by path.
class Documents {
 public:
  Documents(const TypedGraph& graph, const Subject& subject) : graph_(graph), subject_(subject) {
    add(graph);
  }

  struct Found {
    const TypedGraph* graph = nullptr;
    uint32_t node = none;
    support::Span span;
    std::string name() const { return node == none ? "" : graph->graph.nodes[node].id; }
  };
  Found find(const IrPlace& place) const {
    const auto document = by_path_.find(place.document);
    const TypedGraph& graph = document == by_path_.end() ? graph_ : *document->second;
    const bool known =
        place.function < subject_.nodes.size() && place.origin < subject_.nodes[place.function].size();
    const uint32_t node = known ? subject_.nodes[place.function][place.origin] : none;
    if (node == none) return {&graph, none, graph.graph.span(graph.graph.name_place)};
    return {&graph, node, graph.graph.span(graph.graph.nodes[node].id_place)};
  }

 private:
  void add(const TypedGraph& graph) {
    if (!by_path_.emplace(graph.document, &graph).second) return;
    for (const check::Node& node : graph.nodes)
      if (node.callee != nullptr) add(*node.callee);
  }

  const TypedGraph& graph_;
  const Subject& subject_;
  std::unordered_map<std::string, const TypedGraph*> by_path_;
};

/// The port of the node in whose value a breach shows, as far as the node has one of that name; or "".
std::string port_of(const Documents::Found& found, Breach breach) {
  std::string_view wanted;
  switch (breach) {
    case Breach::division_by_zero: wanted = "in2"; break;
    case Breach::power: wanted = "in1"; break;
    case Breach::root_of_negative:
    case Breach::logarithm:
    case Breach::arc:
    case Breach::conversion: wanted = "in"; break;
    case Breach::none:
    case Breach::overflow:
    case Breach::domain:
    case Breach::unknown: return "";
  }
  if (found.node == none || found.graph->nodes[found.node].row == nullptr) return "";
  // An expression has operands and no ports.
  if (found.graph->graph.nodes[found.node].origin != graph::Node::Origin::node) return "";
  const std::vector<nodes::Port>& ports = found.graph->nodes[found.node].row->ports;
  const bool exists = std::ranges::find(ports, wanted, &nodes::Port::name) != ports.end();
  return exists ? std::string(wanted) : "";
}

/// The inputs that an operation depends on.
std::vector<bool> inputs_of(const Tape& tape, uint32_t operation) {
  std::vector<bool> needed(operation + 1), inputs(tape.inputs.size());
  needed[operation] = true;
  for (uint32_t i = operation + 1; i-- > 0;) {
    if (!needed[i]) continue;
    const Operation& o = tape.operations[i];
    if (o.kind == Kind::input) inputs[o.index] = true;
    for (const uint32_t operand : tape.operands_of(o)) needed[operand] = true;
    for (uint32_t guard = o.guard; guard != 0; guard = tape.guards[guard].parent)
      if (tape.guards[guard].condition < i) needed[tape.guards[guard].condition] = true;
  }
  return inputs;
}

std::string number(ir::Scalar scalar, uint32_t word) {
  if (scalar != ir::Scalar::floating) return std::to_string(static_cast<int32_t>(word));
  return support::format_float(std::bit_cast<float>(word));
}

/// One operation of a node, or several that look the same to an author: components, or those of a function's calls.
struct Entry {
  const Unproved* unproved = nullptr;  ///< the first of them that is refuted, or the first
  size_t operations = 0;
  std::set<uint32_t> callers;
  bool is_refuted() const { return !unproved->counterexample.empty(); }
};

std::vector<Entry> entries_of(const Tape& tape, const std::vector<Unproved>& unproved) {
  std::map<std::tuple<uint32_t, uint32_t, Breach>, size_t> known;
  std::vector<Entry> entries;
  for (const Unproved& u : unproved) {
    const IrPlace& place = tape.places[tape.operations[u.operation].place];
    const auto [found, is_new] = known.try_emplace({place.function, place.origin, u.breach}, entries.size());
    if (is_new) entries.push_back({&u, 0, {}});
    Entry& entry = entries[found->second];
    if (!entry.is_refuted() && !u.counterexample.empty()) entry.unproved = &u;
    ++entry.operations;
    entry.callers.insert(place.caller);
  }
  std::stable_partition(entries.begin(), entries.end(), [](const Entry& entry) { return entry.is_refuted(); });
  return entries;
}

class Reporter {
 public:
  Reporter(const TypedGraph& graph, const Subject& subject, support::Diagnostics& diagnostics,
           size_t most_named)
      : subject_(subject), documents_(graph, subject), diagnostics_(diagnostics), most_named_(most_named) {}

  void report(const Entry& entry);

 private:
  void describe_counterexample(const Unproved& unproved, support::Diagnostic& diagnostic);
  void describe_box(const Unproved& unproved, support::Diagnostic& diagnostic) const;
  void note_callers(const Entry& entry, const IrPlace& place, support::Diagnostic& diagnostic) const;

  /// "where x = 0.5, y = 1.0 and 3 more"
  std::string list(std::string_view begin, const std::vector<std::string>& items) const;

  const Subject& subject_;
  Documents documents_;
  support::Diagnostics& diagnostics_;
  size_t most_named_;
  std::optional<TapeRunner> runner_;
};

std::string Reporter::list(std::string_view begin, const std::vector<std::string>& items) const {
  std::string text(begin);
  for (size_t i = 0; i < std::min(items.size(), most_named_); ++i) text += (i == 0 ? " " : ", ") + items[i];
  if (items.size() > most_named_) text += " and " + std::to_string(items.size() - most_named_) + " more";
  return text;
}

void Reporter::describe_counterexample(const Unproved& unproved, support::Diagnostic& diagnostic) {
  const Tape& tape = subject_.tape;
  const std::vector<bool> relevant = inputs_of(tape, unproved.operation);
  std::vector<std::string> items;
  for (size_t i = 0; i < tape.inputs.size(); ++i) {
    if (!relevant[i]) continue;
    const Input& input = tape.inputs[i];
    items.push_back(input.name + " = " + number(input.scalar, unproved.counterexample[i]));
  }
  if (!items.empty()) diagnostic.note(list("where", items));

  const lanes::FpGuard guard;
  if (!runner_) runner_.emplace(tape);
  runner_->run(unproved.counterexample);
  items.clear();
  for (const uint32_t operand : tape.operands_of(tape.operations[unproved.operation])) {
    const ir::Scalar scalar = tape.operations[operand].scalar;
    items.push_back(number(scalar, runner_->word(operand)));
  }
  if (!items.empty()) diagnostic.note(list("it reads", items));
}

/// Describes the sides that are narrower than the whole box; scalar products, for example, by their nodes.
void Reporter::describe_box(const Unproved& unproved, support::Diagnostic& diagnostic) const {
  const Evaluator evaluator(subject_.tape);
  const Box whole = evaluator.whole();
  using enum Evaluator::Dependence;
  const std::vector<Evaluator::Dependence> dependence = evaluator.dependence(unproved.operation);
  std::vector<std::string> items;
  for (const auto wanted : {direct, indirect}) {
    for (size_t s = 0; s < std::min(unproved.box.size(), whole.size()); ++s) {
      const Side& side = unproved.box[s];
      if (dependence[s] != wanted || (side.lo == whole[s].lo && side.hi == whole[s].hi)) continue;
      const std::string name = evaluator.side_name(s);
      const float lo = static_cast<float>(side.lo), hi = static_cast<float>(side.hi);
      items.push_back(name + " in [" + support::format_float(lo) + ", " + support::format_float(hi) + "]");
    }
  }
  diagnostic.note(items.empty() ? "for any inputs" : list("for example where", items));
}

void Reporter::note_callers(const Entry& entry, const IrPlace& place, support::Diagnostic& diagnostic) const {
  for (uint32_t caller = place.caller; caller != none; caller = subject_.tape.places[caller].caller) {
    const Documents::Found found = documents_.find(subject_.tape.places[caller]);
    std::string message = "called by node " + quote(found.name());
    const size_t others = entry.callers.size() - 1;
    if (caller == place.caller && others > 0)
      message += ", and " + std::to_string(others) + (others == 1 ? " other call" : " other calls");
    diagnostic.note(found.span, message);
  }
}

void Reporter::report(const Entry& entry) {
  const Unproved& unproved = *entry.unproved;
  const IrPlace& place = subject_.tape.places[subject_.tape.operations[unproved.operation].place];
  const Documents::Found found = documents_.find(place);
  const std::string port = port_of(found, unproved.breach), node = found.name();
  std::string message = node.empty() ? "here" : "in node " + quote(node);
  if (!port.empty()) message += ", port " + quote(port);
  message += ": " + std::string(words(unproved.breach)) + (entry.is_refuted() ? "" : " is not ruled out");
  const support::Id id = entry.is_refuted() ? support::Id::refuted : support::Id::unproved;
  support::Diagnostic& diagnostic = diagnostics_.report(id, found.span, message);
  if (entry.is_refuted())
    describe_counterexample(unproved, diagnostic);
  else
    describe_box(unproved, diagnostic);
  note_callers(entry, place, diagnostic);
}

}  // namespace

NotProved count(const Subject& subject, const Proof& proof) {
  NotProved counts;
  for (const Entry& entry : entries_of(subject.tape, proof.unproved))
    ++(entry.is_refuted() ? counts.refuted : counts.undecided);
  counts.later = entries_of(subject.tape, proof.later).size();
  return counts;
}

Effort effort_for(const std::vector<Subject>& subjects) {
  Effort effort;
  effort.error /= std::max<size_t>(subjects.size(), 1);
  return effort;
}

NotProved report(const TypedGraph& graph, const Subject& subject, const Proof& proof,
                 support::Diagnostics& diagnostics, Detail detail) {
  const bool all = detail == Detail::all;
  Reporter reporter(graph, subject, diagnostics, all ? SIZE_MAX : most_named);
  NotProved counts;
  for (const Entry& entry : entries_of(subject.tape, proof.unproved)) {
    ++(entry.is_refuted() ? counts.refuted : counts.undecided);
    if (!all && counts.shown == most_shown) continue;
    ++counts.shown;
    reporter.report(entry);
  }
  for (const Entry& entry : entries_of(subject.tape, proof.later)) {
    ++counts.later;
    if (all) reporter.report(entry);
  }
  return counts;
}

}  // namespace isoshade::prove
