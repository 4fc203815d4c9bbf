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

std::vector<BlockItem> items_of(const ParameterBlock& block) {
  std::vector<BlockItem> items;
  for (size_t i = 0; i < block.fields.size(); ++i) {
    const Field& field = block.fields[i];
    const graph::Type type = type_of(field);
    const bool is_switch = type == graph::Type::boolean || type == graph::Type::integer;
    if (field.words > 0) items.push_back({field.name, block.word_of(i), static_cast<size_t>(field.words), is_switch});
  }
  for (size_t i = 0; i < block.images.size(); ++i)
    items.push_back({block.images[i].slot.name, block.word_of_image(i), 1, true});
  return items;
}

}  // namespace isoshade::driver
