// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "compiler/check/stage_needs.h"
#include "compiler/check/work.h"

namespace isoshade::check {
namespace {

using support::Id;
using support::quote;
using From = Operand::From;

bool is_sum(const Node& node) { return node.row != nullptr && node.row->is_sum(); }
bool is_summand(const Node& node) { return node.row != nullptr && node.row->is_summand(); }

uint64_t size_of(const Node& node) { return node.callee != nullptr ? node.callee->expanded_nodes : 1; }

void mark_per_iteration(TypedGraph& typed) {
  for (const uint32_t i : typed.order) {
    Node& node = typed.nodes[i];
    node.per_iteration = is_summand(node);
    if (is_sum(node)) continue;
    for (const Operand& operand : typed.operands_of(node))
      node.per_iteration |= operand.from == From::node && typed.nodes[operand.index].per_iteration;
  }
}

/// Reports light and tap nodes that an output depends on without a sum in between.
void check_summands(Work& work) {
  const TypedGraph& typed = work.typed;
  const graph::Graph& graph = work.graph();
  constexpr uint32_t not_reached = ~0u;
  constexpr uint32_t output = not_reached - 1;
  std::vector<uint32_t> reader(typed.nodes.size(), not_reached);
  for (const Operand& root : typed.values())
    if (root.from == From::node) reader[root.index] = output;
  for (auto it = typed.order.rbegin(); it != typed.order.rend(); ++it) {
    const Node& node = typed.nodes[*it];
    if (reader[*it] == not_reached) continue;
    if (is_summand(node)) {
      std::string path = graph.nodes[*it].id;
      for (uint32_t i = reader[*it], shown = 0; i != output; i = reader[i]) {
        if (++shown > 8) {
          path += " -> ...";
          break;
        }
        path += " -> " + graph.nodes[i].id;
      }
      const bool light = node.row->is<nodes::Light>();
      const std::string sum = light ? "sum_lights" : "sum_taps";
      work.report(light ? Id::light_outside_sum : Id::tap_outside_sum, graph.nodes[*it].type_place,
                  quote(graph.nodes[*it].type) + " is used outside of " + sum)
          .note("an output depends on it: " + path)
          .suggest("link the value that depends on it to a " + sum + " node");
    }
    if (is_sum(node)) continue;
    for (const Operand& operand : typed.operands_of(node))
      if (operand.from == From::node) reader[operand.index] = *it;
  }
}

/// Why a node that needs something is not available in the vertex stage.
const char* missing_at_vertices(StageNeed need, const PlacedNode& cause) {
  if (need == StageNeed::lights) return "lights exist only for pixels";
  if (need == StageNeed::environment) return "the environment exists only for pixels";
  if (need == StageNeed::pixel) return "it is known only for pixels";
  return may_be_trilinear(cause.graph, cause.get())
             ? "its mip level exists only for pixels; \"closest\" and \"linear\" filtering need none"
             : "derivatives exist only for pixels";
}

bool needs(const TypedGraph& typed, uint32_t node, StageNeed need) {
  return needs_of(typed, typed.nodes[node])[static_cast<size_t>(need)];
}

/// Reports nodes that a pass's position depends on, but that are not available in the vertex stage.
void check_positions(Work& work) {
  const TypedGraph& typed = work.typed;
  const graph::Graph& graph = work.graph();
  std::vector<bool> reached(typed.nodes.size());
  const auto reach = [&](const Operand& operand) {
    if (operand.from == From::node) reached[operand.index] = true;
  };
  std::ranges::for_each(typed.positions(), reach);
  for (auto it = typed.order.rbegin(); it != typed.order.rend(); ++it) {
    if (!reached[*it]) continue;
    const Node& node = typed.nodes[*it];
    std::ranges::for_each(typed.operands_of(node), reach);
    for (const StageNeed need :
         {StageNeed::lights, StageNeed::environment, StageNeed::derivatives, StageNeed::pixel}) {
      if (!needs(typed, *it, need)) continue;
      support::Diagnostic& report =
          work.report(Id::misplaced_node, graph.nodes[*it].type_place,
                      "the \"position\" of a pass cannot depend on " + quote(graph.nodes[*it].label()));
      note_calls(report, typed, *it, need);
      report.note(std::string("it is computed per vertex, and ") +
                  missing_at_vertices(need, cause_of(typed, *it, need)));
      report.suggest("compute \"position\" without it; only \"color\" may depend on it");
      break;
    }
  }
}

/// Reports nodes that a part of a pass, computed per pixel, depends on, but that are not available there. Visibility
/// does not depend on lights, because shadows depend on visibility.
void check_pixels(Work& work, std::span<const Operand> outputs, const std::string& part, bool has_lights) {
  const TypedGraph& typed = work.typed;
  std::vector<bool> reached(typed.nodes.size());
  const auto reach = [&](const Operand& operand) {
    if (operand.from == From::node) reached[operand.index] = true;
  };
  std::ranges::for_each(outputs, reach);
  for (auto it = typed.order.rbegin(); it != typed.order.rend(); ++it) {
    if (!reached[*it]) continue;
    const Node& node = typed.nodes[*it];
    std::ranges::for_each(typed.operands_of(node), reach);
    const bool at_vertices = needs(typed, *it, StageNeed::vertex);
    const bool at_light = needs(typed, *it, StageNeed::lights);
    if (!at_vertices && (has_lights || (!at_light && !needs(typed, *it, StageNeed::environment)))) continue;
    const graph::Node& source = work.graph().nodes[*it];
    support::Diagnostic& report =
        work.report(Id::misplaced_node, source.type_place,
                    "the " + quote(part) + " of a pass cannot depend on " + quote(source.label()));
    note_calls(report, typed, *it,
               at_vertices ? StageNeed::vertex : at_light ? StageNeed::lights : StageNeed::environment);
    if (at_vertices)
      report.suggest("it is available only for vertices: use it for \"position\"");
    else
      report.note("it decides what is seen, and lights exist only for what is seen")
          .suggest("compute " + quote(part) + " without lights; only \"color\" may depend on them");
  }
}

void check_cutouts(Work& work) {
  std::vector<Operand> cutouts, cutoffs;
  for (size_t i = 0; i < work.graph().passes.size(); ++i) {
    const std::span<const Operand> cutout = work.typed.cutout_of(i);
    if (!cutout.empty()) cutouts.push_back(cutout[0]);
    if (cutout.size() > 1) cutoffs.push_back(cutout[1]);
  }
  check_pixels(work, cutouts, "cutout", false);
  check_pixels(work, cutoffs, "cutoff", false);
}

bool reads_picture(const Node& node) { return node.row != nullptr && node.row->is<nodes::Fetch>(); }

/// Reports nodes of a pass that read the picture where there is none: only a pass that is always blended is drawn over
/// what is opaque. `part` names what depends on `outputs`.
void check_pictures(Work& work, std::span<const Operand> outputs, std::string_view part, const graph::Pass& pass,
                    std::vector<bool>& reported) {
  const TypedGraph& typed = work.typed;
  const bool is_color = part == "color", is_blended = pass.state.blend != interface::Blend::none;
  if (is_color && is_blended && !pass.blended) return;
  std::vector<bool> reached(typed.nodes.size());
  const auto reach = [&](const Operand& operand) {
    if (operand.from == From::node) reached[operand.index] = true;
  };
  std::ranges::for_each(outputs, reach);
  for (auto it = typed.order.rbegin(); it != typed.order.rend(); ++it) {
    if (!reached[*it]) continue;
    const Node& node = typed.nodes[*it];
    std::ranges::for_each(typed.operands_of(node), reach);
    if (!reads_picture(node) || reported[*it]) continue;
    reported[*it] = true;
    const graph::Node& source = work.graph().nodes[*it];
    support::Diagnostic& report =
        work.report(Id::misplaced_node, source.type_place,
                    "the " + quote(part) + " of pass " + quote(pass.name) + " cannot depend on " + quote(source.label()));
    if (!is_color)
      report.note("it decides what is seen, and the picture exists only after that")
          .suggest("compute " + quote(part) + " without it; only \"color\" may depend on it");
    else if (is_blended)
      report.note("where its \"blended\" is 0 the pass is a part of the picture that the node reads")
          .suggest("remove \"blended\"");
    else
      report.note("it reads the picture of what is opaque, and the pass is a part of that")
          .suggest("give the pass a \"blend\"");
  }
}

void check_pictures(Work& work) {
  const TypedGraph& typed = work.typed;
  std::vector<bool> reported(typed.nodes.size());
  for (size_t i = 0; i < work.graph().passes.size(); ++i) {
    const graph::Pass& pass = work.graph().passes[i];
    const Operand* position = typed.position_of(i);
    check_pictures(work, {position, position != nullptr ? size_t{1} : 0}, "position", pass, reported);
    const std::span<const Operand> cutout = typed.cutout_of(i);
    const size_t first = std::min(cutout.size(), size_t{1});  // behind it stands the cutoff
    check_pictures(work, cutout.first(first), "cutout", pass, reported);
    check_pictures(work, cutout.subspan(first), "cutoff", pass, reported);
    check_pictures(work, typed.values().subspan(i, 1), "color", pass, reported);
  }
}

/// Reports derivatives of what depends on the picture: its pixels are no function of the surface.
void check_derivatives_of_pictures(Work& work) {
  const TypedGraph& typed = work.typed;
  std::vector<bool> depends(typed.nodes.size());
  for (const uint32_t i : typed.order) {
    const Node& node = typed.nodes[i];
    const std::span<const Operand> operands = typed.operands_of(node);
    depends[i] = reads_picture(node);
    for (size_t k = 0; k < operands.size(); ++k) {
      if (operands[k].from != From::node || !depends[operands[k].index]) continue;
      depends[i] = true;
      const bool differentiates = node.row == nullptr ? node.callee->differentiated_inputs[k] > 0
                                                      : node.row->is<nodes::Derivative>() ||
                                                            (may_be_trilinear(typed, node) &&
                                                             k == nodes::image_port::texcoord);
      if (!differentiates) continue;
      const graph::Node& source = work.graph().nodes[i];
      work.report(Id::misplaced_node, source.type_place,
                  quote(source.label()) + " takes the derivative of a value that depends on " +
                      quote(work.graph().nodes[operands[k].index].id) + ", which reads the picture")
          .note("what is read of the picture has no derivative");
    }
  }
}

/// Reports calls of functions that need what a post does not have.
void check_calls_of_post(Work& work) {
  const TypedGraph& typed = work.typed;
  for (uint32_t i = 0; i < typed.nodes.size(); ++i) {
    const TypedGraph* callee = typed.nodes[i].callee.get();
    if (callee == nullptr) continue;
    const auto missing = [&](uint32_t node) { return node != no_node; };
    const auto all = std::span(callee->needed_by).first(static_cast<size_t>(StageNeed::environment));
    const auto found = std::ranges::find_if(all, missing);
    if (found == all.end()) continue;
    const auto need = static_cast<StageNeed>(found - all.begin());
    const graph::Node& source = work.graph().nodes[i];
    support::Diagnostic& report =
        work.report(Id::misplaced_node, source.type_place,
                    "a post cannot call " + quote(source.label()) + ": it depends on " +
                        described(cause_of(typed, i, need)));
    note_calls(report, typed, i, need);
    report.suggest("call it from an effect");
  }
}

/// Reports calls inside of a sum over lights of functions that sum over lights themselves. A sum that is the same for
/// every light is no such call: it is computed before.
void check_nested_sums(Work& work) {
  const TypedGraph& typed = work.typed;
  for (uint32_t i = 0; i < typed.nodes.size(); ++i) {
    const Node& node = typed.nodes[i];
    if (node.callee == nullptr || !node.per_iteration || !node.callee->needs(StageNeed::lights)) continue;
    const graph::Node& source = work.graph().nodes[i];
    support::Diagnostic& report =
        work.report(Id::misplaced_node, source.type_place,
                    quote(source.label()) + " sums over lights, so its inputs cannot depend on a light");
    note_calls(report, typed, i, StageNeed::lights);
    report.suggest("pass it values that are the same for every light");
  }
}

/// A derivative may be taken of a derivative, but not of that one: each makes a program several times as long.
constexpr int most_derivatives = 2;

/// Finds how often a document takes the derivative of each input, by itself and in functions that it calls, and reports
/// second derivatives of lights: hosts give their first.
void find_differentiated_inputs(Work& work) {
  TypedGraph& typed = work.typed;
  typed.differentiated_inputs.assign(typed.graph.inputs.size(), 0);
  std::vector<int> differentiated(typed.nodes.size());
  for (auto it = typed.order.rbegin(); it != typed.order.rend(); ++it) {
    const Node& node = typed.nodes[*it];
    const std::span<const Operand> operands = typed.operands_of(node);
    const int by_users = differentiated[*it];
    const bool takes_one = node.row != nullptr && node.row->is<nodes::Derivative>();
    for (size_t i = 0; i < operands.size(); ++i) {
      int count = by_users + (takes_one ? 1 : 0);
      if (node.callee != nullptr) count += node.callee->differentiated_inputs[i];
      if (i == nodes::image_port::texcoord && may_be_trilinear(typed, node)) count = std::max(count, 1);
      if (operands[i].from == From::node)
        differentiated[operands[i].index] = std::max(differentiated[operands[i].index], count);
      if (operands[i].from == From::input)
        typed.differentiated_inputs[operands[i].index] = std::max(typed.differentiated_inputs[operands[i].index], count);
    }
    const int inside = node.callee != nullptr && by_users > 0 ? node.callee->derivative_order : 0;
    if (by_users + inside < 2 || !needs(typed, *it, StageNeed::lights)) continue;
    work.report(Id::unsupported, work.graph().nodes[*it].type_place,
                "a second derivative is taken of " + quote(work.graph().nodes[*it].id) + ", which depends on lights")
        .note("lights have first derivatives only");
  }
}

/// Reports derivatives of values that depend on a second derivative.
void check_derivatives(Work& work) {
  TypedGraph& typed = work.typed;
  constexpr uint32_t nothing = ~0u;
  /// How many derivatives, each taken of the other, a node depends on, and the last of them.
  struct Depends {
    int order = 0;
    uint32_t on = nothing;
  };
  std::vector<Depends> all(typed.nodes.size());
  for (const uint32_t i : typed.order) {
    const Node& node = typed.nodes[i];
    const graph::Node& source = work.graph().nodes[i];
    const bool takes_one = node.row != nullptr && node.row->is<nodes::Derivative>();
    const std::span<const Operand> operands = typed.operands_of(node);
    Depends& made = all[i];
    if (node.callee != nullptr && node.callee->derivative_order > 0) made = {node.callee->derivative_order, i};
    for (size_t k = 0; k < operands.size(); ++k) {
      const Depends given = operands[k].from == From::node ? all[operands[k].index] : Depends{};
      const int taken = takes_one ? 1 : node.callee != nullptr ? node.callee->differentiated_inputs[k] : 0;
      const int order = given.order + taken;
      const auto of = [&] { return quote(work.graph().nodes[given.on].id); };
      if (order > most_derivatives && given.order > 0) {
        work.report(Id::third_derivative, source.type_place,
                    takes_one ? quote(source.type) + " of a value that depends on the second derivative " + of()
                              : quote(source.label()) + " takes the derivative of its input " +
                                    quote(node.callee->graph.inputs[k].name) + ", which depends on the derivative " + of());
      }
      if (given.order == most_derivatives && k == nodes::image_port::texcoord && may_be_trilinear(typed, node)) {
        work.report(Id::third_derivative, source.type_place,
                    "a trilinear image takes derivatives of its \"texcoord\", which depends on the second derivative " + of())
            .suggest("use the filtertype \"linear\"");
      }
      if (order > made.order) made = {std::min(order, most_derivatives), taken > 0 ? i : given.on};
    }
  }
  for (const Operand& output : typed.outputs)
    if (output.from == From::node) typed.derivative_order = std::max(typed.derivative_order, all[output.index].order);
}

/// Reports derivatives of values that depend on the environment, whose maps have none.
void check_derivatives_of_environment(Work& work) {
  const TypedGraph& typed = work.typed;
  std::vector<bool> depends(typed.nodes.size());
  for (const uint32_t i : typed.order) {
    const Node& node = typed.nodes[i];
    const std::span<const Operand> operands = typed.operands_of(node);
    const bool takes_one = node.row != nullptr && node.row->is<nodes::Derivative>();
    bool reported = false;
    for (size_t k = 0; k < operands.size(); ++k) {
      if (operands[k].from != From::node || !depends[operands[k].index]) continue;
      depends[i] = true;
      const bool differentiated = takes_one || (node.callee != nullptr && node.callee->differentiated_inputs[k] > 0) ||
                                  (may_be_trilinear(typed, node) && k == nodes::image_port::texcoord);
      if (!differentiated || std::exchange(reported, true)) continue;
      const graph::Node& source = work.graph().nodes[i];
      work.report(Id::unsupported, source.type_place,
                  quote(source.label()) + " takes the derivative of " +
                      quote(work.graph().nodes[operands[k].index].id) + ", which depends on the environment")
          .suggest("take the derivative of a value that does not depend on it");
    }
    depends[i] = depends[i] || needs(typed, i, StageNeed::environment);
  }
}

/// The number of nodes that all sums together compute per light or tap; stops counting beyond the limit.
uint64_t nodes_under_sums(const TypedGraph& typed) {
  uint64_t total = 0;
  std::vector<uint32_t> seen_by(typed.nodes.size(), ~0u);
  std::vector<uint32_t> waiting;
  for (uint32_t sum = 0; sum < typed.nodes.size(); ++sum) {
    if (!is_sum(typed.nodes[sum])) continue;
    waiting.push_back(sum);
    while (!waiting.empty() && total <= max_expanded_nodes) {
      const Node& node = typed.nodes[waiting.back()];
      waiting.pop_back();
      total += size_of(node);
      for (const Operand& operand : typed.operands_of(node)) {
        if (operand.from != From::node || seen_by[operand.index] == sum) continue;
        if (!typed.nodes[operand.index].per_iteration) continue;
        seen_by[operand.index] = sum;
        waiting.push_back(operand.index);
      }
    }
  }
  return total;
}

void check_size(Work& work) {
  TypedGraph& typed = work.typed;
  uint64_t total = nodes_under_sums(typed);
  for (const Node& node : typed.nodes) total = std::min(total + size_of(node), max_expanded_nodes + 1);
  typed.expanded_nodes = std::max<uint64_t>(total, 1);
  if (total <= max_expanded_nodes) return;
  work.report(Id::too_large, work.graph().name_place,
              "with all calls and sums over lights expanded, the graph has more than " +
                  std::to_string(max_expanded_nodes) + " nodes");
}

void warn_unused(Work& work) {
  const TypedGraph& typed = work.typed;
  std::vector<bool> used(typed.nodes.size());
  // For an expression, report only the node that the author wrote.
  for (const graph::Expression& expression : work.graph().expressions)
    std::fill(used.begin() + expression.first, used.begin() + expression.end, true);
  const auto use = [&](const Operand& operand) {
    if (operand.from == From::node) used[operand.index] = true;
  };
  std::ranges::for_each(typed.outputs, use);
  for (auto it = typed.order.rbegin(); it != typed.order.rend(); ++it)
    if (used[*it]) std::ranges::for_each(typed.operands_of(typed.nodes[*it]), use);
  for (size_t i = 0; i < used.size(); ++i) {
    if (used[i]) continue;
    work.report(Id::unused_node, work.graph().nodes[i].id_place,
                "no output depends on node " + quote(work.graph().nodes[i].id));
  }
}

}  // namespace

bool may_be_trilinear(const TypedGraph& typed, const Node& node) {
  if (node.row == nullptr || !node.row->is<nodes::Image>()) return false;
  constexpr auto trilinear = static_cast<uint32_t>(nodes::Filter::trilinear);
  const Operand& filter = typed.operands_of(node)[nodes::image_port::filtertype];
  return filter.from == From::input ? typed.graph.inputs[filter.index].names.size() > trilinear
                                    : filter.index == trilinear;
}

bool reads_layers(const TypedGraph& typed, const Node& node) {
  if (node.row == nullptr || !node.row->is<nodes::Image>()) return false;
  const Operand& layer = typed.operands_of(node)[nodes::image_port::layer];
  return layer.from != From::words || typed.words[layer.index] != 0;
}

void check_usage(Work& work) {
  mark_per_iteration(work.typed);
  find_stage_needs(work.typed);
  find_differentiated_inputs(work);
  check_summands(work);
  check_nested_sums(work);
  if (work.graph().kind == graph::DocumentKind::effect) {
    check_positions(work);
    check_pixels(work, work.typed.values(), "color", true);
    check_cutouts(work);
    check_pictures(work);
    check_derivatives_of_pictures(work);
  }
  if (work.graph().kind == graph::DocumentKind::post) check_calls_of_post(work);
  check_derivatives(work);
  check_derivatives_of_environment(work);
  check_size(work);
  if (!work.is_instance()) warn_unused(work);
}

}  // namespace isoshade::check
