// SPDX-License-Identifier: Apache-2.0
// Which values of parameters a scene fixes, so that programs are compiled for them alone (driver/fixed.h).
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/driver/driver.h"
#include "runtime/render/parameters.h"
#include "runtime/render/stats.h"

namespace isoshade::render {

/// Keeps of `words` what is the same in `others`; an empty list of words keeps nothing.
void keep_common(driver::FixedWords& words, const driver::FixedWords& others);

/// Objects whose programs are compiled for the same values, or posts.
struct Variant {
  driver::FixedWords fixed;
  std::vector<size_t> members;  ///< in what variants_of() was given
};

inline constexpr size_t max_variants = 4;  ///< of one effect or post document: each is compiled by itself

/// Groups what gives values to one block, by the values that all copies and parts of each give. Those that differ in
/// switches (booleans, integers, and whether there is an image) are told apart, unless that makes more than max_variants.
std::vector<Variant> variants_of(const driver::ParameterBlock& block, std::span<const driver::FixedWords> given);

/// The same for the posts of a document, of which each has one value of every parameter: each is one variant, or if these
/// are more than max_variants they are grouped like objects.
std::vector<Variant> variants_of_posts(const driver::ParameterBlock& block, std::span<const driver::FixedWords> given);

/// The names of fields and images, one of whose words is fixed otherwise than `given` or not given at all.
std::vector<std::string> broken_by(const driver::ParameterBlock& block, const driver::FixedWords& fixed,
                                   const driver::FixedWords& given);

/// Reports what is fixed, if anything is. `what`: "the effect NAME"
void report_fixed(const driver::ParameterBlock& block, const driver::FixedWords& fixed, std::string_view what,
                  std::vector<Skipped>& skips);

}  // namespace isoshade::render
