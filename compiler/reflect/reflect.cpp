// SPDX-License-Identifier: Apache-2.0
#include "compiler/reflect/reflect.h"

#include <algorithm>

#include "compiler/driver/skipped.h"
#include "compiler/lower/light_sums.h"
#include "compiler/lower/lower.h"
#include "compiler/nodes/site.h"
#include "compiler/passes/passes.h"
#include "compiler/reflect/files.h"
#include "compiler/reflect/proofs.h"
#include "compiler/support/assert.h"
#include "compiler/support/visible.h"
#include "compiler/targets/cpp/cpp.h"

namespace isoshade::reflect {

namespace {

using emit::PureField;
using emit::PureFunction;
using emit::PureKind;
using emit::PureShader;
using interface::HostCall;
using interface::Layout;
namespace place = interface::place;
namespace source = interface::source;

template <class T>
Optional<T> if_any(T value) {
  return value.empty() ? Optional<T>() : Optional<T>(std::move(value));
}

Text ir_type(ir::Type type) { return Text(ir::name(type)); }
SpaceName space_name(interface::Space space) { return {Text(words::spaces()[static_cast<size_t>(space)])}; }

// position_space has the words of spaces.
static_assert(static_cast<int>(graph::PositionSpace::object) == static_cast<int>(interface::Space::object) &&
              static_cast<int>(graph::PositionSpace::view) == static_cast<int>(interface::Space::view));

/// The layouts of a struct, in it and in its fields.
void set_layouts(Struct& made, const std::vector<ir::Type>& types) {
  const auto set = [&](Layout layout, StructSize StructSizes::*whole, Place Places::*part) {
    const interface::StructLayout laid_out = interface::lay_out(types, layout);
    made.bytes.*whole = {laid_out.whole.size, laid_out.whole.alignment};
    for (size_t i = 0; i < types.size(); ++i)
      made.fields[i].bytes.*part = {laid_out.offsets[i], interface::extent_of(types[i], layout).size};
  };
#define LAYOUT(name, doc) set(Layout::name, &StructSizes::name, &Places::name);
  ISOSHADE_LAYOUTS(LAYOUT)
#undef LAYOUT
}

class Reflector {
 public:
  Reflector(const driver::Shader& shader, const ReflectOptions& options)
      : shader_(shader), pure_(shader.pure), graph_(*shader.typed), options_(options) {}

  Reflection reflect() {
    made_.kind.text = graph::kind_name(shader_.kind);
    made_.name = graph_.graph.name;
    made_.doc = if_any(graph_.graph.doc);
    made_.prefix = pure_.prefix;
    made_.precision.text = functions::tier_name(shader_.tier);
    made_.division.text = driver::name(shader_.division);
    for (ReadFile& read : files_of(graph_, options_.files)) made_.files.push_back(std::move(read.file));
    made_.document = made_.files[0].path;
    for (const graph::Input& input : graph_.graph.inputs) made_.parameters.push_back(parameter(input));
    for (const PureKind kind : {PureKind::shade, PureKind::move_vertex, PureKind::post_process}) add_point(kind);
    add_parameters();
    add_images();
    for (const PureFunction& function : pure_.functions) made_.functions.push_back(this->function(function));
    switch (shader_.kind) {
      case graph::DocumentKind::effect: add_passes(); break;
      case graph::DocumentKind::post: add_pictures(); break;
      case graph::DocumentKind::function: add_outputs(); break;
      case graph::DocumentKind::scene:
      case graph::DocumentKind::image: break;
    }
    for (const HostCall call : emit::host_calls(pure_, pure_.functions)) add_host(call);
    if (!options_.pairs.empty()) add_pairs();
    if (made_.lights) made_.black_lights = black_lights();
    for (const driver::Skipped& skipped : driver::skipped_in(shader_)) add_skipped(skipped);
    return std::move(made_);
  }

 private:
  Text cpp_name(std::string_view name) const { return cpp::space(pure_) + "::" + Text(name); }
  Text glsl_name(std::string_view name) const { return emit::name_prefix(pure_) + Text(name); }

