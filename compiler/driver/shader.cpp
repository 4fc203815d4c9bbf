// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/shader.h"

#include "compiler/driver/dumps.h"
#include "compiler/driver/front.h"
#include "compiler/ir/expansion.h"
#include "compiler/lower/lower.h"
#include "compiler/passes/passes.h"
#include "compiler/passes/pipeline.h"
#include "compiler/support/visible.h"
#include "compiler/targets/cpp/cpp.h"

namespace isoshade::driver {

using support::Diagnostics;

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
  const auto typed = read_graph(source, std::nullopt, options, diagnostics);
  return typed == nullptr ? std::nullopt : compile_shader(typed, options, shader_options, diagnostics);
}

std::optional<Shader> compile_shader(const Checked& typed, const CompileOptions& options,
                                     const ShaderOptions& shader_options, Diagnostics& diagnostics) {
  const std::string& wanted = shader_options.prefix;
  if (!wanted.empty() && !graph::is_id(wanted)) {
    diagnostics.report(support::Id::bad_id, support::quote(wanted) +
                                                " is not a valid prefix: it must match [A-Za-z_][A-Za-z0-9_]{0,127}");
    return std::nullopt;
  }
  const graph::Graph& graph = typed->graph;
  Shader shader;
  shader.typed = typed;
  shader.kind = graph.kind;
  shader.tier = options.tier;
  shader.skips = options.skips;
  shader.division = shader_options.division;
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
  if (graph.kind != graph::DocumentKind::function) shader.parameters = parameter_block(*typed);
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

}  // namespace isoshade::driver
