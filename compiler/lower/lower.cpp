// SPDX-License-Identifier: Apache-2.0
#include "compiler/lower/lower.h"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include "compiler/lower/body.h"
#include "compiler/lower/environment.h"
#include "compiler/lower/inputs.h"
#include "compiler/support/assert.h"

namespace isoshade::lower {
namespace {

using check::Operand;
using check::TypedGraph;
using graph::DocumentKind;
using graph::Type;
using interface::Binding;
using nodes::Value;
namespace names = interface::names;

/// SPIR-V allows 255 parameters of a function, and derivatives may double them. A function with more inputs than this
/// takes them in structs.
constexpr size_t most_plain_inputs = 100;
constexpr size_t inputs_of_a_group = 100;

/// A name that neither kernels nor library functions have.
std::string authored_name(const std::string& name) {
  const bool taken = interface::is_kernel_function(name) || name.starts_with("iso_") ||
                     name.starts_with(names::sample_prefix);
  return taken ? "function_" + name : name;
}

/// A comment behind each function says which document it comes from.
std::string document_of(const TypedGraph& graph) {
  return graph.document.empty() ? "a document without a file" : graph.document;
}

/// A colour with alpha 1 if it has none.
ir::ValueId with_alpha(ir::Builder& b, ir::ValueId color) {
  return b.construct(
      std::array{b.extract(color, 0), b.extract(color, 1), b.extract(color, 2), b.constant(1.0f)});
}

/// Whether a float reaches its cutoff; a cutoff of 0 or less is reached everywhere, by NaN too.
ir::ValueId reaches(ir::Builder& b, ir::ValueId value, ir::ValueId cutoff) {
  const ir::ValueId is_off = b.op(ir::Opcode::fle, {cutoff, b.constant(0.0f)});
  return b.op(ir::Opcode::bor, {is_off, b.op(ir::Opcode::fge, {value, cutoff})});
}

/// What the function of a part of a pass is called, and its result.
std::string_view function_of(PassPart part) {
  switch (part) {
    case PassPart::color: return names::shade;
    case PassPart::position: return names::move_vertex;
    case PassPart::coverage: return names::coverage;
  }
  support::bug("no such part of a pass");
}
ir::Result result_of(PassPart part) {
  switch (part) {
    case PassPart::color: return {"color", ir::vector_type(4)};
    case PassPart::position: return {"position", ir::vector_type(3)};
    case PassPart::coverage: return {"drawn", ir::bool_type};
  }
  support::bug("no such part of a pass");
}

/// The outputs of the document that a part of a pass consists of; none if the pass lacks it.
std::span<const Operand> outputs_of(const TypedGraph& graph, size_t pass, PassPart part) {
  switch (part) {
    case PassPart::color: return graph.values().subspan(pass, 1);
    case PassPart::position: {
      const Operand* position = graph.position_of(pass);
      return {position, position != nullptr ? size_t{1} : 0};
    }
    case PassPart::coverage: return graph.cutout_of(pass);
  }
  support::bug("no such part of a pass");
}

class ModuleLowering {
 public:
  explicit ModuleLowering(NodesOfOrigins* nodes, bool light_lists = false) : nodes_(nodes), light_lists_(light_lists) {}

  // Each adds the function of a document and what it calls. Its interface lists what the whole module asks its host for.
  interface::Interface add_function_document(const TypedGraph& graph);
  interface::Interface add_post(const TypedGraph& graph);
  /// `prefix`: what the function's name begins with.
  interface::Interface add_pass(const TypedGraph& graph, size_t pass, PassPart part,
                                const std::string& prefix = "");

  ir::Module take_module() { return std::move(module_); }

 private:
  using Bindings = std::vector<Binding>;

