// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/fixed_values.h"

#include <algorithm>
#include <bit>
#include <map>

#include "compiler/ir/expansion.h"

namespace isoshade::render {

using driver::FixedWords;
using driver::ParameterBlock;

namespace {

/// The word as a number that is the same where words are equal bit for bit; none: not fixed.
std::optional<uint32_t> bits_of(const std::optional<float>& word) {
  return word ? std::optional(std::bit_cast<uint32_t>(*word)) : std::nullopt;
}

using Groups = std::vector<std::vector<size_t>>;

/// Splits each group by a word, in the order of the members.
Groups split(const Groups& groups, size_t word, std::span<const FixedWords> given) {
  Groups made;
  for (const std::vector<size_t>& group : groups) {
    std::map<std::optional<uint32_t>, size_t> known;
    for (const size_t member : group) {
      const auto [found, is_new] = known.try_emplace(bits_of(given[member][word]), made.size());
      if (is_new) made.emplace_back();
      made[found->second].push_back(member);
    }
  }
  return made;
}

uint64_t operations(const driver::Program& program) {
  return ir::expanded_operations(program.module, program.entry)[program.entry];
}

}  // namespace

void keep_common(FixedWords& words, const FixedWords& others) {
  if (others.empty()) words.clear();
  for (size_t i = 0; i < words.size(); ++i)
    if (bits_of(words[i]) != bits_of(others[i])) words[i].reset();
}

Groups groups_of(const ParameterBlock& block, std::span<const FixedWords> given, const std::vector<bool>& reads) {
  Groups groups(1);
  for (size_t i = 0; i < given.size(); ++i) groups[0].push_back(i);
  if (!std::ranges::none_of(given, &FixedWords::empty)) return groups;
  for (const driver::BlockItem& item : driver::items_of(block)) {
    if (!item.is_switch || !reads[item.first]) continue;
    if (Groups more = split(groups, item.first, given); more.size() <= max_variants) groups = std::move(more);
  }
  return groups;
}

uint64_t operations(const driver::Effect& effect) {
  uint64_t sum = 0;
  for (const driver::EffectPass& pass : effect.passes)
    driver::for_each_program(pass, [&](const driver::Program& program) { sum += operations(program); });
  return sum;
}

uint64_t operations(const driver::Post& post) { return operations(post.program); }

std::vector<std::string> broken_by(const ParameterBlock& block, const FixedWords& fixed, const FixedWords& given) {
  std::vector<std::string> names;
  for (const driver::BlockItem& item : driver::items_of(block)) {
    bool broken = false;
    for (size_t i = item.first; i < item.first + item.words && !fixed.empty(); ++i)
      broken |= fixed[i] && (given.empty() || bits_of(fixed[i]) != bits_of(given[i]));
    if (broken) names.emplace_back(item.name);
  }
  return names;
}

}  // namespace isoshade::render
