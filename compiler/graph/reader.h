// SPDX-License-Identifier: Apache-2.0
// Reads one JSON object whose keys are known, and reports what an author gets wrong in it.
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

/// Whether it is an integer that fits int64, written in whatever way: to JSON, 1.0 and 1e0 are 1.
bool is_whole(const Json& json);

/// The numbers that a key takes, both ends included.
struct Range {
  double low = -std::numeric_limits<float>::max();
  double high = std::numeric_limits<float>::max();
};

/// Usage:
///
///     ObjectReader reader(document, json, "a camera", diagnostics);
///     camera.eye = reader.numbers<3>("eye");                   // required
///     camera.fov = reader.number("fov", {1, 179}, 45.0f);      // optional: it has a fallback
///     if (!reader.finish()) return std::nullopt;               // reports unknown keys
///
/// A read of a key that is missing (and required) or wrong reports so and returns the fallback, or an empty
/// value; go on reading, so that an author sees all errors of an object in one run. "extras" is free. Keys are
/// literals: the reader keeps views of them. The document must outlive the reader.
class ObjectReader {
 public:
  /// `what` names the object in messages: "a camera", "pass \"base\"". Reports a `json` that is no object;
  /// then every read returns its fallback or an empty value and reports nothing more.
  ObjectReader(const Document& document, const Json& json, std::string what,
               support::Diagnostics& diagnostics);

  enum class Need { required, optional };

  /// The value of any kind, or null. Marks the key as known.
  const Json* value(std::string_view key, Need need = Need::required);
  /// The value if it is of that kind, or null.
  const Json* object(std::string_view key, Need need = Need::required);
  const Json* array(std::string_view key, Need need = Need::required);

  bool boolean(std::string_view key, std::optional<bool> fallback = {});
  std::string string(std::string_view key, std::optional<std::string> fallback = {});
  /// A path, which counts from the folder of the text that has it; from the working directory if that is none.
  std::string path(std::string_view key);
  /// Rounded once to float; denormals are zeros.
  float number(std::string_view key, Range range = {}, std::optional<float> fallback = {});
  /// As number(), of a key that may be left out.
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

  /// The place of the string among `choices`.
  size_t choice(std::string_view key, const std::vector<std::string_view>& choices,
                std::optional<size_t> fallback = {});

  /// Lets a key stand that nobody reads.
  void ignore(std::string_view key) { value(key, Need::optional); }

  /// Reports all keys that were never asked for. Returns whether the reader has reported no error.
  bool finish();

  /// Reports that `json` is not "an array of 2 numbers".
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
  std::vector<std::string_view> known_;  ///< keys asked for, as passed in: literals of the caller
  std::vector<bool> read_;               ///< of each member of the object
};

}  // namespace isoshade::graph