  /// Lowers the documents that the needed nodes call, and adds what these need.
  void add_callees(const TypedGraph& graph, Needs& needs);
  /// `is_alone`: no pass calls it, which may move vertices.
  uint32_t add_function(const TypedGraph& graph, std::string name, Bindings& bindings, bool is_alone = false);
  /// Adds a function whose parameters are the bindings'; a colour without alpha gets one where four components are
  /// wanted, and a cut-out is compared with its cutoff where a boolean is wanted.
  uint32_t build(const TypedGraph& graph, std::string name, const Bindings& bindings, const Needs& needs,
                 std::span<const Operand> roots, std::vector<ir::Result> results);
  interface::Interface interface_of(uint32_t entry, Bindings bindings) const {
    return {entry, std::move(bindings), host_.host};
  }
  std::string unique_name(const std::string& wanted);
  void declare_hosts(const Needs& needs);
  void declare_light_at();
  /// Declares the functions that read images of the screen.
  void declare_picture(const TypedGraph& graph, const Needs& needs);
  void add_parameters(const TypedGraph& graph, const Needs& needs, Bindings& bindings) const;
  /// What stands before and after the parameters of an effect, and after the inputs of a function.
  static void add_surface(const Needs& needs, Bindings& bindings);
  void add_images_and_lights(const TypedGraph& graph, const Needs& needs, Bindings& bindings);

