// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/parameter_block.h"

#include <algorithm>

#include "compiler/support/assert.h"

namespace isoshade::driver {

std::optional<size_t> ParameterBlock::find(std::string_view name) const {
  const auto found = std::ranges::find(fields, name, &Field::name);
  if (found == fields.end()) return std::nullopt;
  return static_cast<size_t>(found - fields.begin());
}

size_t ParameterBlock::word_of(size_t field) const {
  size_t word = 0;
  for (size_t i = 0; i < field; ++i) word += static_cast<size_t>(fields[i].words);
  return word;
}

std::vector<float> ParameterBlock::defaults() const {
  std::vector<float> record;
  for (const Field& field : fields) record.insert(record.end(), field.value.begin(), field.value.end());
  record.insert(record.end(), images.size(), -1.0f);
  for (const Field& count : taps) record.push_back(count.value[0]);
  return record;
}

graph::Type type_of(const Field& field) {
  const std::optional<graph::Type> type = graph::find_type(field.type);
  support::assert_that(type.has_value(), "a field has a type that does not exist");
  return *type;
}

}  // namespace isoshade::driver