  static Parameter parameter(const graph::Input& input) {
    Parameter made;
    made.name = input.name;
    made.type.text = graph::type_name(input.type);
    made.doc = if_any(input.doc);
    if (input.value) made.value = Value{input.type, *input.value};
    made.min = input.min;
    made.max = input.max;
    made.names = if_any(input.names);
    if (input.unit) made.unit = true;
    if (input.dynamic) made.dynamic = true;
    return made;
  }

  Struct& add_struct(StructRole role, std::string_view name, const std::vector<PureField>& fields) {
    Struct made{role, glsl_name(name), cpp_name(name), {}, {}};
    std::vector<ir::Type> types;
    for (const PureField& field : fields) {
      StructField& added = made.fields.emplace_back();
      added.name = field.name;
      added.type.text = ir_type(field.parameter.type);
      added.doc = if_any(field.parameter.doc);
      types.push_back(field.parameter.type);
    }
    set_layouts(made, types);
    made_.structs.push_back(std::move(made));
    return made_.structs.back();
  }

  void add_point(PureKind kind) {
    const std::vector<PureField> fields = emit::point_fields(pure_, kind);
    if (fields.empty()) return;
    Struct& made = add_struct(role_of_point(kind), emit::point_record(kind), fields);
    for (size_t i = 0; i < fields.size(); ++i) set_attribute(made.fields[i], fields[i].parameter.name, kind);
  }

  static StructRole role_of_point(PureKind kind) {
    switch (kind) {
      case PureKind::shade:
      case PureKind::coverage:
      case PureKind::function: return StructRole::surface;
      case PureKind::move_vertex: return StructRole::vertex;
      case PureKind::post_process: return StructRole::screen;
    }
    support::bug("no such point");
  }

  /// What a field of a surface or a vertex holds, by the name of the parameter of a function that takes the same struct.
  void set_attribute(StructField& field, std::string_view name, PureKind kind) const {
    for (const PureFunction& function : pure_.functions) {
      for (const interface::Binding& binding : function.bindings) {
        const auto* read = std::get_if<source::Attribute>(&binding.source);
        if (emit::point_record(function.kind) != emit::point_record(kind) || read == nullptr) continue;
        const auto is = [&](std::string_view suffix) {
          return name == binding.parameter.name + std::string(suffix);
        };
        if (!is("") && !is(passes::ddx_suffix) && !is(passes::ddy_suffix)) continue;
        field.attribute = AttributeName{Text(interface::row(read->value.attribute).name)};
        if (interface::row(read->value.attribute).has_spaces) field.space = space_name(read->value.space);
        if (is(passes::ddx_suffix)) field.change = Direction::x;
        if (is(passes::ddy_suffix)) field.change = Direction::y;
        return;
      }
    }
  }

  /// The value for which a parameter is fixed, as a document would give it.
  Optional<Value> fixed_value(size_t number) const {
    const driver::ParameterBlock& block = shader_.parameters;
    if (shader_.kind == graph::DocumentKind::function || shader_.fixed.empty()) return {};
    const graph::Type type = driver::type_of(block.fields[number]);
    graph::Literal literal;
    if (type == graph::Type::filename) {
      const auto is_without = [&](size_t i) {
        return block.images[i].slot.parameter != block.fields[number].name || shader_.fixed[block.word_of_image(i)];
      };
      bool has_slot = false, all = true;
      for (size_t i = 0; i < block.images.size(); ++i) {
        has_slot |= block.images[i].slot.parameter == block.fields[number].name;
        all &= is_without(i);
      }
      if (!has_slot || !all) return {};
      literal.kind = graph::Literal::Kind::string;
      return Value{type, literal};
    }
    if (!driver::is_fixed(shader_.fixed, block, number)) return {};
    std::vector<float> words;
    for (int i = 0; i < block.fields[number].words; ++i)
      words.push_back(*shader_.fixed[block.word_of(number) + static_cast<size_t>(i)]);
    literal.kind = type == graph::Type::boolean ? graph::Literal::Kind::boolean
                   : words.size() == 1          ? graph::Literal::Kind::number
                                                : graph::Literal::Kind::numbers;
    literal.boolean = words[0] != 0;
    literal.integral = type == graph::Type::integer;
    literal.number = words[0];
    literal.integer = literal.integral ? static_cast<int64_t>(words[0]) : 0;
    if (words.size() > 1) literal.numbers = std::move(words);
    return Value{type, literal};
  }

