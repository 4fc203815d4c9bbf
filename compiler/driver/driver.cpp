// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/driver.h"

#include <algorithm>

#include "compiler/check/stage_needs.h"
#include "compiler/driver/finish.h"
#include "compiler/driver/front.h"
#include "compiler/driver/plain_background.h"
#include "compiler/ir/record_words.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/lower/light_sums.h"
#include "compiler/lower/lower.h"
#include "compiler/lower/screen.h"

namespace isoshade::driver {

namespace {

using support::Diagnostics;

graph::Type graph_type(ir::Type type) {
  constexpr graph::Type floats[] = {graph::Type::floating, graph::Type::vector2, graph::Type::vector3,
                                    graph::Type::vector4};
  if (type == ir::bool_type) return graph::Type::boolean;
  return type == ir::int_type ? graph::Type::integer : floats[type.width - 1];
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

Checked check_document(const support::Source& source, const CompileOptions& options, Diagnostics& diagnostics) {
  return read_graph(source, std::nullopt, options, diagnostics);
}

std::optional<Effect> check_effect(const support::Source& source, const CompileOptions& options,
                                   Diagnostics& diagnostics) {
  const auto typed = read_graph(source, graph::DocumentKind::effect, options, diagnostics);
  return typed == nullptr ? std::nullopt : std::optional(effect_of(typed, options));
}

Effect effect_of(const Checked& typed, const CompileOptions& options) {
  Effect effect{typed->graph.name, typed->document, parameter_block(*typed), {}, false, environment_reads(*typed), typed};
  effect.lists_lights = options.lights.lists && lower::leaves_out_black_lights(*typed);
  for (size_t i = 0; i < typed->graph.passes.size(); ++i) {
    const graph::Pass& pass = typed->graph.passes[i];
    effect.passes.push_back({pass.name, pass.state, pass.position.has_value(), false, pass.enabled,
                             pass.double_sided, pass.blended, cutoff_parameter(*typed, i),
                             pass.casts_shadow, pass.casts_blended_shadow, false, pass.receives_shadow, pass.repeat, {}, {},
                             {}, {}});
  }
  return effect;
}

void make_programs(Effect& effect, const CompileOptions& of_scene) {
  CompileOptions options = of_scene;
  options.lights.lists = effect.lists_lights;
  const check::TypedGraph& typed = *effect.typed;
  effect.fixed = options.fixed;
  for (size_t i = 0; i < effect.passes.size(); ++i) {
    EffectPass& made = effect.passes[i];
    uint32_t room = first_draw_word(effect);
    made.vertex = vertex_program(typed, i, effect, options, room);
    room += draw_words(made.vertex);
    made.cutout = cutout_program(typed, i, effect, options, room);
    if (made.cutout) room += draw_words(*made.cutout);
    made.pixel = pixel_program(typed, i, effect, options, room);
    effect.reads_previous |= reads_previous(made.vertex) || reads_previous(made.pixel) ||
                             (made.cutout && reads_previous(*made.cutout));
    // Fixed values of parameters may leave nothing of a sum over lights, or of their shadows.
    const auto loads = [&](lower::FrameBuffer buffer) {
      return ir::loads_from(made.pixel.module, static_cast<uint32_t>(buffer));
    };
    made.sums_lights = loads(lower::FrameBuffer::lights);
    made.receives_shadow &= made.sums_lights && loads(lower::FrameBuffer::layers);
    if (made.state.blend != interface::Blend::none) made.blend = pixel_program(typed, i, effect, options, room, true);
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
  return typed == nullptr ? std::nullopt : std::optional(post_of(typed, options));
}

Post post_of(const Checked& typed, const CompileOptions& options) {
  Post post;
  post.name = typed->graph.name;
  post.document = typed->document;
  post.parameters = parameter_block(*typed);
  post.enabled = typed->graph.enabled;
  post.typed = typed;
  if (options.lights.environment.value_or(true)) post.environment = environment_reads(*typed);
  for (const graph::InputImage& image : typed->graph.images) {
    if (image.name == graph::motion_image_name) post.motion = post.images.size();
    post.images.push_back(image.name);
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
  post.keeps_background_plain = post.is_pointwise && keeps_background_plain(lowered, options.tier);
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
  return typed == nullptr ? std::nullopt : compile_function(typed, options, diagnostics);
}

std::optional<Program> compile_function(const Checked& typed, const CompileOptions& options, Diagnostics& diagnostics) {
  if (!check::stands_alone(*typed, diagnostics)) return std::nullopt;
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
