// SPDX-License-Identifier: Apache-2.0
// isoshade compile: writes the programs of a graph and its reflection. graphs/README.md describes the files.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "backends/cpu/compiler.h"
#include "compiler/driver/driver.h"
#include "compiler/driver/forward.h"
#include "compiler/driver/shader.h"
#include "compiler/driver/target_limits.h"
#include "compiler/support/visible.h"
#include "compiler/targets/targets.h"
#include "runtime/cli/session.h"
#include "runtime/scene/output_file.h"

namespace isoshade::cli {

namespace {

using nlohmann::ordered_json;

/// Writes the files of one compilation.
class Writer {
 public:
  Writer(const CompileArguments& arguments, support::Diagnostics& diagnostics)
      : arguments_(arguments), diagnostics_(diagnostics) {}

  driver::Division division() const {
    return arguments_.division == "exact" ? driver::Division::exact : driver::Division::native;
  }

  /// A kernel in each language.
  bool program(const std::string& stem, const driver::Program& program) {
    return for_each_target([&](const emit::Target& target, bool is_text, const emit::Binary* binary) {
      if (target.kernel == nullptr) return cannot(target.name, "stages for isoshade's own renderer");
      const auto backend = target.keeps_calls ? driver::Target::cpu : driver::Target::vulkan;
      if (!driver::within_limits(program, backend, division(), diagnostics_)) return false;
      const std::string text = driver::text(program, target, division());
      const std::string name = stem + std::string(target.kernel_extension(program.stage));
      if (is_text && !write(name, text)) return false;
      if (binary == nullptr) return true;
      const auto bytes = binary->compile(text, program.stage, diagnostics_, driver::description(program));
      return bytes && write(name + std::string(binary->extension), *bytes);
    });
  }

  /// A pure shader in each language.
  bool shader(const driver::Shader& shader) {
    return for_each_target([&](const emit::Target& target, bool, const emit::Binary* binary) {
      if (binary != nullptr) return cannot(binary->name, "functions to include", "; or add --wrapper isoshade");
      return driver::within_limits(shader, target, division(), diagnostics_) &&
             write(shader.pure.name + std::string(target.extension), driver::text(shader, target));
    });
  }

  /// The forward pairs in each language.
  bool forward(const driver::Shader& shader) {
    if (shader.kind == graph::DocumentKind::function) {
      diagnostics_.report(support::Id::unsupported, "a function has no vertices and pixels to stand around it")
          .suggest("leave out --wrapper forward");
      return false;
    }
    return for_each_target([&](const emit::Target& target, bool, const emit::Binary* binary) {
      if (binary != nullptr || target.forward == nullptr)
        return cannot(binary != nullptr ? binary->name : target.name, "forward shaders");
      if (!driver::within_limits(shader, target, division(), diagnostics_)) return false;
      const auto sampling = arguments_.hardware_samplers ? emit::ForwardSampling::samplers : emit::ForwardSampling::fetch;
      for (const driver::ForwardPair& pair : driver::forward_pairs(shader, target, sampling)) {
        const std::string stem = pair.stem + std::string(target.forward_infix);
        if (!write(stem + ".vert", pair.text.vertex) || !write(stem + ".frag", pair.text.fragment)) return false;
      }
      return true;
    });
  }

  bool headers() {
    if (!wants("cpp") || arguments_.without_lanes) return true;
    for (const cpu::Header& header : cpu::lanes_headers())
      if (!write(std::string(header.path), header.text)) return false;
    return true;
  }

  bool write(const std::string& name, std::string_view bytes) {
    if (arguments_.output.empty() || arguments_.dump_after == "help") return true;
    const std::filesystem::path path = std::filesystem::path(arguments_.output) / name;
    std::error_code error;
    std::filesystem::create_directories(path.parent_path(),
                                        error);  // write_file reports a failure
    if (!may_write(path.string(), diagnostics_)) return false;
    if (is_document(path)) {
      diagnostics_
          .report(support::Id::unwritable_file,
                  support::quote(path.string()) + " is a document, which the reflection would overwrite")
          .suggest("choose another folder with -o");
      return false;
    }
    if (!is_kept(path, bytes) && !scene::write_file(path.string(), bytes, diagnostics_)) return false;
    written_.push_back(path.string());
    return true;
  }

  /// The rule that says what the files depend on: the document, the functions that it uses, its images.
  bool depfile(const check::Library& library) {
    if (arguments_.depfile.empty() || written_.empty()) return true;
    std::string rule;
    for (const std::string& path : written_) rule += escaped(path) + " ";
    rule.back() = ':';
    rule += " " + escaped(arguments_.graph);
    for (const std::vector<std::string>& paths : {library.loaded(), images_})
      for (const std::string& path : paths) rule += " \\\n  " + escaped(path);
    return may_write(arguments_.depfile, diagnostics_) &&
           scene::write_file(arguments_.depfile, rule + "\n", diagnostics_);
  }

  void reads(const std::vector<driver::Image>& images) {
    for (const driver::Image& image : images)
      if (!image.file.empty()) images_.push_back(image.file);
  }