  void add_parameters() {
    for (size_t i = 0; i < made_.parameters.size(); ++i) made_.parameters[i].fixed = fixed_value(i);
    if (pure_.parameters.empty()) return;
    Struct& made = add_struct(StructRole::parameters, emit::parameters_record, pure_.parameters);
    const std::vector<interface::Binding> bindings = lower::parameter_bindings(graph_);
    support::assert_that(bindings.size() == made.fields.size(), "a field of the parameters has no binding");
    for (size_t i = 0; i < bindings.size(); ++i) {
      StructField& field = made.fields[i];
      if (const auto* input = std::get_if<source::Input>(&bindings[i].source)) {
        field.parameter = made_.parameters[input->input].name;
        field.first = static_cast<Integer>(input->column * bindings[i].parameter.type.width);
        made_.parameters[input->input].fields.push_back(field.name);
      } else {
        const auto* image = std::get_if<source::Image>(&bindings[i].source);
        support::assert_that(image != nullptr, "a field of the parameters holds something else");
        field.image = shader_.parameters.images[image->slot].slot.name;
      }
    }
  }

  void add_images() {
    for (const driver::Image& image : shader_.parameters.images) {
      Image made;
      made.name = image.slot.name;
      made.file = if_any(file_name(graph_, image.file, options_.files));
      made.parameter = if_any(image.slot.parameter);
      made.decoding = decoding(image.slot.decoding);
      made.mips = image.slot.mips;
      made.layers = image.slot.layers;
      for (const lower::Sampling& sampling : image.slot.samplings)
        made.samplings.push_back({{Text(words::filters()[static_cast<size_t>(sampling.filter)])},
                                  {Text(words::wraps()[static_cast<size_t>(sampling.u)])},
                                  {Text(words::wraps()[static_cast<size_t>(sampling.v)])},
                                  parameter_name(sampling.filter_input),
                                  parameter_name(sampling.u_input),
                                  parameter_name(sampling.v_input)});
      for (const Struct& declared : made_.structs)
        for (const StructField& field : declared.fields)
          if (field.image == image.slot.name) made.field = field.name;
      made_.images.push_back(std::move(made));
    }
  }

  /// Of an input that chooses how an image is read.
  std::optional<Text> parameter_name(uint32_t input) const {
    return input == ir::none ? std::nullopt : std::optional<Text>(graph_.graph.inputs[input].name);
  }

  static Decoding decoding(lower::Decoding decoding) {
    switch (decoding) {
      case lower::Decoding::linear: return Decoding::linear;
      case lower::Decoding::srgb: return Decoding::srgb;
      case lower::Decoding::srgb_if_bytes: return Decoding::srgb_if_8_bits;
    }
    support::bug("no such decoding");
  }

  Function function(const PureFunction& function) const {
    const ir::Function& entry = pure_.module.functions[function.entry];
    Function made;
    made.role = role_of(function.kind);
    for (size_t i = 0; i < shader_.passes.size(); ++i) {
      const driver::ShaderPass& pass = shader_.passes[i];
      for (const std::optional<size_t>& part : {std::optional(pass.shade), pass.move_vertex, pass.coverage})
        if (part && &pure_.functions[*part] == &function) made.pass = pass.name;
    }
    made.glsl = emit::function_name(pure_, function, true);
    made.cpp = cpp_name(emit::function_name(pure_, function, false));
    set_arguments(made, function);
    made.returns =
        entry.results.size() == 1 ? ir_type(entry.results[0].type) : glsl_name(emit::results_record);
    const std::vector<PureField> point = emit::point_fields(pure_, function.kind);
    for (size_t i = 0; i < entry.parameters.size(); ++i) {
      if (i >= function.bindings.size()) {  // a derivative
        made.reads.push_back(field_name(point, entry.parameters[i]));
        continue;
      }
      std::visit(
          interface::Cases{
              [&](const place::Point&) { made.reads.push_back(field_name(point, entry.parameters[i])); },
              [&](const place::Parameter&) {
                made.parameters.push_back(field_name(pure_.parameters, entry.parameters[i]));
              },
              [](const place::Argument&) {}, [](const place::Host&) {}, [](const place::Known&) {}},
          place_of(function.bindings[i], function.kind == PureKind::function));
    }
    for (const HostCall call : emit::host_calls(pure_, std::span(&function, 1)))
      made.host.push_back({Text(interface::row(call).name)});
    return made;
  }