  ir::Module module_;
  interface::Interface host_;  ///< only Interface::host: what the functions so far ask for
  NodesOfOrigins* nodes_;
  const bool light_lists_;
  std::unordered_map<const TypedGraph*, Callee> functions_;
  ImageSlotTable images_;
  std::unordered_set<std::string> names_;
};

std::string ModuleLowering::unique_name(const std::string& wanted) {
  std::string name = wanted;
  for (int number = 2; !names_.insert(name).second; ++number) name = wanted + "_" + std::to_string(number);
  return name;
}

void ModuleLowering::add_callees(const TypedGraph& graph, Needs& needs) {
  std::unordered_set<const TypedGraph*> added;
  for (size_t i = 0; i < graph.nodes.size(); ++i) {
    const TypedGraph* callee = graph.nodes[i].callee.get();
    if (!needs.nodes[i] || callee == nullptr || !added.insert(callee).second) continue;
    if (!functions_.contains(callee)) {
      Callee made;
      made.function = add_function(*callee, unique_name(authored_name(callee->graph.name)), made.bindings);
      functions_[callee] = std::move(made);
    }
    needs.add_callee(functions_[callee].bindings);
  }
}

uint32_t ModuleLowering::build(const TypedGraph& graph, std::string name, const Bindings& bindings,
                               const Needs& needs, std::span<const Operand> roots,
                               std::vector<ir::Result> results) {
  const auto index = static_cast<uint32_t>(module_.functions.size());
  ir::Function& function = module_.functions.emplace_back();
  function.name = std::move(name);
  function.document = document_of(graph);
  function.results = std::move(results);
  for (const Binding& binding : bindings) function.parameters.push_back(binding.parameter);

  ir::Builder b(module_, index);
  Environment environment(b, graph, bindings, host_);
  environment.images = &images_.of(graph);
  environment.callee_of = [this](const TypedGraph& callee) -> const Callee& { return functions_.at(&callee); };
  if (nodes_ != nullptr) {
    nodes_->resize(module_.functions.size());
    environment.node_of_origin = &nodes_->back();
  }
  if (environment.surface[shown_position.index()] == ir::none)
    environment.surface[shown_position.index()] = environment.surface[world_position.index()];
  std::vector<ir::ValueId> values;
  for (const Value& value : build_body(b, graph, needs, environment, roots))
    values.insert(values.end(), value.ids().begin(), value.ids().end());
  const std::vector<ir::Result>& wanted = module_.functions[index].results;
  if (wanted.size() == 1 && values.size() == 2) values = {reaches(b, values[0], values[1])};
  for (size_t i = 0; i < values.size(); ++i)
    if (wanted[i].type == ir::vector_type(4) && b.type(values[i]).width == 3)
      values[i] = with_alpha(b, values[i]);
  b.finish(values);
  return index;
}

/// Makes the parameters of a function plain ones, or groups many: no two have one name. `own`: how many come from inputs.
void name_as_arguments(std::vector<Binding>& bindings, size_t own) {
  std::unordered_set<std::string> taken;
  for (size_t i = 0; i < own; ++i) taken.insert(bindings[i].parameter.name);
  for (size_t i = own; i < bindings.size(); ++i) {
    ir::Parameter& parameter = bindings[i].parameter;
    const bool is_image = std::holds_alternative<interface::source::Image>(bindings[i].source);
    if (taken.contains(parameter.name) && !parameter.group.empty() && !is_image)
      parameter.name = parameter.group + "_" + parameter.name;
    while (!taken.insert(parameter.name).second) parameter.name += "_";
    parameter.group.clear();
  }
  if (bindings.size() <= most_plain_inputs) return;
  // A struct holds uniform values, or varying ones.
  std::array<size_t, 2> counts{};
  for (Binding& binding : bindings) {
    const bool uniform = binding.parameter.uniform;
    const size_t number = counts[uniform ? 1 : 0]++ / inputs_of_a_group + 1;
    binding.parameter.group = (uniform ? "uniform_inputs_" : "inputs_") + std::to_string(number);
  }
}

uint32_t ModuleLowering::add_function(const TypedGraph& graph, std::string name, Bindings& bindings, bool is_alone) {
  Needs needs(graph, graph.outputs);
  add_callees(graph, needs);
  declare_hosts(needs);
  if (is_alone) needs.show_mesh();
  const std::vector<std::vector<std::string>> inputs = parameter_names(graph);
  for (uint32_t i = 0; i < inputs.size(); ++i) {
    if (graph.graph.inputs[i].type == Type::filename) continue;
    for (Binding& binding : bind_input(graph, i, inputs[i], "", false)) bindings.push_back(std::move(binding));
  }
  const size_t own = bindings.size();
  add_surface(needs, bindings);
  add_images_and_lights(graph, needs, bindings);
  name_as_arguments(bindings, own);
  std::vector<std::pair<std::string, Type>> outputs;
  for (size_t i = 0; i < graph.outputs.size(); ++i)
    outputs.emplace_back(graph.graph.outputs[i].name, graph.outputs[i].needed);
  const std::vector<std::vector<std::string>> columns = names_of_columns(outputs);
  std::vector<ir::Result> results;
  for (size_t i = 0; i < outputs.size(); ++i)
    for (const std::string& column : columns[i])
      results.push_back({column, nodes::ir_type(outputs[i].second)});
  return build(graph, std::move(name), bindings, needs, graph.outputs, std::move(results));
}

interface::Interface ModuleLowering::add_function_document(const TypedGraph& graph) {
  const std::string name = authored_name(graph.graph.name);
  names_.insert(name);
  Bindings bindings;
  const uint32_t entry = add_function(graph, name, bindings, true);
  return interface_of(entry, std::move(bindings));
}

void ModuleLowering::declare_hosts(const Needs& needs) {
  if (needs.light_at) declare_light_at();
  if (needs.radiance) declare_environment(module_, host_, interface::Host::environment);
  if (needs.irradiance) declare_environment(module_, host_, interface::Host::irradiance);
}

void ModuleLowering::declare_light_at() {
  if (host_.find(interface::Host::light) != ir::none) return;
  host_.host.push_back({interface::Host::light, static_cast<uint32_t>(module_.functions.size())});
  ir::Function& function = module_.functions.emplace_back();
  function.name = names::light_at;
  function.parameters = {{"index", ir::int_type, "", true}, {"position", ir::vector_type(3), "", false}};
  function.results = {{"direction", ir::vector_type(3)}, {"color", ir::vector_type(3)}};
}

void ModuleLowering::declare_picture(const TypedGraph& graph, const Needs& needs) {
  const size_t first = host_.host.size();
  declare_reads(module_, host_, graph, needs.screen);
  for (const interface::HostFunction& read : std::span(host_.host).subspan(first))
    names_.insert(module_.functions[read.function].name);
}

void ModuleLowering::add_surface(const Needs& needs, Bindings& bindings) {
  for (const interface::SurfaceValue value : interface::surface_values())
    if (needs.surface[value.index()]) bindings.push_back(interface::bind(value));
  for (size_t m = 0; m < interface::space_matrix_count; ++m)
    for (uint32_t c = 0; c < needs.columns[m]; ++c)
      bindings.push_back(interface::bind(static_cast<interface::SpaceMatrix>(m), c));
  needs.add_frame(bindings);
}

void ModuleLowering::add_images_and_lights(const TypedGraph& graph, const Needs& needs, Bindings& bindings) {
  const ImageSlots& images = images_.of(graph);
  std::vector<bool> reads(images.slots.size());
  for (const auto& [node, slots] : images.of_node)
    for (const uint32_t slot : slots) reads[slot] = reads[slot] || needs.nodes[node];
  for (uint32_t i = 0; i < reads.size(); ++i)
    if (reads[i]) bindings.push_back(interface::bind_image(i, images.slots[i].name));
  if (needs.lights) bindings.push_back(interface::bind_light_count());
  if (needs.lights && light_lists_) bindings.push_back(interface::bind_first_light());
}

/// What an effect's or a post's parameters are bound to, as far as they are needed.
void ModuleLowering::add_parameters(const TypedGraph& graph, const Needs& needs, Bindings& bindings) const {
  const std::vector<std::vector<std::string>> columns = parameter_names(graph);
  for (uint32_t i = 0; i < columns.size(); ++i) {
    if (!needs.inputs[i]) continue;
    for (Binding& binding : bind_input(graph, i, columns[i], "parameters", true))
      bindings.push_back(std::move(binding));
  }
}

interface::Interface ModuleLowering::add_pass(const TypedGraph& graph, size_t pass, PassPart part,
                                              const std::string& prefix) {
  const std::span<const Operand> roots = outputs_of(graph, pass, part);
  support::assert_that(!roots.empty(), "the pass has no such part");
  Needs needs(graph, roots);
  needs.draw_in(graph.graph, graph.graph.passes[pass].repeat);
  const bool moves = has_part(graph, pass, PassPart::position);
  const std::string name = unique_name(prefix + std::string(function_of(part)));
  declare_picture(graph, needs);
  add_callees(graph, needs);
  declare_hosts(needs);
  if (!moves) needs.show_mesh();

  Bindings bindings;
  add_surface(needs, bindings);
  for (Binding& binding : screen_bindings(graph, needs.screen)) bindings.push_back(std::move(binding));
  add_parameters(graph, needs, bindings);
  add_images_and_lights(graph, needs, bindings);
  const uint32_t entry = build(graph, name, bindings, needs, roots, {result_of(part)});
  return interface_of(entry, std::move(bindings));
}

interface::Interface ModuleLowering::add_post(const TypedGraph& graph) {
  Needs needs(graph, graph.outputs);
  names_.insert(names::post_process);
  declare_picture(graph, needs);
  add_callees(graph, needs);
  declare_hosts(needs);

