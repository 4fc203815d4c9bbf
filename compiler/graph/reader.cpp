// SPDX-License-Identifier: Apache-2.0
#include "compiler/graph/reader.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "compiler/graph/files.h"
#include "compiler/support/parse_number.h"
#include "compiler/support/visible.h"

namespace isoshade::graph {

using support::Id;
using support::quote;

namespace {

std::string decimal(double value) {
  // Most limits are integers; print them without a fraction.
  if (value == std::floor(value) && std::abs(value) < 1e15)
    return std::to_string(static_cast<int64_t>(value));
  return support::format_float(static_cast<float>(value));
}

std::string join(const std::vector<std::string_view>& words) {
  std::string text;
  for (const std::string_view word : words) text.append(text.empty() ? "" : ", ").append(word);
  return text;
}

}  // namespace

bool is_whole(const Json& json) {
  if (json.kind != Json::Kind::number) return false;
  constexpr double limit = 0x1p53;  // doubles represent all integers up to this exactly
  return json.integral || (std::abs(json.number) <= limit && json.number == std::floor(json.number));
}

ObjectReader::ObjectReader(const Document& document, const Json& json, std::string what,
                           support::Diagnostics& diagnostics)
    : document_(document),
      json_(json),
      what_(std::move(what)),
      diagnostics_(diagnostics),
      errors_before_(diagnostics.error_count()),
      read_(json.members.size()) {
  ignore("extras");
  known_.clear();  // "extras" is always allowed, so it is not worth suggesting
  if (json.kind == Json::Kind::object) return;
  diagnostics.report(Id::wrong_type, document.span(json),
                     what_ + " must be an object, not " + std::string(kind_name(json.kind)));
}

const Json* ObjectReader::value(std::string_view key, Need need) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.push_back(key);
  for (size_t i = 0; i < json_.members.size(); ++i) {
    if (json_.members[i].key != key) continue;
    read_[i] = true;
    return &json_.members[i].value;
  }
  if (need == Need::required && json_.kind == Json::Kind::object) {
    diagnostics_.report(Id::missing_key, {document_.source_of(json_), json_.begin, json_.begin + 1},
                        what_ + " needs the key " + quote(key));
  }
  return nullptr;
}

void ObjectReader::report_wrong(std::string_view key, const Json& json, std::string_view expected) {
  diagnostics_.report(Id::wrong_type, document_.span(json),
                      quote(key) + " of " + what_ + " must be " + std::string(expected) + ", not " +
                          std::string(kind_name(json.kind)));
}

bool ObjectReader::check_range(std::string_view key, const Json& number, Range range) {
  // Compare before rounding, which may move a number out of the range. Numbers beyond float are never in range.
  if (number.number >= range.low && number.number <= range.high &&
      std::isfinite(document_.to_float(number))) {
    return true;
  }
  const Range all;
  const bool low = range.low > all.low, high = range.high < all.high;
  std::string allowed = low && high ? "from " + decimal(range.low) + " to " + decimal(range.high)
                        : low       ? "at least " + decimal(range.low)
                        : high      ? "at most " + decimal(range.high)
                                    : "in the range of float";
  diagnostics_.report(Id::out_of_range, document_.span(number),
                      quote(key) + " of " + what_ + " must be " + allowed);
  return false;
}

const Json* ObjectReader::value_of_kind(std::string_view key, Json::Kind kind, Need need) {
  const Json* found = value(key, need);
  if (found == nullptr || found->kind == kind) return found;
  report_wrong(key, *found, kind_name(kind));
  return nullptr;
}

const Json* ObjectReader::object(std::string_view key, Need need) {
  return value_of_kind(key, Json::Kind::object, need);
}

const Json* ObjectReader::array(std::string_view key, Need need) {
  return value_of_kind(key, Json::Kind::array, need);
}

bool ObjectReader::boolean(std::string_view key, std::optional<bool> fallback) {
  const Json* found = value_of_kind(key, Json::Kind::boolean, fallback ? Need::optional : Need::required);
  return found ? found->boolean : fallback.value_or(false);
}