  static FunctionRole role_of(PureKind kind) {
    switch (kind) {
      case PureKind::shade: return FunctionRole::shade;
      case PureKind::move_vertex: return FunctionRole::move_vertex;
      case PureKind::coverage: return FunctionRole::coverage;
      case PureKind::post_process: return FunctionRole::process;
      case PureKind::function: return FunctionRole::function;
    }
    support::bug("no such function");
  }

  void set_arguments(Function& made, const PureFunction& function) const {
    for (const Struct& declared : made_.structs)
      if (declared.role == role_of_point(function.kind) || declared.role == StructRole::parameters)
        made.arguments.push_back({declared.glsl, {}, {}, {}});
    if (function.kind != PureKind::function) return;
    for (const interface::Binding& binding : function.bindings) {
      const Text type = ir_type(binding.parameter.type);
      if (const auto* input = std::get_if<source::Input>(&binding.source))
        made.arguments.push_back({type, made_.parameters[input->input].name,
                                  static_cast<Integer>(input->column * binding.parameter.type.width), {}});
      if (const auto* image = std::get_if<source::Image>(&binding.source))
        made.arguments.push_back({type, {}, {}, shader_.parameters.images[image->slot].slot.name});
    }
  }

  static Text field_name(const std::vector<PureField>& fields, const ir::Parameter& parameter) {
    const auto found = std::ranges::find_if(fields, [&](const PureField& field) {
      return field.parameter.name == parameter.name && field.parameter.type == parameter.type;
    });
    support::assert_that(found != fields.end(), parameter.name);
    return found->name;
  }

  void add_passes() {
    for (const driver::ShaderPass& pass : shader_.passes) {
      Pass made;
      made.name = pass.name;
      made.states.state = pass.state;
      if (pass.enabled) made.enabled = shader_.parameters.fields[*pass.enabled].name;
      if (pass.double_sided) made.double_sided = shader_.parameters.fields[*pass.double_sided].name;
      if (pass.blended) made.blended = shader_.parameters.fields[*pass.blended].name;
      made.repeat = shader_.parameters.most_repetitions(pass.repeat);
      if (pass.repeat.parameter) made.repeat_parameter = shader_.parameters.fields[*pass.repeat.parameter].name;
      made.cut_out = pass.coverage.has_value();
      made.casts_shadow = pass.casts_shadow;
      made.receives_shadow = pass.receives_shadow;
      made.moves_vertices = pass.move_vertex.has_value();
      if (made.moves_vertices)
        made.position_space = space_name(static_cast<interface::Space>(pass.position_space));
      made_.passes.push_back(std::move(made));
    }
  }

  void add_pictures() {
    if (shader_.enabled) made_.enabled = shader_.parameters.fields[*shader_.enabled].name;
    std::vector<Text> names{Text(graph::post_output)};
    names.insert(names.end(), shader_.images.begin(), shader_.images.end());
    for (size_t i = 0; i < names.size(); ++i)
      made_.pictures.push_back({names[i], static_cast<Integer>(i), false});
    for (const auto& [name, function] : pure_.host) {
      const auto answer = interface::answer_of(function);
      if (answer && answer->call == HostCall::picture)
        made_.pictures[static_cast<size_t>(answer->image)].read = true;
    }
  }

  void add_outputs() {
    const std::vector<PureField> fields = emit::result_fields(pure_, pure_.functions[0]);
    if (fields.size() > 1) add_struct(StructRole::results, emit::results_record, fields);
    size_t next = 0;
    for (const driver::Field& output : shader_.outputs) {
      Output& made = made_.outputs.emplace_back(Output{output.name, {output.type}, {}});
      const auto columns = static_cast<size_t>(nodes::column_count(driver::type_of(output)));
      for (size_t i = 0; i < columns && fields.size() > 1; ++i) made.fields.push_back(fields[next++].name);
    }
  }

  void add_host(HostCall call) {
    const interface::HostRow& row = interface::row(call);
    made_.lights |= call == HostCall::light_count;
    made_.depth |= call == HostCall::depth;
    made_.host.push_back({{Text(row.name)}, Text(row.result), Text(row.parameters), Text(row.doc)});
  }

