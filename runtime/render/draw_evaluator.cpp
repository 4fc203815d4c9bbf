// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/draw_evaluator.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <set>
#include <utility>

#include "compiler/ir/interpreter.h"
#include "runtime/lanes/lanes.h"

namespace isoshade::render {

namespace {

using lower::FrameBuffer;

/// Where the words of the record lie that the values depend on: all before them if that is not plain.
std::vector<uint32_t> words_read(const passes::DrawValues& values) {
  const ir::Function& entry = values.module.functions[values.entry];
  std::vector<ir::InstructionId> made_by(entry.values.size(), ir::none);
  for (ir::InstructionId id = 0; id < entry.instructions.size(); ++id)
    for (uint32_t k = 0; k < entry.instructions[id].result_count; ++k)
      made_by[entry.instructions[id].first_result + k] = id;
  const auto constant = [&](ir::ValueId value) -> std::optional<uint32_t> {
    const bool is_constant = made_by[value] != ir::none && entry.instructions[made_by[value]].op == ir::Opcode::constant;
    return is_constant ? std::optional(entry.instructions[made_by[value]].imm) : std::nullopt;
  };
  const auto place = [&](ir::ValueId value) -> std::optional<uint32_t> {
    if (made_by[value] == ir::none) return 0;  // the record
    const ir::Instruction& made = entry.instructions[made_by[value]];
    if (made.op != ir::Opcode::iadd) return constant(value);
    const auto operands = entry.operands_of(made);
    return made_by[operands[0]] == ir::none ? constant(operands[1]) : std::nullopt;
  };
  std::set<uint32_t> words;
  bool is_plain = true;
  for (size_t f = 0; f < values.module.functions.size(); ++f) {
    const ir::Function& function = values.module.functions[f];
    for (const ir::Instruction& made : function.instructions) {
      if (made.op != ir::Opcode::load || made.imm != static_cast<uint32_t>(FrameBuffer::objects)) continue;
      const auto word = f == values.entry ? place(function.operands_of(made)[0]) : std::nullopt;
      is_plain = is_plain && word && *word < values.first;
      if (word) words.insert(*word);
    }
  }
  if (is_plain) return {words.begin(), words.end()};
  std::vector<uint32_t> all;
  for (uint32_t word = 0; word < values.first; ++word) all.push_back(word);
  return all;
}

}  // namespace

struct DrawEvaluator::Known {
  explicit Known(std::shared_ptr<const passes::DrawValues> of)
      : values(std::move(of)), interpreter(values->module, ir::Preconditions::report), reads(words_read(*values)) {}

  std::shared_ptr<const passes::DrawValues> values;  ///< so that no other ones get the same address
  ir::Interpreter interpreter;
  std::vector<uint32_t> reads;
  std::map<std::vector<uint32_t>, std::vector<uint32_t>> results;  ///< by the words read
};

void DrawEvaluator::bind(FrameBuffer buffer, std::span<const uint32_t> words) {
  Bound& bound = bound_[buffer];
  const bool is_same = std::ranges::equal(bound.contents, words);
  bound.words = words;
  if (!is_same) bound.contents.assign(words.begin(), words.end());
  for (auto& [values, known] : known_) {
    known->interpreter.bind(static_cast<uint32_t>(buffer), words);
    if (!is_same) known->results.clear();
  }
}

void DrawEvaluator::fill(const std::shared_ptr<const passes::DrawValues>& values, std::span<float> record) {
  if (values == nullptr) return;
  constexpr size_t most_known = 4096;
  std::shared_ptr<Known>& known = known_[values.get()];
  if (known == nullptr) {
    // Programs that nobody else has are gone.
    std::erase_if(known_, [](const auto& entry) { return entry.second != nullptr && entry.second->values.use_count() == 1; });
    known = std::make_shared<Known>(values);
    for (const auto& [buffer, bound] : bound_) known->interpreter.bind(static_cast<uint32_t>(buffer), bound.words);
  }
  const std::span<const uint32_t> words(reinterpret_cast<const uint32_t*>(record.data()), record.size());
  std::vector<uint32_t> read;
  for (const uint32_t word : known->reads) read.push_back(words[word]);
  if (known->results.size() == most_known) known->results.clear();
  const auto [found, is_new] = known->results.try_emplace(std::move(read));
  if (is_new) {
    const lanes::FpGuard guard;
    found->second.resize(values->words);
    known->interpreter.bind(static_cast<uint32_t>(FrameBuffer::objects), words);
    const uint32_t first_word = 0;
    const bool has_parameter = !values->module.functions[values->entry].parameters.empty();
    known->interpreter.run(values->entry, {&first_word, has_parameter ? size_t{1} : 0}, found->second);
  }
  std::memcpy(&record[values->first], found->second.data(), found->second.size() * sizeof(uint32_t));
}

}  // namespace isoshade::render
