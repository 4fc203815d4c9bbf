// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/fixed.h"

#include <bit>
#include <utility>

#include "compiler/driver/front.h"
#include "compiler/lower/lower.h"
#include "compiler/passes/bind.h"

namespace isoshade::driver {

namespace {

using passes::KnownWords;
namespace source = interface::source;

/// The value of a parameter of this type whose words are those from `first` on; see lower::load_field.
KnownWords known_value(ir::Type type, const FixedWords& fixed, size_t first) {
  std::vector<uint32_t> words;
  for (size_t i = 0; i < type.width; ++i) {
    const std::optional<float>& word = fixed[first + i];
    if (!word) return std::nullopt;
    if (type == ir::bool_type)
      words.push_back(*word != 0 ? 1 : 0);
    else if (type == ir::int_type)
      words.push_back(static_cast<uint32_t>(static_cast<int32_t>(*word)));
    else
      words.push_back(std::bit_cast<uint32_t>(*word));
  }
  return words;
}

class Fixer {
 public:
  Fixer(const ParameterBlock& block, const FixedWords& fixed, const interface::Repeat* repeat)
      : block_(block), fixed_(fixed), repeat_(repeat) {}

  KnownWords value_of(const interface::Binding& binding) const {
    const ir::Type type = binding.parameter.type;
    if (const auto* input = std::get_if<source::Input>(&binding.source))
      return known_value(type, fixed_, block_.word_of(input->input) + size_t{input->column} * type.width);
    if (const auto* image = std::get_if<source::Image>(&binding.source))
      return known_value(type, fixed_, block_.word_of_image(image->slot));
    if (const auto* repetition = std::get_if<source::PassRepetition>(&binding.source)) return value_of(*repetition);
    return std::nullopt;
  }

  /// Tells how far a repetition counts where its value stays open.
  void narrow(interface::Binding& binding) const {
    const auto* const repetition = std::get_if<source::PassRepetition>(&binding.source);
    const std::optional<int> count = repetition != nullptr ? repetitions() : std::nullopt;
    if (count && repetition->what == interface::Repetition::index) binding.assumed.hi = *count - 1;
  }

 private:
  /// How often the pass is drawn, if that is known.
  std::optional<int> repetitions() const {
    if (repeat_ == nullptr) return std::nullopt;
    const std::optional<size_t> parameter = repeat_->parameter;
    if (!parameter) return repeat_->count;
    return is_fixed(fixed_, block_, *parameter) ? std::optional(static_cast<int>(*fixed_[block_.word_of(*parameter)]))
                                                : std::nullopt;
  }
  KnownWords value_of(const source::PassRepetition& repetition) const {
    const std::optional<int> count = repetitions();
    if (!count) return std::nullopt;
    if (repetition.what == interface::Repetition::count) return std::vector{static_cast<uint32_t>(*count)};
    return *count == 1 ? KnownWords(std::vector{0u}) : std::nullopt;
  }

  const ParameterBlock& block_;
  const FixedWords& fixed_;
  const interface::Repeat* repeat_;
};

}  // namespace

bool agrees(const FixedWords& fixed, std::span<const float> record) {
  for (size_t i = 0; i < fixed.size(); ++i)
    if (fixed[i] && std::bit_cast<uint32_t>(*fixed[i]) != std::bit_cast<uint32_t>(record[i])) return false;
  return true;
}

bool is_fixed(const FixedWords& fixed, const ParameterBlock& block, size_t field) {
  if (fixed.empty()) return false;
  const size_t first = block.word_of(field);
  for (int i = 0; i < block.fields[field].words; ++i)
    if (!fixed[first + static_cast<size_t>(i)]) return false;
  return block.fields[field].words > 0;
}

void fix_parameters(ir::Module& module, interface::Interface& interface, const ParameterBlock& block,
                    const FixedWords& fixed, const interface::Repeat* repeat) {
  if (fixed.empty()) return;
  const Fixer fixer(block, fixed, repeat);
  std::vector<KnownWords> words;
  std::vector<interface::Binding> bindings;
  for (interface::Binding& binding : interface.bindings) {
    words.push_back(fixer.value_of(binding));
    if (words.back()) continue;
    fixer.narrow(binding);
    bindings.push_back(std::move(binding));
  }
  passes::bind_parameters(module.functions[interface.entry], words);
  interface.bindings = std::move(bindings);
}

std::function<void(lower::Lowered& lowered, size_t pass)> fixing(const check::TypedGraph& document, FixedWords fixed) {
  if (fixed.empty()) return {};
  return [&document, block = parameter_block(document), fixed = std::move(fixed)](lower::Lowered& lowered, size_t pass) {
    const bool is_pass = document.graph.kind == graph::DocumentKind::effect;
    fix_parameters(lowered.module, lowered.interface, block, fixed, is_pass ? &document.graph.passes[pass].repeat : nullptr);
  };
}

void drop_unread(ir::Function& function, interface::Interface& interface) {
  std::vector<bool> used(function.values.size());
  for (const ir::Block& block : function.blocks) {
    for (const ir::ValueId value : block.yields) used[value] = true;
    for (const ir::InstructionId id : block.instructions)
      for (const ir::ValueId value : function.operands_of(function.instructions[id])) used[value] = true;
  }
  std::vector<ir::Parameter> parameters;
  std::vector<ir::ValueId> values;
  std::vector<interface::Binding> bindings;
  for (size_t i = 0; i < function.parameters.size(); ++i) {
    const ir::ValueId value = function.blocks[0].parameters[i];
    if (!used[value]) continue;
    parameters.push_back(std::move(function.parameters[i]));
    values.push_back(value);
    // Behind those of the bindings stand those that derivatives have added.
    if (i < interface.bindings.size()) bindings.push_back(std::move(interface.bindings[i]));
  }
  function.parameters = std::move(parameters);
  function.blocks[0].parameters = std::move(values);
  interface.bindings = std::move(bindings);
}

}  // namespace isoshade::driver
