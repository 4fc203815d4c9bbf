// SPDX-License-Identifier: Apache-2.0
#include "compiler/lower/lower.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <unordered_map>
#include <unordered_set>

#include "compiler/lower/body.h"
#include "compiler/lower/sampling.h"
#include "compiler/support/assert.h"

namespace isoshade::lower {
namespace {

using check::Operand;
using check::TypedGraph;
using graph::DocumentKind;
using graph::Type;
using nodes::Value;

/// What the stages around authored functions are called: no document takes these names.
constexpr std::string_view names_of_stages[] = {
    shade_name,   move_vertex_name, light_at_name,  texel_at_name,  texture_size_name,
    post_name,    "vertex",         "depth",        "pixel",        "eval",
    "post",       "edges_at",       "edges_at_ddx", "edges_at_ddy", "attribute2",
    "attribute3", "attribute4"};

/// SPIR-V takes 255 parameters of a function, and derivatives may add as many again. A function with more inputs than
/// this takes them in structs.
constexpr size_t most_plain_inputs = 100;
constexpr size_t inputs_of_a_group = 100;

/// A name that neither the stages nor library functions have.
std::string authored_name(const std::string& name) {
  const bool taken = std::ranges::find(names_of_stages, name) != std::end(names_of_stages);
  return taken || name.starts_with("iso_") || name.starts_with(sample_prefix) ? "function_" + name : name;
}

class ModuleLowering {
 public:
  explicit ModuleLowering(NodesOfOrigins* nodes) : nodes_(nodes) {}

  ir::Module lower_function(const TypedGraph& graph) {
    names_.insert(entry_name(graph));
    add_function(graph, entry_name(graph));
    return std::move(module_);
  }
  /// `name`: of the function that gives `root`.
  ir::Module lower_pass(const TypedGraph& graph, const Operand& root, const char* name, ir::Result result);
  ir::Module lower_post(const TypedGraph& graph);

 private:
  struct Parameters {
    ir::Function& function;
    /// Adds one value's parameters, called `names`; returns the index of the first.
    size_t add(const std::vector<std::string>& names, Type type, const std::string& group, bool uniform);
    /// An effect's or post's own parameter, which is known to be within its range.
    size_t add(const graph::Input& input, const std::vector<std::string>& names);
  };

  /// Lowers the documents that the needed nodes call.
  void add_callees(const TypedGraph& graph, const Needs& needs);
  void add_function(const TypedGraph& graph, std::string name);
  std::string unique_name(const std::string& wanted);
  uint32_t declare_light_at();
  std::function<uint32_t(const TypedGraph&)> function_of() {
    return [this](const TypedGraph& callee) { return functions_.at(&callee); };
  }

  /// Of the last function, which is about to be built.
  std::vector<uint32_t>* node_of_origin();

