// SPDX-License-Identifier: Apache-2.0
// Which values of parameters a scene fixes, so that programs are compiled for them alone (driver/fixed.h).
#pragma once

#include <cstddef>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "compiler/driver/driver.h"
#include "compiler/driver/reads.h"
#include "runtime/render/parameters.h"

namespace isoshade::render {

/// Keeps of `words` what is the same in `others`; an empty list of words keeps nothing.
void keep_common(driver::FixedWords& words, const driver::FixedWords& others);

/// Objects whose programs are compiled for the same values, or posts.
template <class Document>
struct Variant {
  Document document;            ///< the effect or post with these programs
  std::vector<size_t> members;  ///< in what variants_of() was given
};

inline constexpr size_t max_variants = 4;  ///< of one effect or post document

/// Groups what gives values to one block: those that differ in switches (booleans, integers, whether there is an image) are
/// told apart, unless that makes more than max_variants. `reads`: whether the programs read a word.
std::vector<std::vector<size_t>> groups_of(const driver::ParameterBlock& block,
                                           std::span<const driver::FixedWords> given, const std::vector<bool>& reads);

/// The operations of all programs.
uint64_t operations(const driver::Effect& effect);
uint64_t operations(const driver::Post& post);

/// Makes programs for the values that are `given`: for those that all have in common, or several where that saves a quarter
/// of the operations on average. A compiler takes time for each of them, so together they have at most a quarter more than
/// the programs for all. `make(fixed)` compiles the document.
template <class Document, class Make>
std::vector<Variant<Document>> variants_of(const driver::ParameterBlock& block, std::span<const driver::FixedWords> given,
                                           const Make& make) {
  const auto made_for = [&](std::vector<size_t> members) {
    driver::FixedWords fixed = given[members.front()];
    for (const size_t member : members) keep_common(fixed, given[member]);
    return Variant<Document>{make(std::move(fixed)), std::move(members)};
  };
  std::vector<size_t> all(given.size());
  std::iota(all.begin(), all.end(), size_t{0});
  std::vector<Variant<Document>> whole;
  whole.push_back(made_for(std::move(all)));
  const auto groups = groups_of(block, given, driver::words_read(whole[0].document));
  if (groups.size() == 1) return whole;
  std::vector<Variant<Document>> variants;
  uint64_t run = 0, compiled = 0;
  for (const std::vector<size_t>& group : groups) {
    variants.push_back(made_for(group));
    const uint64_t count = operations(variants.back().document);
    compiled += count;
    run += count * group.size();
  }
  const uint64_t of_whole = operations(whole[0].document);
  const bool saves = 4 * run <= 3 * of_whole * given.size() && 4 * compiled <= 5 * of_whole;
  return saves ? std::move(variants) : std::move(whole);
}

/// The names of fields and images, one of whose words is fixed otherwise than `given` or not given at all.
std::vector<std::string> broken_by(const driver::ParameterBlock& block, const driver::FixedWords& fixed,
                                   const driver::FixedWords& given);

}  // namespace isoshade::render