  /// Whether a document that asks for lights needs those that are black.
  BlackLights black_lights() const {
    const auto sum = lower::sum_of_black_lights(graph_);
    if (!sum) return {true, "every sum over lights leaves out those whose color is 0"};
    std::string node = support::quote(sum->document->graph.nodes[sum->node].id);
    if (sum->document != &graph_) node += " of " + sum->document->document;
    return {false, node + " sums up what does not depend on the colors of lights"};
  }

  void add_skipped(const driver::Skipped& skipped) {
    support::assert_that(skipped.skip.has_value(), "something is left out of functions for no reason");
    SkippedPart& made = made_.skipped.emplace_back();
    made.skip.text = interface::name(*skipped.skip);
    made.what = skipped.what;
    made.why = skipped.reason;
    made.node = if_any(skipped.of);
    if (skipped.operations > 0) made.operations = skipped.operations;
  }

  void add_pairs() {
    made_.pairs.emplace();
    for (size_t i = 0; i < options_.pairs.size(); ++i) {
      const driver::ForwardPair& pair = options_.pairs[i];
      Pair& made = made_.pairs->emplace_back();
      if (!made_.passes.empty()) made.pass = made_.passes[i].name;
      made.file = pair.stem;
      for (const emit::ForwardLayout::Attribute& attribute : pair.layout.attributes)
        made.attributes.push_back({attribute.name, {attribute.type}, attribute.location, {attribute.vertex}});
      for (const emit::ForwardLayout::Block& block : pair.layout.blocks)
        made.blocks.push_back({block_role(block.block), block.name, block.instance, block.binding, block.size,
                               members_of(block.members)});
      for (const emit::ForwardLayout::Sampler& sampler : pair.layout.samplers)
        made.samplers.push_back({sampler.name, sampler.binding, sampler.image, sampler.layers});
      if (!pair.layout.light.empty())
        made.light =
            LightRecord{pair.layout.light_size, emit::most_forward_lights, members_of(pair.layout.light)};
    }
  }

  static List<BlockMember> members_of(const std::vector<emit::ForwardMember>& members) {
    List<BlockMember> made;
    for (const emit::ForwardMember& member : members)
      made.push_back({member.name, member.type, if_any(member.doc), member.offset});
    return made;
  }

  static BlockRole block_role(emit::ForwardBlock block) {
    switch (block) {
      case emit::ForwardBlock::view: return BlockRole::view;
      case emit::ForwardBlock::object: return BlockRole::object;
      case emit::ForwardBlock::parameters: return BlockRole::parameters;
      case emit::ForwardBlock::lights: return BlockRole::lights;
      case emit::ForwardBlock::screen: return BlockRole::screen;
    }
    support::bug("no such block");
  }

  const driver::Shader& shader_;
  const PureShader& pure_;
  const check::TypedGraph& graph_;
  const ReflectOptions& options_;
  Reflection made_;
};

}  // namespace

List<RecordWords> record_of(const driver::ParameterBlock& block, size_t first) {
  List<RecordWords> record;
  const auto add = [&](Optional<Text> RecordWords::*what, const Text& name, size_t word, int words) {
    if (words == 0) return;  // a file name
    RecordWords& added = record.emplace_back();
    added.*what = name;
    added.first = static_cast<Integer>(first + word);
    added.words = words;
  };
  for (size_t i = 0; i < block.fields.size(); ++i)
    add(&RecordWords::parameter, block.fields[i].name, block.word_of(i), block.fields[i].words);
  for (size_t i = 0; i < block.images.size(); ++i)
    add(&RecordWords::image, block.images[i].slot.name, block.word_of_image(i), 1);
  for (size_t i = 0; i < block.taps.size(); ++i)
    add(&RecordWords::taps, block.taps[i].name, block.word_of_taps(i), 1);
  return record;
}

std::optional<Reflection> reflect(const driver::Shader& shader, const ReflectOptions& options,
                                  support::Diagnostics& diagnostics) {
  Reflection made = Reflector(shader, options).reflect();
  if (!options.prove) return made;
  made.proofs = proofs_of(shader, diagnostics);
  return made.proofs ? std::optional(std::move(made)) : std::nullopt;
}

}  // namespace isoshade::reflect
