// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/draw_evaluator.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>
#include <optional>
#include <utility>

#include "compiler/ir/interpreter.h"
#include "compiler/ir/record_words.h"
#include "runtime/lanes/lanes.h"

namespace isoshade::render {

namespace {

using lower::FrameBuffer;

/// Where the words of the record lie that the values depend on: all before them if that does not show.
std::vector<uint32_t> words_read(const passes::DrawValues& values) {
  const bool has_parameter = !values.module.functions[values.entry].parameters.empty();
  const auto words =
      ir::loaded_words(values.module, values.entry, has_parameter ? std::optional<size_t>(0) : std::nullopt,
                       std::array{static_cast<uint32_t>(FrameBuffer::objects)});
  const auto is_stored_here = [&](uint32_t word) { return word >= values.first; };
  if (words && std::ranges::none_of(*words, is_stored_here)) return *words;
  std::vector<uint32_t> all(values.first);
  std::iota(all.begin(), all.end(), 0u);
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
