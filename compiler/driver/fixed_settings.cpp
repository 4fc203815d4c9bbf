// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/fixed_settings.h"

#include <algorithm>
#include <bit>

#include "compiler/driver/front.h"
#include "compiler/driver/parameter_value.h"
#include "compiler/graph/setting.h"
#include "compiler/ir/float_bits.h"
#include "compiler/support/visible.h"

namespace isoshade::driver {

namespace {

using graph::GivenParameter;
using support::Diagnostics;
using support::Id;
using support::quote;

/// Writes the words of a value. False after a report.
bool fix(const check::TypedGraph& document, const ParameterBlock& block, const GivenParameter& given, FixedWords& fixed,
         Diagnostics& diagnostics) {
  const auto number = block.find(given.name);
  if (!number) {
    std::vector<std::string_view> names;
    for (const Field& field : block.fields) names.push_back(field.name);
    diagnostics.report_unknown(Id::unknown_parameter, given.name_where,
                               quote(document.graph.name) + " has no parameter " + quote(given.name), given.name, names);
    return false;
  }
  const Field& field = block.fields[*number];
  if (!check_fit(field, given.value, given.value_where, diagnostics)) return false;
  if (type_of(field) == graph::Type::filename && !given.value.string.empty()) {
    diagnostics.report(Id::unsupported, given.value_where, "no image can be compiled into a program")
        .suggest("to compile for no image, write --set '" + given.name + "=\"\"'");
    return false;
  }
  std::vector<float> words(static_cast<size_t>(field.words));
  store(type_of(field), field.names, given.value, words.data());
  for (size_t i = 0; i < words.size(); ++i)
    fixed[block.word_of(*number) + i] = std::bit_cast<float>(ir::canonical_float(std::bit_cast<uint32_t>(words[i])));
  for (size_t i = 0; i < block.images.size(); ++i)
    if (block.images[i].slot.parameter == given.name) fixed[block.word_of_image(i)] = -1.0f;
  return true;
}

}  // namespace

std::optional<FixedWords> fixed_words(const check::TypedGraph& document, const std::vector<std::string>& settings,
                                      Diagnostics& diagnostics) {
  if (settings.empty()) return FixedWords();
  const graph::DocumentKind kind = document.graph.kind;
  if (kind != graph::DocumentKind::effect && kind != graph::DocumentKind::post) {
    diagnostics
        .report(Id::unsupported, "--set is for parameters of effects and posts, and this is a document of the kind " +
                                     quote(std::string(graph::kind_name(kind))))
        .suggest("leave it out");
    return std::nullopt;
  }
  std::vector<GivenParameter> all;
  for (const std::string& text : settings) {
    auto given = graph::parse_given_parameter(text, diagnostics);
    if (!given) return std::nullopt;
    std::erase_if(all, [&](const GivenParameter& earlier) { return earlier.name == given->name; });
    all.push_back(*std::move(given));
  }
  const ParameterBlock block = parameter_block(document);
  FixedWords fixed(block.word_count());
  bool fits = true;
  for (const GivenParameter& given : all) fits = fix(document, block, given, fixed, diagnostics) && fits;
  return fits ? std::optional(std::move(fixed)) : std::nullopt;
}

}  // namespace isoshade::driver