  Bindings bindings = screen_bindings(graph, needs.screen);
  needs.add_frame(bindings);
  add_parameters(graph, needs, bindings);
  for (Binding& binding : tap_bindings(graph, needs.screen)) bindings.push_back(std::move(binding));
  const uint32_t entry =
      build(graph, names::post_process, bindings, needs, graph.outputs, {{"color", ir::vector_type(4)}});
  return interface_of(entry, std::move(bindings));
}

}  // namespace

bool has_part(const TypedGraph& graph, size_t pass, PassPart part) {
  return !outputs_of(graph, pass, part).empty();
}

Lowered lower(const TypedGraph& graph, const LowerOptions& options) {
  ModuleLowering lowering(options.nodes, options.light_lists);
  interface::Interface made;
  switch (graph.graph.kind) {
    case DocumentKind::function: made = lowering.add_function_document(graph); break;
    case DocumentKind::post: made = lowering.add_post(graph); break;
    case DocumentKind::effect:
    case DocumentKind::scene:
    case DocumentKind::image:
      support::assert_that(options.pass < graph.graph.passes.size(), "the effect has no such pass");
      made = lowering.add_pass(graph, options.pass, options.part);
  }
  return {lowering.take_module(), std::move(made)};
}

LoweredShader lower_shader(const TypedGraph& graph) {
  ModuleLowering lowering(nullptr);
  LoweredShader made;
  switch (graph.graph.kind) {
    case DocumentKind::function:
      made.entries.push_back({.interface = lowering.add_function_document(graph)});
      break;
    case DocumentKind::post: made.entries.push_back({.interface = lowering.add_post(graph)}); break;
    case DocumentKind::effect:
    case DocumentKind::scene:
    case DocumentKind::image:
      const std::vector<graph::Pass>& passes = graph.graph.passes;
      for (size_t i = 0; i < passes.size(); ++i) {
        const std::string prefix = passes.size() > 1 ? passes[i].name + "_" : "";
        for (const PassPart part : pass_parts)
          if (has_part(graph, i, part)) made.entries.push_back({part, i, lowering.add_pass(graph, i, part, prefix)});
      }
  }
  made.module = lowering.take_module();
  return made;
}

}  // namespace isoshade::lower