std::string ObjectReader::string(std::string_view key, std::optional<std::string> fallback) {
  const Json* found = value_of_kind(key, Json::Kind::string, fallback ? Need::optional : Need::required);
  return found ? found->string : std::move(fallback).value_or("");
}

std::string ObjectReader::path(std::string_view key) {
  const Json* found = value_of_kind(key, Json::Kind::string, Need::required);
  return found ? path_beside(document_.source_of(*found)->path(), found->string) : "";
}

float ObjectReader::number(std::string_view key, Range range, std::optional<float> fallback) {
  const Json* found = value_of_kind(key, Json::Kind::number, fallback ? Need::optional : Need::required);
  if (found == nullptr || !check_range(key, *found, range)) return fallback.value_or(0.0f);
  return document_.to_float(*found);
}

std::optional<float> ObjectReader::optional_number(std::string_view key, Range range) {
  const Json* found = value_of_kind(key, Json::Kind::number, Need::optional);
  if (found == nullptr || !check_range(key, *found, range)) return std::nullopt;
  return document_.to_float(*found);
}

int64_t ObjectReader::integer(std::string_view key, Range range, std::optional<int64_t> fallback) {
  const Json* found = value(key, fallback ? Need::optional : Need::required);
  if (found == nullptr) return fallback.value_or(0);
  if (!is_whole(*found)) {
    if (found->kind == Json::Kind::number) {
      diagnostics_.report(Id::wrong_type, document_.span(*found),
                          quote(key) + " of " + what_ + " must be an integer");
    } else {
      report_wrong(key, *found, "an integer");
    }
    return fallback.value_or(0);
  }
  if (!check_range(key, *found, range)) return fallback.value_or(0);
  return document_.to_integer(*found);
}

void ObjectReader::read_numbers(std::string_view key, float* values, size_t count, Range range, Need need) {
  const Json* found = value(key, need);
  if (found == nullptr) return;
  const std::string expected = "an array of " + std::to_string(count) + " numbers";
  if (found->kind != Json::Kind::array) return report_wrong(key, *found, expected);
  if (found->items.size() != count) {
    diagnostics_.report(
        Id::wrong_type, document_.span(*found),
        quote(key) + " of " + what_ + " must be " + expected + ", not of " + std::to_string(found->items.size()));
    return;
  }
  for (size_t i = 0; i < count; ++i) {
    const Json& item = found->items[i];
    const std::string name = std::string(key) + "[" + std::to_string(i) + "]";
    if (item.kind != Json::Kind::number) return report_wrong(name, item, "a number");
    if (!check_range(name, item, range)) return;
  }
  for (size_t i = 0; i < count; ++i) values[i] = document_.to_float(found->items[i]);
}

size_t ObjectReader::choice(std::string_view key, const std::vector<std::string_view>& choices,
                            std::optional<size_t> fallback) {
  const Json* found = value_of_kind(key, Json::Kind::string, fallback ? Need::optional : Need::required);
  if (found == nullptr) return fallback.value_or(0);
  const auto place = std::find(choices.begin(), choices.end(), found->string);
  if (place != choices.end()) return static_cast<size_t>(place - choices.begin());
  diagnostics_.report_unknown(
      Id::unknown_choice, document_.span(*found),
      quote(key) + " of " + what_ + " must be one of " + join(choices) + ", not " + quote(found->string),
      found->string, choices);
  return fallback.value_or(0);
}

bool ObjectReader::finish() {
  for (size_t i = 0; i < read_.size() && json_.kind == Json::Kind::object; ++i) {
    if (read_[i]) continue;
    const Member& member = json_.members[i];
    support::Diagnostic& report =
        diagnostics_.report_unknown(Id::unknown_key, document_.key_span(member),
                                    what_ + " has no key " + quote(member.key), member.key, known_);
    if (report.fix.empty()) report.note("its keys are " + join(known_));
  }
  return diagnostics_.error_count() == errors_before_;
}

}  // namespace isoshade::graph