  const std::vector<std::string>& written() const { return written_; }

 private:
  /// Written to the folder of its graph, the reflection may have the same file name as the graph.
  static bool is_document(const std::filesystem::path& path) {
    std::error_code error;
    if (path.extension() != ".json" || !std::filesystem::is_regular_file(path, error)) return false;
    support::Diagnostics ignored;
    const support::Source source = graph::read_source(path.string(), ignored);
    const auto document = source ? graph::parse_document(source, ignored) : std::nullopt;
    return document && document->root.find("isoshade") != nullptr;
  }

  /// Whether the file has these bytes, and a build tool wants to know that they did not change. The first file tells it
  /// when this ran.
  bool is_kept(const std::filesystem::path& path, std::string_view bytes) const {
    if (arguments_.depfile.empty() || written_.empty()) return false;
    std::ifstream file(path, std::ios::binary);
    return file && std::equal(std::istreambuf_iterator<char>(file), {}, bytes.begin(), bytes.end());
  }

  /// A path as make and ninja read it.
  static std::string escaped(const std::string& path) {
    std::string text;
    for (const char c : path) {
      if (c == ' ' || c == '#') text += '\\';
      if (c == '$') text += '$';
      text += c;
    }
    return text;
  }

  bool wants(std::string_view target) const {
    if (!arguments_.targets.empty())
      return std::ranges::find(arguments_.targets, target) != arguments_.targets.end();
    return target == "glsl" || (target == "cpp" && arguments_.wrapper != Wrapper::forward);
  }

  /// Calls `write` for each language of which the text or the binary form is wanted.
  template <class Write>
  bool for_each_target(Write write) {
    for (const emit::Target* target : targets::all()) {
      const bool is_text = wants(target->name);
      const bool is_binary = target->binary != nullptr && wants(target->binary->name);
      if ((is_text || is_binary) && !write(*target, is_text, is_binary ? target->binary : nullptr)) return false;
    }
    return true;
  }

  bool cannot(std::string_view target, std::string_view what, std::string_view other_fix = "") {
    diagnostics_
        .report(support::Id::unsupported, "there are no " + std::string(what) + " in " + std::string(target))
        .suggest("leave " + std::string(target) + " out of --target" + std::string(other_fix));
    return false;
  }