  ir::Module module_;
  NodesOfOrigins* nodes_;
  std::unordered_map<const TypedGraph*, uint32_t> functions_;
  std::unordered_set<std::string> names_;
};

std::string ModuleLowering::unique_name(const std::string& wanted) {
  std::string name = wanted;
  for (int number = 2; !names_.insert(name).second; ++number) name = wanted + "_" + std::to_string(number);
  return name;
}

std::vector<uint32_t>* ModuleLowering::node_of_origin() {
  if (nodes_ == nullptr) return nullptr;
  nodes_->resize(module_.functions.size());
  return &nodes_->back();
}

/// The names of some values beside each other: of each its own, or one a column of a matrix, "m_0", "m_1". No two are
/// alike: columns get out of the way of what is called so itself.
std::vector<std::vector<std::string>> names_of_columns(
    const std::vector<std::pair<std::string, Type>>& values) {
  std::unordered_set<std::string> taken;
  for (const auto& [name, type] : values)
    if (nodes::column_count(type) == 1) taken.insert(name);
  std::vector<std::vector<std::string>> all;
  for (const auto& [name, type] : values) {
    std::vector<std::string>& names = all.emplace_back();
    const int count = nodes::column_count(type);
    if (count == 1) names.push_back(name);
    for (int i = 0; count > 1 && i < count; ++i) {
      std::string column = name + "_" + std::to_string(i);
      while (!taken.insert(column).second) column += "_";
      names.push_back(std::move(column));
    }
  }
  return all;
}

/// The text behind a function says where it comes from; that of a document that has no file says so.
std::string document_of(const TypedGraph& graph) {
  return graph.document.empty() ? "a document without a file" : graph.document;
}

/// Takes a value's parameters from the function's, beginning with `first`.
Value parameter_value(ir::Builder& b, size_t first, Type type) {
  std::array<ir::ValueId, 4> ids;
  const size_t count = nodes::column_count(type);
  for (size_t i = 0; i < count; ++i) ids[i] = b.parameter(first + i);
  return Value(std::span<const ir::ValueId>(ids).first(count));
}

/// A colour with alpha 1 if it has none.
ir::ValueId with_alpha(ir::Builder& b, ir::ValueId color) {
  if (b.type(color).width == 4) return color;
  return b.construct(
      std::array{b.extract(color, 0), b.extract(color, 1), b.extract(color, 2), b.constant(1.0f)});
}

size_t ModuleLowering::Parameters::add(const std::vector<std::string>& names, Type type,
                                       const std::string& group, bool uniform) {
  const size_t first = function.parameters.size();
  for (const std::string& name : names)
    function.parameters.push_back({name, nodes::ir_type(type), group, uniform});
  return first;
}

size_t ModuleLowering::Parameters::add(const graph::Input& input, const std::vector<std::string>& names) {
  const size_t first = add(names, input.type, "parameters", true);
  const bool is_integer = input.type == Type::integer;
  constexpr float most_exact = 0x1p24f, largest = std::numeric_limits<float>::max();
  float least = input.min.value_or(-largest), most = input.max.value_or(largest);
  if (!input.names.empty()) least = 0;
  if (!input.names.empty()) most = static_cast<float>(input.names.size() - 1);
  // Floats tell large integers only nearly.
  const bool tells = !is_integer || (least >= -most_exact && most <= most_exact);
  for (size_t i = first; i < function.parameters.size() && tells && input.type != Type::boolean; ++i) {
    function.parameters[i].least = least;
    function.parameters[i].most = most;
  }
  return first;
}

void ModuleLowering::add_callees(const TypedGraph& graph, const Needs& needs) {
  for (size_t i = 0; i < graph.nodes.size(); ++i) {
    const TypedGraph* callee = graph.nodes[i].callee.get();
    if (!needs.nodes[i] || callee == nullptr || functions_.contains(callee)) continue;
    add_function(*callee, unique_name(authored_name(callee->graph.name)));
  }
}

void ModuleLowering::add_function(const TypedGraph& graph, std::string name) {
  const Needs needs(graph, graph.outputs);
  add_callees(graph, needs);
  const auto index = static_cast<uint32_t>(module_.functions.size());
  functions_[&graph] = index;
  ir::Function& function = module_.functions.emplace_back();
  function.name = std::move(name);
  function.document = document_of(graph);
  Parameters parameters{function};
  std::vector<size_t> first;
  const std::vector<std::vector<std::string>> names = parameter_names(graph);
  size_t count = 0;
  for (const std::vector<std::string>& columns : names) count += columns.size();
  for (size_t i = 0; i < names.size(); ++i) {
    const size_t number = function.parameters.size() / inputs_of_a_group + 1;
    const std::string group = count > most_plain_inputs ? "inputs_" + std::to_string(number) : "";
    first.push_back(parameters.add(names[i], graph.graph.inputs[i].type, group, false));
  }
  std::vector<std::pair<std::string, Type>> outputs;
  for (size_t i = 0; i < graph.outputs.size(); ++i)
    outputs.emplace_back(graph.graph.outputs[i].name, graph.outputs[i].needed);
  const std::vector<std::vector<std::string>> results_of = names_of_columns(outputs);
  for (size_t i = 0; i < outputs.size(); ++i)
    for (const std::string& column : results_of[i])
      function.results.push_back({column, nodes::ir_type(outputs[i].second)});

  ir::Builder b(module_, index);
  Environment environment;
  for (size_t i = 0; i < first.size(); ++i)
    environment.inputs.push_back(parameter_value(b, first[i], graph.graph.inputs[i].type));
  environment.function_of = function_of();
  environment.node_of_origin = node_of_origin();
  std::vector<ir::ValueId> results;
  for (const Value& value : build_body(b, graph, needs, environment, graph.outputs))
    results.insert(results.end(), value.ids().begin(), value.ids().end());
  b.finish(results);
}

uint32_t ModuleLowering::declare_light_at() {
  ir::Function& function = module_.functions.emplace_back();
  function.name = light_at_name;
  function.parameters = {{"index", ir::int_type, "", true}, {"position", ir::vector_type(3), "", false}};
  function.results = {{"direction", ir::vector_type(3)}, {"color", ir::vector_type(3)}};
  return static_cast<uint32_t>(module_.functions.size() - 1);
}

ir::Module ModuleLowering::lower_pass(const TypedGraph& graph, const Operand& root, const char* name,
                                      ir::Result wanted) {
  const std::span<const Operand> roots(&root, 1);
  const Needs needs(graph, roots);
  names_.insert(name);
  add_callees(graph, needs);
  Environment environment;
  environment.function_of = function_of();
  if (needs.light_at) environment.light_at = declare_light_at();

  const auto index = static_cast<uint32_t>(module_.functions.size());
  ir::Function& function = module_.functions.emplace_back();
  function.name = name;
  function.document = document_of(graph);
  function.results = {wanted};
  for (const SurfaceField& field : surface_fields())
    if (needs.surface[field.value.index()])
      function.parameters.push_back({field.name, field.type, "surface", false});
  for (size_t m = 0; m < space_matrix_count; ++m) {
    for (size_t c = 0; c < needs.columns[m]; ++c)
      function.parameters.push_back(
          {std::string(space_matrix_names[m]) + "_" + std::to_string(c), ir::vector_type(3), "spaces", true});
  }
  if (needs.time) function.parameters.push_back({"time", ir::float_type, "frame", true});
  Parameters parameters{function};
  std::vector<size_t> first(graph.graph.inputs.size());
  const std::vector<std::vector<std::string>> names = parameter_names(graph);
  for (size_t i = 0; i < first.size(); ++i)
    if (needs.inputs[i]) first[i] = parameters.add(graph.graph.inputs[i], names[i]);
  const ImageSlots images = image_slots(graph);
  std::vector<bool> reads(images.slots.size());
  for (size_t i = 0; i < graph.nodes.size(); ++i)
    if (needs.nodes[i] && graph.nodes[i].row != nullptr && graph.nodes[i].row->is<nodes::Image>())
      reads[images.of_node[i]] = true;
  for (size_t i = 0; i < reads.size(); ++i)
    if (reads[i]) function.parameters.push_back({images.slots[i].name, ir::int_type, "images", true});
  if (needs.lights) function.parameters.push_back({"light_count", ir::int_type, "", true});
  const size_t last = function.parameters.size() - 1;

  ir::Builder b(module_, index);
  size_t next = 0;
  for (const SurfaceField& field : surface_fields())
    if (needs.surface[field.value.index()]) environment.surface[field.value.index()] = b.parameter(next++);
  for (size_t m = 0; m < space_matrix_count; ++m)
    for (size_t c = 0; c < needs.columns[m]; ++c) environment.matrices[m][c] = b.parameter(next++);
  if (needs.time) environment.time = b.parameter(next++);
  for (size_t i = 0; i < first.size(); ++i) {
    environment.inputs.push_back(needs.inputs[i] ? parameter_value(b, first[i], graph.graph.inputs[i].type)
                                                 : Value());
    if (needs.inputs[i]) next += static_cast<size_t>(nodes::column_count(graph.graph.inputs[i].type));
  }
  environment.images = &images;
  for (const bool read : reads) environment.image_slots.push_back(read ? b.parameter(next++) : ir::none);
  if (needs.lights) environment.light_count = b.parameter(last);
  environment.node_of_origin = node_of_origin();
  const ir::ValueId result = build_body(b, graph, needs, environment, roots)[0].id();
  b.finish(std::array{root.needed == Type::color3 ? with_alpha(b, result) : result});
  return std::move(module_);
}

ir::Module ModuleLowering::lower_post(const TypedGraph& graph) {
  const Needs needs(graph, graph.outputs);
  for (std::string& name : screen_function_names(graph)) names_.insert(std::move(name));
  add_callees(graph, needs);
  declare_reads(module_, graph, needs.screen);

  const auto index = static_cast<uint32_t>(module_.functions.size());
  ir::Function function;
  function.name = post_name;
  function.document = document_of(graph);
  function.results = {{"color", ir::vector_type(4)}};
  add_screen_parameters(function, graph, needs.screen);
  const size_t time = function.parameters.size();
  if (needs.time) function.parameters.push_back({"time", ir::float_type, "frame", true});
  Parameters parameters{function};
  std::vector<size_t> first(graph.graph.inputs.size());
  const std::vector<std::vector<std::string>> names = parameter_names(graph);
  for (size_t i = 0; i < first.size(); ++i)
    if (needs.inputs[i]) first[i] = parameters.add(graph.graph.inputs[i], names[i]);
  add_tap_parameters(function, graph, needs.screen);
  module_.functions.push_back(std::move(function));

  ir::Builder b(module_, index);
  Environment environment;
  environment.function_of = function_of();
  environment.screen = screen_inputs(b, graph, needs.screen);
  if (needs.time) environment.time = b.parameter(time);
  for (size_t i = 0; i < first.size(); ++i) {
    environment.inputs.push_back(needs.inputs[i] ? parameter_value(b, first[i], graph.graph.inputs[i].type)
                                                 : Value());
  }
  environment.node_of_origin = node_of_origin();
  const Value color = build_body(b, graph, needs, environment, graph.outputs)[0];
  b.finish(std::array{with_alpha(b, color.id())});
  return std::move(module_);
}

}  // namespace

const std::vector<SurfaceField>& surface_fields() {
  static const std::vector<SurfaceField> fields = [] {
    using nodes::Space;
    using nodes::Surface;
    struct Attribute {
      std::string_view name;
      Surface what;
      int width;
      bool has_space;
    };
    std::vector<SurfaceField> all;
    for (const Attribute& attribute : {Attribute{"position", Surface::position, 3, true},
                                       {"normal", Surface::normal, 3, true},
                                       {"texcoord", Surface::texcoord, 2, false},
                                       {"view_direction", Surface::view_direction, 3, true},
                                       {"tangent", Surface::tangent, 3, true},
                                       {"bitangent", Surface::bitangent, 3, true},
                                       {"color", Surface::color, 4, false},
                                       {"outline_normal", Surface::outline_normal, 3, true},
                                       {"pixel_size", Surface::pixel_size, 1, false},
                                       {"corner_normal1", Surface::corner_normal1, 3, true},
                                       {"corner_normal2", Surface::corner_normal2, 3, true},
                                       {"corner_normal3", Surface::corner_normal3, 3, true}}) {
      const ir::Type type = ir::vector_type(attribute.width);
      const std::string name(attribute.name);
      all.push_back({name, {attribute.what}, type});
      if (!attribute.has_space) continue;
      all.push_back({name + "_object", {attribute.what, Space::object}, type});
      all.push_back({name + "_view", {attribute.what, Space::view}, type});
    }
    return all;
  }();
  return fields;
}

std::vector<std::vector<std::string>> parameter_names(const TypedGraph& graph) {
  std::vector<std::pair<std::string, Type>> inputs;
  for (const graph::Input& input : graph.graph.inputs) inputs.emplace_back(input.name, input.type);
  return names_of_columns(inputs);
}

std::string entry_name(const TypedGraph& graph) {
  if (graph.graph.kind == DocumentKind::function) return authored_name(graph.graph.name);
  return graph.graph.kind == DocumentKind::post ? post_name : shade_name;
}

ir::Module lower(const TypedGraph& graph, const LowerOptions& options) {
  if (graph.graph.kind == DocumentKind::function) return ModuleLowering(options.nodes).lower_function(graph);
  if (graph.graph.kind == DocumentKind::post) return ModuleLowering(options.nodes).lower_post(graph);
  support::assert_that(options.pass < graph.graph.passes.size(), "the effect has no such pass");
  const Operand* position = graph.position_of(options.pass);
  if (options.part == PassPart::color) {
    return ModuleLowering(options.nodes)
        .lower_pass(graph, graph.outputs[options.pass], shade_name, {"color", ir::vector_type(4)});
  }
  support::assert_that(position != nullptr, "the pass moves no vertices");
  return ModuleLowering(options.nodes)
      .lower_pass(graph, *position, move_vertex_name, {"position", ir::vector_type(3)});
}

}  // namespace isoshade::lower
