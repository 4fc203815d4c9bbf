// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/fixed_values.h"

#include <algorithm>
#include <bit>
#include <map>

namespace isoshade::render {

using driver::FixedWords;
using driver::ParameterBlock;

namespace {

/// The word as a number that is the same where words are equal bit for bit; none: not fixed.
std::optional<uint32_t> bits_of(const std::optional<float>& word) {
  return word ? std::optional(std::bit_cast<uint32_t>(*word)) : std::nullopt;
}

/// A part of a block that is fixed as a whole.
struct Item {
  std::string_view name;
  size_t first, words;
  bool is_switch;
};

std::vector<Item> items_of(const ParameterBlock& block) {
  std::vector<Item> items;
  for (size_t i = 0; i < block.fields.size(); ++i) {
    const driver::Field& field = block.fields[i];
    const graph::Type type = driver::type_of(field);
    const bool is_switch = type == graph::Type::boolean || type == graph::Type::integer;
    if (field.words > 0) items.push_back({field.name, block.word_of(i), static_cast<size_t>(field.words), is_switch});
  }
  for (size_t i = 0; i < block.images.size(); ++i)
    items.push_back({block.images[i].slot.name, block.word_of_image(i), 1, true});
  return items;
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

Variant variant_of(std::vector<size_t> members, std::span<const FixedWords> given) {
  Variant variant{given[members.front()], std::move(members)};
  for (const size_t member : variant.members) keep_common(variant.fixed, given[member]);
  return variant;
}

}  // namespace

void keep_common(FixedWords& words, const FixedWords& others) {
  if (others.empty()) words.clear();
  for (size_t i = 0; i < words.size(); ++i)
    if (bits_of(words[i]) != bits_of(others[i])) words[i].reset();
}

std::vector<Variant> variants_of(const ParameterBlock& block, std::span<const FixedWords> given) {
  if (given.empty()) return {};
  Groups groups(1);
  for (size_t i = 0; i < given.size(); ++i) groups[0].push_back(i);
  const bool is_fixed = std::ranges::none_of(given, &FixedWords::empty);
  for (const Item& item : items_of(block)) {
    if (!is_fixed || !item.is_switch) continue;
    if (Groups more = split(groups, item.first, given); more.size() <= max_variants) groups = std::move(more);
  }
  std::vector<Variant> variants;
  for (std::vector<size_t>& group : groups) variants.push_back(variant_of(std::move(group), given));
  return variants;
}

std::vector<Variant> variants_of_posts(const ParameterBlock& block, std::span<const FixedWords> given) {
  std::map<std::vector<std::optional<uint32_t>>, size_t> known;
  Groups groups;
  for (size_t i = 0; i < given.size(); ++i) {
    std::vector<std::optional<uint32_t>> key;
    for (const std::optional<float>& word : given[i]) key.push_back(bits_of(word));
    const auto [found, is_new] = known.try_emplace(std::move(key), groups.size());
    if (is_new) groups.emplace_back();
    groups[found->second].push_back(i);
  }
  if (groups.size() > max_variants) return variants_of(block, given);
  std::vector<Variant> variants;
  for (std::vector<size_t>& group : groups) variants.push_back(variant_of(std::move(group), given));
  return variants;
}

std::vector<std::string> broken_by(const ParameterBlock& block, const FixedWords& fixed, const FixedWords& given) {
  std::vector<std::string> names;
  for (const Item& item : items_of(block)) {
    bool broken = false;
    for (size_t i = item.first; i < item.first + item.words && !fixed.empty(); ++i)
      broken |= fixed[i] && (given.empty() || bits_of(fixed[i]) != bits_of(given[i]));
    if (broken) names.emplace_back(item.name);
  }
  return names;
}

void report_fixed(const ParameterBlock& block, const FixedWords& fixed, std::string_view what, std::vector<Skipped>& skips) {
  constexpr size_t most_names = 8;
  std::vector<std::string_view> names;
  for (const Item& item : items_of(block)) {
    bool all = !fixed.empty();
    for (size_t i = item.first; i < item.first + item.words && all; ++i) all = fixed[i].has_value();
    if (all) names.push_back(item.name);
  }
  if (names.empty()) return;
  const bool is_long = names.size() > most_names;
  std::string list = names.size() == 1 ? "parameter " : "parameters ";
  for (size_t i = 0; i < names.size() && i < (is_long ? most_names - 1 : most_names); ++i)
    list.append(i == 0 ? "" : ", ").append(names[i]);
  if (is_long) list += " and " + std::to_string(names.size() - (most_names - 1)) + " others";
  skips.push_back({interface::Skip::parameters, list + " of " + std::string(what), "the scene gives no other value"});
}

}  // namespace isoshade::render
