// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "compiler/support/visible.h"
#include "runtime/scene/parse_parts.h"

namespace isoshade::scene::format {

using graph::Json;
using support::Id;

std::array<int, 2> ObjectReader::read_size(std::string_view key, const Size& type) {
  std::array<int, 2> size = type.fallback;
  const Json* json = array(key, Need::optional);
  if (json == nullptr) return size;
  if (json->items.size() != size.size() || !std::ranges::all_of(json->items, graph::is_whole)) {
    diagnostics_.report(Id::wrong_type, document_.span(*json),
                        support::quote(key) + " of " + what_ + " is an array of 2 integers");
    return size;
  }
  for (size_t i = 0; i < size.size(); ++i)
    if (check_range(key, json->items[i], type.range))
      size[i] = static_cast<int>(document_.to_integer(json->items[i]));
  return size;
}

std::array<float, 3> ObjectReader::read_scale(std::string_view key, const Scale& type) {
  constexpr std::array<float, 3> one{1, 1, 1};
  const Json* json = value(key, Need::optional);
  if (json == nullptr) return one;
  if (json->kind == Json::Kind::number) {
    const float factor = number(key, type.range, 1.0f);
    return {factor, factor, factor};
  }
  if (json->kind == Json::Kind::array) return numbers<3>(key, type.range, one);
  report_wrong(key, *json, "a number or an array of 3 numbers");
  return one;
}

std::array<float, 4> ObjectReader::read_rotation(std::string_view key, const Rotation& type,
                                                 bool& is_quaternion) {
  const Json* json = value(key, Need::optional);
  is_quaternion = json != nullptr && json->kind == Json::Kind::array && json->items.size() == 4;
  if (is_quaternion) return numbers<4>(key, {-1, 1}, {{0, 0, 0, 1}});
  const std::array<float, 3> angles = numbers<3>(key, type.range, {{0, 0, 0}});
  return {angles[0], angles[1], angles[2], 0};
}

}  // namespace isoshade::scene::format
