// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/forward.h"

#include <algorithm>

#include "compiler/passes/passes.h"
#include "compiler/passes/pipeline.h"
#include "compiler/support/visible.h"

namespace isoshade::driver {
namespace {

using emit::PureFunction;
using emit::PureKind;

/// What the functions that take the point of a kind are given for it, without the derivatives.
std::vector<interface::Binding> point_bindings(const emit::PureShader& shader, PureKind kind) {
  std::vector<interface::Binding> bindings;
  for (const PureFunction& function : shader.functions) {
    if (emit::point_record(function.kind) != emit::point_record(kind)) continue;
    for (const interface::Binding& binding : function.bindings) {
      const bool is_known = std::ranges::any_of(bindings, [&](const interface::Binding& other) {
        return other.parameter.name == binding.parameter.name;
      });
      if (!is_known && std::holds_alternative<interface::place::Point>(place_of(binding, false)))
        bindings.push_back(binding);
    }
  }
  return bindings;
}

/// Leaves it to the pair to sample images.
void forget_samplers(emit::PureShader& shader) {
  for (ir::Function& function : shader.module.functions)
    if (emit::is_sampler(shader, function)) {
      ir::Function declaration;
      declaration.name = function.name;
      declaration.parameters = function.parameters;
      declaration.results = function.results;
      function = std::move(declaration);
    }
}

emit::ForwardProgram program_of(const Shader& shader, const emit::PureShader& pure, const emit::Target& target,
                                size_t main, std::optional<size_t> move_vertex = {},
                                std::optional<size_t> coverage = {}) {
  emit::ForwardProgram program;
  program.pure = &pure;
  program.main = main;
  program.move_vertex = move_vertex;
  program.coverage = coverage;
  program.name = pure.name;
  for (const Image& image : shader.parameters.images) {
    // Images are the last of the parameters, in the same order.
    const size_t at = pure.parameters.size() - shader.parameters.images.size() + program.images.size();
    program.images.push_back({pure.parameters[at].name, image.slot.mips, image.slot.layers});
  }
  const bool is_post = shader.kind == graph::DocumentKind::post;
  if (is_post) program.pictures = 1 + shader.images.size();
  program.point_bindings = point_bindings(pure, is_post ? PureKind::post_process : PureKind::shade);
  if (move_vertex) program.vertex_bindings = point_bindings(pure, PureKind::move_vertex);

  passes::Entries entries{};
  entries.are_linked = true;
  std::vector<std::optional<lower::ForwardFunction>*> functions;
  const auto add = [&](std::optional<lower::ForwardFunction>& to, lower::ForwardFunction made) {
    entries.functions.push_back(made.function);
    to = std::move(made);
    functions.push_back(&to);
  };
  if (!program.point_bindings.empty())
    add(program.point, is_post ? lower::add_forward_screen(program.module, program.point_bindings)
                               : lower::add_forward_surface(program.module, program.point_bindings));
  if (!program.vertex_bindings.empty())
    add(program.vertex, lower::add_forward_surface(program.module, program.vertex_bindings, "vertex_at"));
  const std::vector<interface::HostCall> calls = host_calls(pure);
  const auto asks = [&](interface::HostCall call) { return std::ranges::find(calls, call) != calls.end(); };
  if (asks(interface::HostCall::light) || asks(interface::HostCall::light_change))
    add(program.light, lower::add_forward_light(program.module));
  passes::run(passes::optimisations(), program.module, entries, shader.tier);
  if (!emit::has_op(target.id, ir::Opcode::imulhi)) passes::multiply_by_halves(program.module);
  for (size_t i = 0; i < functions.size(); ++i) (*functions[i])->function = entries[i];
  return program;
}

}  // namespace

bool can_be_forward(const Shader& shader, support::Diagnostics& diagnostics) {
  if (shader.kind != graph::DocumentKind::effect) return true;
  const auto reads_picture = [](const check::Node& node) { return node.row != nullptr && node.row->is<nodes::Fetch>(); };
  const auto found = std::ranges::find_if(shader.typed->nodes, reads_picture);
  if (found == shader.typed->nodes.end()) return true;
  const graph::Graph& graph = shader.typed->graph;
  const graph::Node& source = graph.nodes[static_cast<size_t>(found - shader.typed->nodes.begin())];
  diagnostics
      .report(support::Id::unsupported, graph.span(source.type_place),
              support::quote(graph.name) + " cannot be a forward pair: " + support::quote(source.label()) +
                  " reads the picture of what is opaque")
      .suggest("draw it with isoshade, or call its functions (--wrapper none) from a shader of your own");
  return false;
}

std::vector<ForwardPair> forward_pairs(const Shader& shader, const emit::Target& target,
                                       emit::ForwardSampling sampling) {
  std::vector<ForwardPair> pairs;
  emit::PureShader pure = prepared(shader, target);
  if (sampling == emit::ForwardSampling::samplers) forget_samplers(pure);
  const auto add = [&](std::string stem, emit::ForwardProgram program) {
    program.sampling = sampling;
    pairs.push_back({std::move(stem), target.forward(program), emit::forward_layout(program)});
  };
  if (shader.kind == graph::DocumentKind::post) add(pure.name, program_of(shader, pure, target, 0));
  for (const ShaderPass& pass : shader.passes) {
    emit::ForwardProgram program = program_of(shader, pure, target, pass.shade, pass.move_vertex, pass.coverage);
    program.position_space = pass.position_space;
    program.blend = pass.state.blend;
    const bool has_several = shader.passes.size() > 1;
    if (has_several) program.name += ", pass " + pass.name;
    add(has_several ? pass_stem(pure.name, pass.name, pairs.size()) : pure.name, std::move(program));
  }
  return pairs;
}

}  // namespace isoshade::driver
