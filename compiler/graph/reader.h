// SPDX-License-Identifier: Apache-2.0
// Reads a JSON object with a known set of keys, and reports errors in it.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/graph/document.h"

namespace isoshade::graph {

/// Whether it is an integer that fits int64, in any notation: in JSON, 1.0 and 1e0 are 1.
bool is_whole(const Json& json);

/// The closed range of numbers that a key accepts.
struct Range {
  double low = -std::numeric_limits<float>::max();
  double high = std::numeric_limits<float>::max();
};

/// Usage:
///
///     ObjectReader reader(document, json, "a camera", diagnostics);
///     camera.eye = reader.numbers<3>("eye");                   // required
///     camera.fov = reader.number("fov", {1, 179}, 45.0f);      // optional, because it has a fallback
///     if (!reader.finish()) return std::nullopt;               // reports unknown keys
///
/// If a key is wrong, or missing although required, reading it reports the error and returns the fallback or an
/// empty value; continue reading, so that authors see all errors of an object in one run. "extras" is always
/// allowed. The document and the keys (usually string literals) must outlive the reader.
class ObjectReader {
 public:
  /// `what` names the object in messages: "a camera", "pass \"base\"". If `json` is not an object, reports that;
  /// every read then returns its fallback or an empty value without further reports.
  ObjectReader(const Document& document, const Json& json, std::string what,
               support::Diagnostics& diagnostics);

  enum class Need { required, optional };

  /// The value, of any kind, or null. Marks the key as known.
  const Json* value(std::string_view key, Need need = Need::required);
  /// The value if it has that kind, else null.
  const Json* object(std::string_view key, Need need = Need::required);
  const Json* array(std::string_view key, Need need = Need::required);

  bool boolean(std::string_view key, std::optional<bool> fallback = {});
  std::string string(std::string_view key, std::optional<std::string> fallback = {});
  /// A path, resolved relative to the folder of the source that contains it, or else to the working directory.
  std::string path(std::string_view key);
  /// Rounded once to float; denormals flush to zero.
  float number(std::string_view key, Range range = {}, std::optional<float> fallback = {});
  /// Like number(), for a key without a default.
  std::optional<float> optional_number(std::string_view key, Range range = {});
  int64_t integer(std::string_view key, Range range, std::optional<int64_t> fallback = {});

  /// An array of exactly N numbers, each in `range`.
  template <size_t N>
  std::array<float, N> numbers(std::string_view key, Range range = {},
                               std::optional<std::array<float, N>> fallback = {}) {
    std::array<float, N> values = fallback.value_or(std::array<float, N>{});
    read_numbers(key, values.data(), N, range, fallback ? Need::optional : Need::required);
    return values;
  }

  /// The index of the string in `choices`.
  size_t choice(std::string_view key, const std::vector<std::string_view>& choices,
                std::optional<size_t> fallback = {});

  /// Allows a key without reading it.
  void ignore(std::string_view key) { value(key, Need::optional); }

  /// Reports all keys that were never read. Returns whether the reader reported no error.
  bool finish();

  /// Reports that `json` must be `expected` ("an array of 2 numbers").
  void report_wrong(std::string_view key, const Json& json, std::string_view expected);
  /// Whether `number` (a JSON number) lies in `range`; reports it otherwise.
  bool check_range(std::string_view key, const Json& number, Range range);

 private:
  const Json* value_of_kind(std::string_view key, Json::Kind kind, Need need);
  void read_numbers(std::string_view key, float* values, size_t count, Range range, Need need);

  const Document& document_;
  const Json& json_;
  std::string what_;
  support::Diagnostics& diagnostics_;
  size_t errors_before_;
  std::vector<std::string_view> known_;  ///< the keys read so far, as views of the caller's strings
  std::vector<bool> read_;               ///< by member of the object
};

}  // namespace isoshade::graph
