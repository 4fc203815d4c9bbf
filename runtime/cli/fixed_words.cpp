// SPDX-License-Identifier: Apache-2.0
#include "runtime/cli/fixed_words.h"

#include <algorithm>

#include "compiler/support/visible.h"
#include "runtime/lanes/lanes.h"
#include "runtime/render/parameters.h"
#include "runtime/scene/load.h"

namespace isoshade::cli {

std::optional<driver::FixedWords> fixed_words(const support::Source& source, const std::vector<std::string>& settings,
                                              const driver::CompileOptions& options, support::Diagnostics& diagnostics) {
  if (settings.empty()) return driver::FixedWords();
  driver::CompileOptions without_dump = options;
  without_dump.dump = {};
  const auto kind = driver::kind_of(source, diagnostics);
  if (!kind) return std::nullopt;
  if (*kind != graph::DocumentKind::effect && *kind != graph::DocumentKind::post) {
    diagnostics.report(support::Id::unsupported, "--set is for parameters of effects and posts, and this is a document of the "
                                                 "kind \"" + std::string(graph::kind_name(*kind)) + "\"")
        .suggest("leave it out");
    return std::nullopt;
  }
  driver::ParameterBlock block;
  std::string name;
  if (*kind == graph::DocumentKind::effect) {
    const auto effect = driver::check_effect(source, without_dump, diagnostics);
    if (!effect) return std::nullopt;
    block = effect->parameters;
    name = effect->name;
  } else {
    const auto post = driver::check_post(source, without_dump, diagnostics);
    if (!post) return std::nullopt;
    block = post->parameters;
    name = post->name;
  }
  std::vector<scene::Parameter> parameters;
  for (const std::string& text : settings) {
    auto parameter = scene::parse_setting(text, diagnostics);
    if (!parameter) return std::nullopt;
    if (!block.find(parameter->name)) {
      std::vector<std::string_view> names;
      for (const driver::Field& field : block.fields) names.push_back(field.name);
      diagnostics.report_unknown(support::Id::unknown_parameter, parameter->name_where,
                                 support::quote(name) + " has no parameter " + support::quote(parameter->name),
                                 parameter->name, names);
      return std::nullopt;
    }
    std::erase_if(parameters, [&](const scene::Parameter& other) { return other.name == parameter->name; });
    parameters.push_back(*std::move(parameter));
  }
  const render::FindTexture no_texture = [&](const render::ImageSource& image, const lower::ImageSlot& slot) -> std::optional<int> {
    if (std::ranges::find(parameters, slot.parameter, &scene::Parameter::name) == parameters.end()) return -1;
    diagnostics.report(support::Id::unsupported, image.where, "no image can be compiled into a program")
        .suggest("to compile for no image, write --set '" + slot.parameter + "=\"\"'");
    return std::nullopt;
  };
  const lanes::FpGuard guard;
  const auto values = render::ParameterValues::resolve(block, {name, parameters}, no_texture, diagnostics);
  if (!values) return std::nullopt;
  const driver::FixedWords given = values->common();
  driver::FixedWords fixed(block.word_count());
  for (const scene::Parameter& parameter : parameters) {
    const size_t field = *block.find(parameter.name);
    for (size_t i = 0; i < static_cast<size_t>(block.fields[field].words); ++i)
      fixed[block.word_of(field) + i] = given[block.word_of(field) + i];
    for (size_t i = 0; i < block.images.size(); ++i)
      if (block.images[i].slot.parameter == parameter.name) fixed[block.word_of_image(i)] = -1.0f;
  }
  return fixed;
}

}  // namespace isoshade::cli
