// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/driver.h"

#include <algorithm>

#include "compiler/check/check.h"
#include "compiler/check/stage_needs.h"
#include "compiler/driver/dumps.h"
#include "compiler/driver/finish.h"
#include "compiler/driver/shader.h"
#include "compiler/graph/extend.h"
#include "compiler/ir/expansion.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/lower/lower.h"
#include "compiler/lower/screen.h"
#include "compiler/passes/passes.h"
#include "compiler/passes/pipeline.h"
#include "compiler/prove/lights.h"
#include "compiler/support/visible.h"
#include "compiler/targets/cpp/cpp.h"

namespace isoshade::driver {

namespace {

using support::Diagnostics;

/// JSON text -> Document -> Graph -> TypedGraph. Reports a document that is not of kind `wanted`, if given.
std::shared_ptr<const check::TypedGraph> read_graph(const support::Source& source,
                                                    std::optional<graph::DocumentKind> wanted,
                                                    const CompileOptions& options, Diagnostics& diagnostics) {
  const auto document = graph::load_document(source, options.library->files(), diagnostics);
  if (!document) return nullptr;
  if (options.dump) options.dump("document", [&] { return dump_document(*document); });
  auto graph = graph::build_graph(*document, diagnostics);
  if (!graph) return nullptr;
  if (options.dump) options.dump("graph", [&] { return dump_graph(*graph); });
  if (wanted && graph->kind != *wanted) {
    diagnostics.report(support::Id::wrong_kind,
                       document->span(*document->root.find(graph::kind_name(graph->kind))),
                       "this is a document of kind \"" + std::string(graph::kind_name(graph->kind)) +
                           "\", but \"" + std::string(graph::kind_name(*wanted)) + "\" is needed here");
    return nullptr;
  }
  auto typed = check::check(std::move(*graph), *options.library, diagnostics);
  if (typed == nullptr) return nullptr;
  if (options.dump) options.dump("typed", [&] { return dump_typed(*typed); });
  return typed;
}

int words_of(graph::Type type) {
  const bool one = type == graph::Type::boolean || type == graph::Type::integer;
  return one ? 1 : graph::float_count(type);
}

Field field(const std::string& name, graph::Type type) {
  return {name, std::string(graph::type_name(type)), words_of(type), {}, {}, {}};
}

graph::Type graph_type(ir::Type type) {
  constexpr graph::Type floats[] = {graph::Type::floating, graph::Type::vector2, graph::Type::vector3,
                                    graph::Type::vector4};
  if (type == ir::bool_type) return graph::Type::boolean;
  return type == ir::int_type ? graph::Type::integer : floats[type.width - 1];
}

/// The words of a parameter's value in a record: floats, also for booleans (0, 1) and integers.
std::vector<float> record_words(const graph::Literal& literal, int words) {
  if (literal.kind == graph::Literal::Kind::boolean) return {literal.boolean ? 1.0f : 0.0f};
  if (literal.kind == graph::Literal::Kind::numbers) return literal.numbers;
  return std::vector<float>(static_cast<size_t>(words), literal.number);
}

/// Without defaults.
std::vector<Field> input_fields(const check::TypedGraph& typed) {
  std::vector<Field> fields;
  for (const graph::Input& input : typed.graph.inputs) {
    fields.push_back(field(input.name, input.type));
    fields.back().min = input.min;
    fields.back().max = input.max;
    fields.back().names = input.names;
    fields.back().dynamic = input.dynamic;
  }
  return fields;
}

std::vector<Field> output_fields(const check::TypedGraph& typed) {
  std::vector<Field> fields;
  for (size_t i = 0; i < typed.graph.outputs.size(); ++i)
    fields.push_back(field(typed.graph.outputs[i].name, typed.outputs[i].type));
  return fields;
}

std::vector<Field> parameters_of(const check::TypedGraph& typed) {
  std::vector<Field> fields = input_fields(typed);
  for (size_t i = 0; i < fields.size(); ++i)
    fields[i].value = record_words(*typed.graph.inputs[i].value, fields[i].words);
  return fields;
}

std::vector<Image> images_of(const check::TypedGraph& typed) {
  std::vector<Image> images;
  for (lower::ImageSlot& slot : lower::image_slots(typed).slots) {
    const std::string file = slot.path.empty() ? "" : graph::path_beside(slot.place.file->path(), slot.path);
    images.push_back({std::move(slot), file});
  }
  return images;
}

/// The layout of a block in a record, in which it begins at word `first`. `sums` are the sums of the block's taps.
interface::RecordLayout layout_of(const ParameterBlock& block, const std::vector<lower::TapSum>& sums,
                                  size_t first) {
  interface::RecordLayout layout;
  for (size_t i = 0; i < block.fields.size(); ++i) {
    const bool has_words = block.fields[i].words > 0;  // filenames have none
    layout.inputs.push_back(has_words ? static_cast<int>(first + block.word_of(i)) : -1);
  }
  for (size_t i = 0; i < block.images.size(); ++i)
    layout.images.push_back(static_cast<int>(first + block.word_of_image(i)));
  for (size_t i = 0; i < sums.size(); ++i)
    layout.taps.emplace_back(sums[i].node, static_cast<int>(first + block.word_of_taps(i)));
  return layout;
}
interface::RecordLayout layout_of(const Effect& effect) {
  interface::RecordLayout layout = layout_of(effect.parameters, {}, lower::object_word::parameters);
  layout.previous = static_cast<int>(lower::object_word::parameters + effect.parameters.word_count());
  return layout;
}

/// Behind the columns of the frame before, also where there are none: which programs read them shows only later.
uint32_t first_draw_word(const Effect& effect) {
  constexpr size_t columns = 12;
  return static_cast<uint32_t>(static_cast<size_t>(layout_of(effect).previous) + columns);
}

bool reads_previous(const Program& program) {
  return std::ranges::any_of(program.bindings, [](const interface::Binding& binding) {
    const auto* attribute = std::get_if<interface::source::Attribute>(&binding.source);
    return attribute != nullptr && attribute->value.attribute == interface::Surface::previous_position;
  });
}

/// Lowers a document into a module with the buffers that kernels load from.
lower::Lowered lower_with_buffers(const check::TypedGraph& typed, const lower::LowerOptions& options = {}) {
  lower::Lowered lowered = lower::lower(typed, options);
  lowered.module.buffers = lower::frame_module().buffers;
  return lowered;
}

/// Names the words of a block in the texts that load them; `first` words of the record stand before it.
void name_words(ir::Module& module, const ParameterBlock& block, size_t first) {
  ir::Buffer& objects = module.buffers[static_cast<size_t>(lower::FrameBuffer::objects)];
  if (first == 0) objects.fields.clear();
  objects.one_record = first == 0;
  const auto add = [&](std::string name, size_t word, int words) {
    objects.fields.push_back(
        {std::move(name), static_cast<uint32_t>(first + word), static_cast<uint32_t>(words)});
  };
  for (size_t i = 0; i < block.fields.size(); ++i)
    if (block.fields[i].words > 0)
      add("parameter_" + block.fields[i].name, block.word_of(i), block.fields[i].words);
  for (size_t i = 0; i < block.images.size(); ++i)
    add("image_" + block.images[i].slot.name, block.word_of_image(i), 1);
  for (size_t i = 0; i < block.taps.size(); ++i) add("taps_" + block.taps[i].name, block.word_of_taps(i), 1);
}

/// The words of a program's values, behind those that other programs have in the same record.
uint32_t draw_words(const Program& program) { return program.draw == nullptr ? 0 : program.draw->words; }

/// What a part of a pass needs before there is a kernel around it.
void prepare(lower::Lowered& lowered, const check::TypedGraph& typed, size_t pass, const Effect& effect,
             const CompileOptions& options) {
  name_words(lowered.module, effect.parameters, lower::object_word::parameters);
  fix_parameters(lowered.module, lowered.interface, effect.parameters, options.fixed, &typed.graph.passes[pass].repeat);
}

Program vertex_program(const check::TypedGraph& typed, size_t pass, const Effect& effect,
                       const CompileOptions& options, uint32_t room) {
  if (typed.position_of(pass) == nullptr && !options.dump) {
    Program program = plain_vertex_program();
    program.name = typed.graph.name;
    program.document = typed.document;
    program.source = typed.graph.source;
    set_number(program);
    return program;
  }
  Program program{lower::Stage::vertex, typed.graph.name, typed.document, lower::frame_module(), 0, {}, {}};
  if (typed.position_of(pass) == nullptr) {
    finish(program, lower::add_vertex_kernel(program.module), options, typed.graph.source);
    return program;
  }
  lower::Lowered lowered = lower_with_buffers(typed, {pass, lower::PassPart::position});
  prepare(lowered, typed, pass, effect, options);
  const uint32_t kernel = lower::add_moving_vertex_kernel(
      lowered.module, lowered.interface, layout_of(effect), typed.graph.passes[pass].position_space);
  program.module = std::move(lowered.module);
  program.bindings = std::move(lowered.interface.bindings);
  finish(program, kernel, options, typed.graph.source, room);
  return program;
}

/// The pixel program, or if it is `blended` the one of Stage::blend.
Program pixel_program(const check::TypedGraph& typed, size_t pass, const Effect& effect,
                      const CompileOptions& options, uint32_t room, bool blended = false) {
  lower::Lowered lowered = lower_with_buffers(typed, {.pass = pass, .light_lists = options.lights.lists});
  prepare(lowered, typed, pass, effect, options);
  lower::LightKinds lights = options.lights;
  lights.shadows &= typed.graph.passes[pass].receives_shadow;
  const interface::Blend blend = typed.graph.passes[pass].state.blend;
  const uint32_t kernel =
      blended ? lower::add_blend_kernel(lowered.module, lowered.interface, layout_of(effect), lights, blend)
              : lower::add_pixel_kernel(lowered.module, lowered.interface, layout_of(effect), lights);
  const lower::Stage stage = blended ? lower::Stage::blend : lower::Stage::pixel;
  Program program{stage, typed.graph.name, typed.document, std::move(lowered.module), 0, {}, {}, options.tier};
  program.bindings = std::move(lowered.interface.bindings);
  finish(program, kernel, options, typed.graph.source, room);
  return program;
}

/// The index of the parameter that is the cutoff of a pass; none if another value is, or if it has no cutoff.
std::optional<size_t> cutoff_parameter(const check::TypedGraph& typed, size_t pass) {
  const std::span<const check::Operand> cutout = typed.cutout_of(pass);
  const bool is_parameter = cutout.size() > 1 && cutout[1].from == check::Operand::From::input;
  return is_parameter && cutout[1].swizzle_count == 0 ? std::optional<size_t>(cutout[1].index) : std::nullopt;
}

std::optional<Program> cutout_program(const check::TypedGraph& typed, size_t pass, const Effect& effect,
                                      const CompileOptions& options, uint32_t room) {
  if (!lower::has_part(typed, pass, lower::PassPart::coverage)) return std::nullopt;
  lower::Lowered lowered = lower_with_buffers(typed, {pass, lower::PassPart::coverage});
  prepare(lowered, typed, pass, effect, options);
  const uint32_t kernel = lower::add_cutout_kernel(lowered.module, lowered.interface, layout_of(effect));
  Program program{lower::Stage::cutout, typed.graph.name, typed.document, std::move(lowered.module), 0, {}, {}};
  program.bindings = std::move(lowered.interface.bindings);
  finish(program, kernel, options, typed.graph.source, room);
  return program;
}

}  // namespace

std::optional<graph::DocumentKind> kind_of(const support::Source& source, Diagnostics& diagnostics) {
  const auto document = graph::parse_document(source, diagnostics);
  return document ? graph::document_kind(*document, diagnostics) : std::nullopt;
}

std::shared_ptr<const check::TypedGraph> check_document(const support::Source& source,
                                                        const CompileOptions& options,
                                                        Diagnostics& diagnostics) {
  return read_graph(source, std::nullopt, options, diagnostics);
}

std::optional<Effect> check_effect(const support::Source& source, const CompileOptions& options,
                                   Diagnostics& diagnostics) {
  const auto typed = read_graph(source, graph::DocumentKind::effect, options, diagnostics);
  if (typed == nullptr) return std::nullopt;
  Effect effect{typed->graph.name, typed->document, {parameters_of(*typed), images_of(*typed), {}}, {}, false,
                environment_reads(*typed), typed};
  for (size_t i = 0; i < typed->graph.passes.size(); ++i) {
    const graph::Pass& pass = typed->graph.passes[i];
    const bool lists_lights = options.lights.lists && prove::judge_black_lights(*typed, i, options.tier).add_nothing;
    effect.passes.push_back({pass.name, pass.state, pass.position.has_value(), false, pass.enabled,
                             pass.double_sided, pass.blended, lists_lights, cutoff_parameter(*typed, i),
                             pass.casts_shadow, pass.casts_blended_shadow, false, pass.receives_shadow, pass.repeat, {}, {},
                             {}, {}});
  }
  return effect;
}

void make_programs(Effect& effect, const CompileOptions& options) {
  const check::TypedGraph& typed = *effect.typed;
  effect.fixed = options.fixed;
  for (size_t i = 0; i < effect.passes.size(); ++i) {
    EffectPass& made = effect.passes[i];
    CompileOptions of_pass = options;
    of_pass.lights.lists &= made.black_lights_add_nothing;
    uint32_t room = first_draw_word(effect);
    made.vertex = vertex_program(typed, i, effect, options, room);
    room += draw_words(made.vertex);
    made.cutout = cutout_program(typed, i, effect, options, room);
    if (made.cutout) room += draw_words(*made.cutout);
    made.pixel = pixel_program(typed, i, effect, of_pass, room);
    effect.reads_previous |= reads_previous(made.vertex) || reads_previous(made.pixel) ||
                             (made.cutout && reads_previous(*made.cutout));
    made.sums_lights = std::ranges::any_of(made.pixel.bindings, [](const interface::Binding& binding) {
      return std::holds_alternative<interface::source::LightCount>(binding.source);
    });
    made.receives_shadow &= made.sums_lights;
    if (made.state.blend != interface::Blend::none) made.blend = pixel_program(typed, i, effect, of_pass, room, true);
    room += std::max(draw_words(made.pixel), made.blend ? draw_words(*made.blend) : 0);
    effect.draw_words = std::max(effect.draw_words, room - first_draw_word(effect));
    if (!made.blend) continue;
    made.reads_scene = std::ranges::any_of(made.blend->bindings, [](const interface::Binding& binding) {
      return std::holds_alternative<interface::source::PixelOfImage>(binding.source);
    });
  }
}

std::optional<Effect> compile_effect(const support::Source& source, const CompileOptions& options,
                                     Diagnostics& diagnostics) {
  auto effect = check_effect(source, options, diagnostics);
  if (effect) make_programs(*effect, options);
  return effect;
}

std::optional<Post> check_post(const support::Source& source, const CompileOptions& options,
                               Diagnostics& diagnostics) {
  const auto typed = read_graph(source, graph::DocumentKind::post, options, diagnostics);
  if (typed == nullptr) return std::nullopt;
  Post post;
  post.name = typed->graph.name;
  post.document = typed->document;
  post.parameters = {parameters_of(*typed), {}, {}};
  post.enabled = typed->graph.enabled;
  post.typed = typed;
  if (options.lights.environment.value_or(true)) post.environment = environment_reads(*typed);
  for (const graph::InputImage& image : typed->graph.images) {
    if (image.name == graph::motion_image_name) post.motion = post.images.size();
    post.images.push_back(image.name);
  }
  for (const lower::TapSum& sum : lower::tap_sums(*typed)) {
    post.parameters.taps.push_back(field(typed->graph.nodes[sum.node].id, graph::Type::integer));
    post.parameters.taps.back().value = {static_cast<float>(sum.taps)};
  }
  return post;
}

void make_program(Post& post, const CompileOptions& options) {
  const check::TypedGraph& typed = *post.typed;
  lower::Lowered lowered = lower_with_buffers(typed);
  const interface::Interface& interface = lowered.interface;
  post.reads.clear();
  for (size_t i = 0; i <= post.images.size(); ++i)
    post.reads.push_back(interface.find(interface::Host::image, lower::post_image(i)) != ir::none);
  post.reads_depth = interface.find(interface::Host::depth, lower::depth_image) != ir::none;
  post.is_pointwise = lower::is_pointwise(lowered);
  post.fixed = options.fixed;
  fix_parameters(lowered.module, lowered.interface, post.parameters, options.fixed);
  name_words(lowered.module, post.parameters, 0);
  const uint32_t kernel = lower::add_post_kernel(lowered.module, interface,
                                                 layout_of(post.parameters, lower::tap_sums(typed), 0), options.lights);
  post.program = {lower::Stage::post, post.name, post.document, std::move(lowered.module), 0, {}, {},
                  options.tier};
  post.program.bindings = std::move(lowered.interface.bindings);
  finish(post.program, kernel, options, typed.graph.source, static_cast<uint32_t>(post.parameters.word_count()));
}

std::optional<Post> compile_post(const support::Source& source, const CompileOptions& options,
                                 Diagnostics& diagnostics) {
  auto post = check_post(source, options, diagnostics);
  if (post) make_program(*post, options);
  return post;
}

std::optional<Program> compile_function(const support::Source& source, const CompileOptions& options,
                                        Diagnostics& diagnostics) {
  const auto typed = read_graph(source, graph::DocumentKind::function, options, diagnostics);
  if (typed == nullptr || !check::stands_alone(*typed, diagnostics)) return std::nullopt;
  lower::Lowered lowered = lower_with_buffers(*typed);
  Program program{
      lower::Stage::eval, typed->graph.name, typed->document, std::move(lowered.module), 0, {}, {},
      options.tier};
  program.bindings = std::move(lowered.interface.bindings);
  finish(program, lower::add_eval_kernel(program.module, lowered.interface.entry), options,
         typed->graph.source);
  program.inputs = input_fields(*typed);
  program.results = output_fields(*typed);
  return program;
}

std::string pass_stem(const std::string& effect, const std::string& pass, size_t number) {
  // Two names of 128 characters with an extension exceed the length limit of file names. Long names are therefore cut,
  // and the number of the pass keeps them unique ("." is in no name).
  constexpr size_t limit = 200;
  const std::string stem = effect + "." + pass;
  if (stem.size() <= limit) return stem;
  return effect.substr(0, 96) + "." + pass.substr(0, 96) + "." + std::to_string(number);
}

std::optional<Shader> compile_shader(const support::Source& source, const CompileOptions& options,
                                     const ShaderOptions& shader_options, Diagnostics& diagnostics) {
  const std::string& wanted = shader_options.prefix;
  if (!wanted.empty() && !graph::is_id(wanted)) {
    diagnostics.report(support::Id::bad_id, support::quote(wanted) +
                                                " is not a valid prefix: it must match [A-Za-z_][A-Za-z0-9_]{0,127}");
    return std::nullopt;
  }
  const auto typed = read_graph(source, std::nullopt, options, diagnostics);
  if (typed == nullptr) return std::nullopt;
  const graph::Graph& graph = typed->graph;
  Shader shader;
  shader.typed = typed;
  shader.kind = graph.kind;
  shader.tier = options.tier;
  emit::PureShader& pure = shader.pure;
  pure.name = graph.name;
  pure.document = typed->document;
  pure.prefix = emit::prefix_of(wanted.empty() ? graph.name : wanted);
  if (const std::string made = emit::name_prefix(pure); !wanted.empty() && made != wanted && made != wanted + "_") {
    diagnostics.report(support::Id::bad_id, "names cannot begin with " + support::quote(wanted))
        .suggest("--prefix " + pure.prefix);
    return std::nullopt;
  }
  if (options.tier != functions::Tier::standard) pure.tier = functions::tier_name(options.tier);

  lower::LoweredShader lowered = lower::lower_shader(*typed);
  if (graph.kind != graph::DocumentKind::function) shader.parameters = {parameters_of(*typed), images_of(*typed), {}};
  const bool is_effect = graph.kind == graph::DocumentKind::effect;
  for (lower::ShaderEntry& entry : lowered.entries) {
    const interface::Repeat* repeat = is_effect ? &graph.passes[entry.pass].repeat : nullptr;
    fix_parameters(lowered.module, entry.interface, shader.parameters, options.fixed, repeat);
  }
  shader.fixed = options.fixed;
  passes::Entries entries{};
  entries.are_linked = true;
  for (const lower::ShaderEntry& entry : lowered.entries) {
    entries.functions.push_back(entry.interface.entry);
    for (const interface::HostFunction& host : entry.interface.host)
      pure.host[lowered.module.functions[host.function].name] = host;
  }
  pure.host[interface::names::light_at_change] = {interface::Host::light_change};
  const auto dump = [&](std::string_view pass, const ir::Module& after) {
    options.dump(pass, [&] { return dump_module(after); });
  };
  if (options.dump) dump("lower", lowered.module);
  const passes::Dump dump_pass = options.dump ? passes::Dump(dump) : passes::Dump();
  passes::run(passes::optimisations(), lowered.module, entries, options.tier, dump_pass, false, options.skips);
  if (shader_options.division == Division::exact)
    passes::run(passes::division_lowering(), lowered.module, entries, options.tier, dump_pass);
  // What only other values of the fixed parameters read is nothing to ask for.
  for (size_t i = 0; i < lowered.entries.size() && !options.fixed.empty(); ++i)
    drop_unread(lowered.module.functions[entries[i]], lowered.entries[i].interface);
  pure.module = std::move(lowered.module);

  for (size_t i = 0; i < lowered.entries.size(); ++i) {
    const lower::ShaderEntry& entry = lowered.entries[i];
    emit::PureKind kind{};
    switch (graph.kind) {
      case graph::DocumentKind::function: kind = emit::PureKind::function; break;
      case graph::DocumentKind::post: kind = emit::PureKind::post_process; break;
      case graph::DocumentKind::effect:
      case graph::DocumentKind::scene:
      case graph::DocumentKind::image:
        const graph::Pass& pass = graph.passes[entry.pass];
        switch (entry.part) {
          case lower::PassPart::color:
            kind = emit::PureKind::shade;
            shader.passes.push_back(
                {pass.name, pass.state, i, {}, {}, pass.position_space, pass.enabled, pass.double_sided,
                 pass.blended, pass.casts_shadow, pass.receives_shadow, pass.repeat});
            break;
          case lower::PassPart::position:
            kind = emit::PureKind::move_vertex;
            shader.passes.back().move_vertex = i;
            break;
          case lower::PassPart::coverage:
            kind = emit::PureKind::coverage;
            shader.passes.back().coverage = i;
            break;
        }
    }
    pure.functions.push_back({kind, entries[i], entry.interface.bindings});
  }
  if (graph.kind == graph::DocumentKind::function) {
    shader.inputs = input_fields(*typed);
    shader.outputs = output_fields(*typed);
    shader.parameters.images = images_of(*typed);
    return shader;
  }
  shader.enabled = graph.enabled;
  for (const graph::InputImage& image : graph.images) shader.images.push_back(image.name);
  emit::Names names(emit::Scope::field);
  for (const interface::Binding& binding : lower::parameter_bindings(*typed))
    pure.parameters.push_back({names.take(binding.parameter.name), binding.parameter});
  return shader;
}

emit::PureShader prepared(const Shader& shader, const emit::Target& target) {
  emit::PureShader pure = shader.pure;
  passes::Entries entries{};
  entries.are_linked = true;
  uint64_t operations = 0;
  for (const emit::PureFunction& function : pure.functions) {
    entries.functions.push_back(function.entry);
    operations += ir::expanded_operations(pure.module, function.entry)[function.entry];
  }
  if (!emit::has_op(target.id, ir::Opcode::imulhi))
    passes::run(passes::multiplication_lowering(), pure.module, entries, functions::Tier::standard);
  if (target.keeps_calls && operations > cpp::large_program) passes::cut_long(pure.module, cpp::longest_in_large);
  for (size_t i = 0; i < pure.functions.size(); ++i) pure.functions[i].entry = entries[i];
  return pure;
}

std::string text(const Shader& shader, const emit::Target& target) { return target.pure(prepared(shader, target)); }

Program finish_eval(ir::Module module, uint32_t function, std::string name, functions::Tier tier,
                    const interface::Skips& skips) {
  Program program{lower::Stage::eval, std::move(name), "", std::move(module), 0, {}, {}, tier};
  for (const ir::Parameter& parameter : program.module.functions[function].parameters)
    program.inputs.push_back(field(parameter.name, graph_type(parameter.type)));
  for (const ir::Result& result : program.module.functions[function].results)
    program.results.push_back(field(result.name, graph_type(result.type)));
  CompileOptions options;
  options.skips = skips;
  finish(program, lower::add_eval_kernel(program.module, function), options);
  return program;
}

}  // namespace isoshade::driver