  const CompileArguments& arguments_;
  support::Diagnostics& diagnostics_;
  std::vector<std::string> written_;
  std::vector<std::string> images_;  ///< paths of those that the document names
};

ordered_json reflect(const std::vector<driver::Field>& fields) {
  ordered_json list = ordered_json::array();
  for (const driver::Field& field : fields) {
    ordered_json row{{"name", field.name}, {"type", field.type}, {"words", field.words}};
    if (!field.value.empty()) row["value"] = field.value;
    if (field.min) row["min"] = *field.min;
    if (field.max) row["max"] = *field.max;
    if (!field.names.empty()) row["enum"] = field.names;
    list.push_back(row);
  }
  return list;
}

/// The parameters of the document's function, in order.
ordered_json reflect(const std::vector<interface::Binding>& bindings) {
  ordered_json list = ordered_json::array();
  for (const interface::Binding& binding : bindings) {
    const ir::Parameter& parameter = binding.parameter;
    ordered_json row{{"name", parameter.name}};
    if (!parameter.group.empty()) row["group"] = parameter.group;
    row["kind"] = interface::kind_name(binding.source);
    row["type"] = ir::name(parameter.type);
    row["uniform"] = parameter.uniform;
    list.push_back(row);
  }
  return list;
}

/// The common beginning of the file names of a pass. Two names of 128 characters with an extension exceed the length
/// limit of file names; long names are therefore cut, and the number of the pass keeps them unique ("." is in no name).
std::string pass_stem(const driver::Effect& effect, size_t pass) {
  constexpr size_t limit = 200;
  const std::string stem = effect.name + "." + effect.passes[pass].name;
  if (stem.size() <= limit) return stem;
  return effect.name.substr(0, 96) + "." + effect.passes[pass].name.substr(0, 96) + "." +
         std::to_string(pass);
}

// The reflection is written first: if it would overwrite a document, no other file is written either.
bool write_effect(const driver::Effect& effect, std::string_view precision, Writer& writer) {
  ordered_json reflection{{"effect", effect.name}, {"document", effect.document}, {"precision", precision}};
  reflection["parameters"] = reflect(effect.parameters.fields);
  // One word each in the record, after the parameters.
  for (const driver::Image& image : effect.parameters.images) {
    constexpr const char* decodings[] = {"linear", "srgb", "srgb if 8 bits"};
    ordered_json row{{"name", image.slot.name}, {"file", image.file}};
    if (!image.slot.parameter.empty()) row["parameter"] = image.slot.parameter;
    row["decoding"] = decodings[static_cast<size_t>(image.slot.decoding)];
    row["mips"] = image.slot.mips;
    reflection["images"].push_back(row);
  }
  for (size_t i = 0; i < effect.passes.size(); ++i) {
    const driver::EffectPass& pass = effect.passes[i];
    const std::string stem = pass_stem(effect, i);
    ordered_json row{{"name", pass.name}, {"vertex", stem + ".vertex"}, {"pixel", stem + ".pixel"}};
    for (const interface::PassStateRow& state : interface::pass_states())
      row[std::string(state.key)] = state.values[state.get(pass.state)];
    row["vertex_inputs"] = reflect(pass.vertex.bindings);
    row["pixel_inputs"] = reflect(pass.pixel.bindings);
    row["moves_vertices"] = pass.moves_vertices;
    if (pass.enabled) row["enabled"] = effect.parameters.fields[*pass.enabled].name;
    reflection["passes"].push_back(row);
  }
  if (!writer.write(effect.name + ".json", reflection.dump(2) + "\n")) return false;
  for (size_t i = 0; i < effect.passes.size(); ++i) {
    const std::string stem = pass_stem(effect, i);
    if (!writer.program(stem + ".vertex", effect.passes[i].vertex) ||
        !writer.program(stem + ".pixel", effect.passes[i].pixel))
      return false;
  }
  return true;
}

bool write_post(const driver::Post& post, std::string_view precision, Writer& writer) {
  ordered_json reflection{{"post", post.name}, {"document", post.document}, {"precision", precision}};
  reflection["parameters"] = reflect(post.parameters.fields);
  reflection["taps"] = reflect(post.parameters.taps);
  reflection["images"] = post.images;
  reflection["reads_depth"] = post.reads_depth;
  reflection["inputs"] = reflect(post.program.bindings);
  if (post.enabled) reflection["enabled"] = post.parameters.fields[*post.enabled].name;
  return writer.write(post.name + ".json", reflection.dump(2) + "\n") &&
         writer.program(post.name + ".post", post.program);
}

bool write_function(const driver::Program& program, std::string_view precision, Writer& writer) {
  ordered_json reflection{
      {"function", program.name}, {"document", program.document}, {"precision", precision}};
  reflection["inputs"] = reflect(program.inputs);
  reflection["outputs"] = reflect(program.results);
  return writer.write(program.name + ".json", reflection.dump(2) + "\n") &&
         writer.program(program.name, program);
}

}  // namespace

int compile(const CompileArguments& arguments, const Common& common) {
  support::Diagnostics diagnostics = make_diagnostics(common);
  check::Library library = make_library(common);
  driver::CompileOptions options;
  options.library = &library;
  options.tier = arguments.precision;
  int dumped = 0;
  const bool lists_stages = arguments.dump_after == "help";
  std::set<std::string, std::less<>> listed;  // some passes run more than once
  if (!arguments.dump_after.empty())
    options.dump = [&](std::string_view stage, const std::function<std::string()>& text) {
      if (lists_stages && listed.emplace(stage).second)
        std::printf("%.*s\n", static_cast<int>(stage.size()), stage.data());
      if (arguments.dump_after != stage) return;
      ++dumped;
      std::printf("# after %.*s\n%s", static_cast<int>(stage.size()), stage.data(), text().c_str());
    };

  Writer writer(arguments, diagnostics);
  const support::Source source = graph::read_source(arguments.graph, diagnostics);
  const auto kind = source != nullptr ? driver::kind_of(source, diagnostics) : std::nullopt;
  bool done = false;
  if (kind && arguments.wrapper != Wrapper::isoshade) {
    const driver::ShaderOptions shader_options{arguments.prefix, writer.division()};
    const auto shader = driver::compile_shader(source, options, shader_options, diagnostics);
    const bool is_pure = arguments.wrapper == Wrapper::none;
    done = shader && (is_pure ? writer.shader(*shader) : writer.forward(*shader));
    if (shader) writer.reads(shader->parameters.images);
  } else if (kind == graph::DocumentKind::function) {
    const auto program = driver::compile_function(source, options, diagnostics);
    done = program && write_function(*program, functions::tier_name(options.tier), writer);
  } else if (kind == graph::DocumentKind::post) {
    const auto post = driver::compile_post(source, options, diagnostics);
    done = post && write_post(*post, functions::tier_name(options.tier), writer);
  } else if (kind) {
    const auto effect = driver::compile_effect(source, options, diagnostics);
    done = effect && write_effect(*effect, functions::tier_name(options.tier), writer);
    if (effect) writer.reads(effect->parameters.images);
  }
  if (done) done = writer.headers() && writer.depfile(library);
  if (done && !arguments.dump_after.empty() && !lists_stages && dumped == 0)
    diagnostics.report(support::Id::unknown_stage, "there is no stage \"" + arguments.dump_after + "\"")
        .suggest("`--dump-after help` lists the stages of this graph");
  if (flush(diagnostics, common) || !done) return failure;
  if (!common.quiet)
    for (const std::string& path : writer.written())
      if (path.find("isoshade/lanes/") == std::string::npos) std::fprintf(stderr, "wrote %s\n", path.c_str());
  return success;
}

}  // namespace isoshade::cli
