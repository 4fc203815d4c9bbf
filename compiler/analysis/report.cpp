// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <unordered_map>

#include "compiler/analysis/document.h"
#include "compiler/support/parse_number.h"
#include "compiler/support/visible.h"
#include "runtime/lanes/lanes.h"

namespace isoshade::analysis {
namespace {

using check::TypedGraph;
using support::quote;

constexpr size_t most_named = 40;  ///< inputs in a message

/// The documents that a graph uses, by their paths.
class Documents {
 public:
  explicit Documents(const TypedGraph& graph) : graph_(graph) { add(graph); }

  struct Found {
    const TypedGraph* graph = nullptr;
    uint32_t node = none;
    support::Span span;
  };
  Found find(const Place& place) const {
    const auto document = by_path_.find(place.document);
    const TypedGraph& graph = document == by_path_.end() ? graph_ : *document->second;
    const auto name = graph.graph.names.find(place.node);
    if (document == by_path_.end() || name == graph.graph.names.end() || name->second.is_input)
      return {&graph, none, graph.graph.span(graph.graph.name_place)};
    const uint32_t node = name->second.index;
    return {&graph, node, graph.graph.span(graph.graph.nodes[node].id_place)};
  }

 private:
  void add(const TypedGraph& graph) {
    if (!by_path_.emplace(graph.document, &graph).second) return;
    for (const check::Node& node : graph.nodes)
      if (node.callee != nullptr) add(*node.callee);
  }

  const TypedGraph& graph_;
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

std::string both_ways(ir::Scalar scalar, uint32_t word) {
  if (scalar != ir::Scalar::floating) return std::to_string(static_cast<int32_t>(word));
  const auto value = std::bit_cast<float>(word);
  return support::format_float(value) + " (" + support::format_hex_float(value) + ")";
}

/// "a = 0.5 (0x1p-1), b = ..." in notes of a few inputs each.
void note_list(support::Diagnostic& diagnostic, std::string_view begin,
               const std::vector<std::string>& items) {
  constexpr size_t on_a_line = 4;
  for (size_t i = 0; i < items.size(); i += on_a_line) {
    std::string line(i == 0 ? begin : "and ");
    for (size_t k = i; k < std::min(i + on_a_line, items.size()); ++k)
      line += (k == i ? "" : ", ") + items[k];
    diagnostic.note(line);
  }
}

void describe_counterexample(const Subject& subject, const Unproved& unproved,
                             support::Diagnostic& diagnostic) {
  const Tape& tape = subject.tape;
  const std::vector<bool> relevant = inputs_of(tape, unproved.operation);
  std::vector<std::string> items;
  for (size_t i = 0; i < tape.inputs.size() && items.size() < most_named; ++i)
    if (relevant[i])
      items.push_back(tape.inputs[i].name + " = " +
                      both_ways(tape.inputs[i].scalar, unproved.counterexample[i]));
  note_list(diagnostic, "where ", items);

  const lanes::FpGuard guard;
  Runner runner(tape);
  runner.run(unproved.counterexample);
  const Operation& operation = tape.operations[unproved.operation];
  items.clear();
  for (const uint32_t operand : tape.operands_of(operation))
    items.push_back(both_ways(tape.operations[operand].scalar, runner.word(operand)));
  note_list(diagnostic, "it reads ", items);
  items.clear();
  for (const Tape::Output& output : tape.outputs)
    items.push_back(output.name + " = " + both_ways(ir::Scalar::floating, runner.word(output.operation)));
  note_list(diagnostic, "the results are ", items);
}

void describe_box(const Subject& subject, const Unproved& unproved, support::Diagnostic& diagnostic) {
  const Tape& tape = subject.tape;
  const std::vector<bool> relevant = inputs_of(tape, unproved.operation);
  std::vector<std::string> items;
  for (size_t i = 0; i < tape.inputs.size() && items.size() < most_named; ++i) {
    const Side& side = unproved.box[i];
    if (!relevant[i]) continue;
    items.push_back(tape.inputs[i].name + " in [" + support::format_float(static_cast<float>(side.lo)) +
                    ", " + support::format_float(static_cast<float>(side.hi)) + "]");
  }
  const std::string count = std::to_string(unproved.open_boxes);
  note_list(diagnostic,
            unproved.open_boxes == 1 ? "open where " : "open in " + count + " boxes, one of them ", items);
}

}  // namespace

void report(const TypedGraph& graph, const Subject& subject, const Proof& proof,
            support::Diagnostics& diagnostics) {
  const Documents documents(graph);
  for (const Unproved& unproved : proof.unproved) {
    const Place& place = subject.tape.places[subject.tape.operations[unproved.operation].place];
    const Documents::Found found = documents.find(place);
    const std::string port = port_of(found, unproved.breach);
    const bool refuted = !unproved.counterexample.empty();
    std::string message = found.node == none ? "here" : "in node " + quote(place.node);
    if (!port.empty()) message += ", port " + quote(port);
    message += ": " + std::string(words(unproved.breach)) + (refuted ? "" : " is not ruled out");
    support::Diagnostic& diagnostic =
        diagnostics.report(refuted ? support::Id::refuted : support::Id::unproved, found.span, message);
    for (uint32_t caller = place.caller; caller != none; caller = subject.tape.places[caller].caller)
      diagnostic.note(documents.find(subject.tape.places[caller]).span,
                      "called by node " + quote(subject.tape.places[caller].node));
    if (refuted)
      describe_counterexample(subject, unproved, diagnostic);
    else
      describe_box(subject, unproved, diagnostic);
  }
}

}  // namespace isoshade::analysis
