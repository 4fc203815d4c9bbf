// SPDX-License-Identifier: Apache-2.0
#include "runtime/page/shaders.h"

#include <algorithm>
#include <utility>

#include "compiler/driver/forward.h"
#include "compiler/support/visible.h"
#include "compiler/targets/targets.h"

namespace isoshade::page {
namespace {

/// WebGL2 promises this many to a fragment shader.
constexpr size_t max_samplers = 16;

class Compiler {
 public:
  Compiler(const PageOptions& options, support::Diagnostics& diagnostics) : diagnostics_(diagnostics) {
    compiler_.library = options.library;
    compiler_.tier = options.tier;
  }

  /// Adds the programs of a document and returns their numbers: one for each pass of an effect, one for a post. Nothing
  /// after an error, which is reported.
  std::optional<std::vector<size_t>> add(const support::Source& source, std::vector<DocumentText>& documents) {
    driver::ShaderOptions naming;
    naming.prefix = "page";  // each program has one document, so that names need not tell documents apart
    const auto shader = driver::compile_shader(source, compiler_, naming, diagnostics_);
    if (!shader || !driver::can_be_forward(*shader, diagnostics_)) return std::nullopt;
    const auto calls = emit::host_calls(shader->pure);
    shaders_.reads_time |= std::ranges::find(calls, interface::HostCall::time) != calls.end();
    documents.push_back(document_of(*shader));
    std::vector<size_t> numbers;
    for (driver::ForwardPair& pair : driver::forward_pairs(*shader, targets::get(emit::TargetId::glsl_es))) {
      if (!check_samplers(*shader, pair.layout.samplers.size())) return std::nullopt;
      const bool has_passes = shader->passes.size() > 1;
      const std::string pass = has_passes ? ", pass " + shader->passes[numbers.size()].name : "";
      numbers.push_back(shaders_.programs.size());
      shaders_.programs.push_back({shader->pure.name + pass, std::move(pair.text.vertex),
                                   std::move(pair.text.fragment), parameters_of(shader->pure)});
    }
    return numbers;
  }

  Shaders& shaders() { return shaders_; }

 private:
  static DocumentText document_of(const driver::Shader& shader) {
    const graph::Graph& graph = shader.typed->graph;
    DocumentText text{graph.name, graph.doc, {}};
    for (const driver::Field& field : shader.parameters.fields)
      text.docs.push_back(std::ranges::find(graph.inputs, field.name, &graph::Input::name)->doc);
    return text;
  }

  /// The fields of Parameters are in the order of the words of the record.
  static std::vector<std::string> parameters_of(const emit::PureShader& shader) {
    std::vector<std::string> names;
    for (const emit::PureField& field : shader.parameters) {
      names.push_back(field.name);
      names.resize(names.size() + static_cast<size_t>(field.parameter.type.width) - 1);
    }
    return names;
  }

  bool check_samplers(const driver::Shader& shader, size_t count) {
    if (count <= max_samplers) return true;
    diagnostics_
        .report(support::Id::unsupported, {shader.typed->graph.source, 0, 0},
                support::quote(shader.pure.name) + " reads " + std::to_string(count) +
                    " images; WebGL2 has room for " + std::to_string(max_samplers))
        .suggest("read fewer images, or draw the scene with `isoshade render`");
    return false;
  }

  driver::CompileOptions compiler_;
  support::Diagnostics& diagnostics_;
  Shaders shaders_;
};

}  // namespace

std::optional<Shaders> compile_shaders(const render::Plan& plan, const PageOptions& options,
                                       support::Diagnostics& diagnostics) {
  if (plan.motion) {
    diagnostics.report(support::Id::unsupported, "a post reads the motion since the frame before, which a page does not draw")
        .suggest("leave the post out, or draw the scene with `isoshade render`");
    return std::nullopt;
  }
  Compiler compiler(options, diagnostics);
  Shaders& shaders = compiler.shaders();
  for (const driver::Effect& effect : plan.effects) {
    auto numbers = compiler.add(effect.passes.front().pixel.source, shaders.effects);
    if (!numbers) return std::nullopt;
    shaders.passes.push_back(*std::move(numbers));
  }
  for (const driver::Post& post : plan.post_documents) {
    const auto numbers = compiler.add(post.program.source, shaders.posts);
    if (!numbers) return std::nullopt;
    shaders.post_programs.push_back(numbers->front());
  }
  return std::move(shaders);
}

}  // namespace isoshade::page
