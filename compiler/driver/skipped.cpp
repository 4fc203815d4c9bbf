// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/skipped.h"

#include <algorithm>
#include <span>
#include <string_view>

#include "compiler/driver/explain.h"
#include "compiler/driver/shader.h"
#include "compiler/ir/expansion.h"
#include "compiler/support/assert.h"

namespace isoshade::driver {

namespace {

using interface::Skip;

/// The parameters and images of which all words are fixed.
std::vector<std::string_view> fixed_names(const ParameterBlock& block, const FixedWords& fixed) {
  std::vector<std::string_view> names;
  for (const BlockItem& item : items_of(block)) {
    if (fixed.empty()) break;
    const auto words = std::span(fixed).subspan(item.first, item.words);
    if (std::ranges::all_of(words, &std::optional<float>::has_value)) names.push_back(item.name);
  }
  return names;
}

/// `what`: "the effect NAME"
void report_fixed(const ParameterBlock& block, const FixedWords& fixed, const std::string& what, std::vector<Skipped>& skips) {
  constexpr size_t most_names = 8;
  const std::vector<std::string_view> names = fixed_names(block, fixed);
  if (names.empty()) return;
  const bool is_long = names.size() > most_names;
  const size_t listed = is_long ? most_names - 1 : names.size();
  std::string list = names.size() == 1 ? "parameter " : "parameters ";
  for (size_t i = 0; i < listed; ++i) list.append(i == 0 ? "" : ", ").append(names[i]);
  if (is_long) list += " and " + std::to_string(names.size() - listed) + " others";
  skips.push_back({Skip::parameters, list + " of " + what, "no other value is given"});
}

/// What pixels find in the records of their draw. `what`: "pass NAME of EFFECT"
void report_draw_values(const Program& program, const std::string& what, const std::string& of, std::vector<Skipped>& skips) {
  if (program.draw == nullptr) return;
  const passes::DrawValues& values = *program.draw;
  const uint64_t operations = ir::expanded_operations(values.module, values.entry)[values.entry];
  skips.push_back({Skip::rates, "operations of " + what, "the same for all pixels of a draw", of,
                   static_cast<int64_t>(operations)});
}

uint64_t operations(const Shader& shader) {
  uint64_t sum = 0;
  for (const emit::PureFunction& function : shader.pure.functions)
    sum += ir::expanded_operations(shader.pure.module, function.entry)[function.entry];
  return sum;
}

/// The same document without what a change of the options takes away.
template <class Take>
Shader compiled_without(const Shader& shader, const Take& take) {
  CompileOptions options;
  options.tier = shader.tier;
  options.skips = shader.skips;
  options.fixed = shader.fixed;
  take(options);
  support::Diagnostics diagnostics;  // it compiled before
  auto made = compile_shader(shader.typed, options, {{}, shader.division}, diagnostics);
  support::assert_that(made.has_value(), diagnostics.text());
  return *std::move(made);
}

/// For each node of which fewer operations are left than `before`.
void report_fewer(const Explanation& explanation, Skip skip, std::string_view reason, std::vector<Skipped>& skips) {
  for (const NodeFate& node : explanation.nodes) {
    if (node.after >= node.before) continue;
    const bool is_gone = node.after == 0;
    std::string why(reason);
    if (!node.value.empty()) why += ", and it is " + node.value;
    skips.push_back({skip, (is_gone ? "all operations of " : "operations of ") + node.id, std::move(why), node.id,
                     static_cast<int64_t>(node.before - node.after)});
  }
}

}  // namespace

std::vector<Skipped> skipped_in(const Effect& effect) {
  std::vector<Skipped> skips;
  report_fixed(effect.parameters, effect.fixed, "the effect " + effect.name, skips);
  for (const EffectPass& pass : effect.passes)
    report_draw_values(pass.pixel, "pass " + pass.name + " of " + effect.name, effect.name, skips);
  return skips;
}

std::vector<Skipped> skipped_in(const Post& post) {
  std::vector<Skipped> skips;
  report_fixed(post.parameters, post.fixed, "the post " + post.name, skips);
  report_draw_values(post.program, "the post " + post.name, "", skips);
  return skips;
}

std::vector<Skipped> skipped_in(const Shader& shader) {
  std::vector<Skipped> skips;
  const std::string kind(graph::kind_name(shader.kind));
  report_fixed(shader.parameters, shader.fixed, "the " + kind + " " + shader.typed->graph.name, skips);
  if (operations(shader) > most_told_by_node) return skips;
  if (!shader.fixed.empty()) {
    const Shader general = compiled_without(shader, [](CompileOptions& options) { options.fixed = {}; });
    report_fewer(explain(general, shader), Skip::parameters, "the fixed values decide it", skips);
  }
  for (const Skip skip : {Skip::ranges, Skip::branches}) {
    if (!shader.skips.has(skip)) continue;
    const Shader without = compiled_without(shader, [&](CompileOptions& options) { options.skips.set(skip, false); });
    const Explanation explanation = explain(without, shader);
    if (skip == Skip::ranges) {
      report_fewer(explanation, skip, "the ranges of parameters decide it", skips);
      continue;
    }
    for (const NodeFate& node : explanation.nodes)
      if (node.branched_after > node.branched_before)
        skips.push_back({skip, "operations of " + node.id, "only one side of a choice needs them", node.id,
                         static_cast<int64_t>(node.branched_after - node.branched_before)});
  }
  return skips;
}

}  // namespace isoshade::driver
