// SPDX-License-Identifier: Apache-2.0
#include "runtime/cli/argument_texts.h"

#include <algorithm>
#include <cstdio>
#include <vector>

#include "compiler/support/parse_number.h"

namespace isoshade::cli {
namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text)
    if (c == separator)
      parts.emplace_back();
    else
      parts.back() += c;
  return parts;
}

std::optional<int> parse_count(const std::string& digits, int most) {
  if (digits.empty() || digits.size() > 6 || digits.find_first_not_of("0123456789") != std::string::npos)
    return std::nullopt;
  const int count = std::stoi(digits);
  return count >= 1 && count <= most ? std::optional(count) : std::nullopt;
}

std::optional<std::vector<float>> parse_numbers(const std::string& text) {
  std::vector<float> numbers;
  for (const std::string& part : split(text, ',')) {
    const auto number = support::parse_float_in_range(part);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

/// With four digits, as a caption.
std::string number_text(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", number);
  return text;
}

}  // namespace

std::optional<Size> parse_size(const std::string& text) {
  const std::vector<std::string> sides = split(text, 'x');
  if (sides.size() != 2) return std::nullopt;
  const auto width = parse_count(sides[0], 8192), height = parse_count(sides[1], 8192);
  return width && height ? std::optional(Size{*width, *height}) : std::nullopt;
}

std::optional<NamedRange> parse_range(const std::string& text) {
  const size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos) return std::nullopt;
  const std::vector<std::string> ends = split(text.substr(equals + 1), ':');
  if (ends.size() != 2) return std::nullopt;
  const auto lo = support::parse_float_in_range(ends[0]), hi = support::parse_float_in_range(ends[1]);
  if (!lo || !hi || !(*lo <= *hi)) return std::nullopt;
  return NamedRange{text.substr(0, equals), *lo, *hi};
}

std::optional<VariedParameter> parse_varied(const std::string& text) {
  constexpr int most = 64;
  const size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos) return std::nullopt;
  VariedParameter varied{text.substr(0, equals), {}};
  const std::string rest = text.substr(equals + 1);
  const std::vector<std::string> steps = split(rest, ':');
  if (steps.size() == 3) {
    const auto from = parse_numbers(steps[0]), to = parse_numbers(steps[1]);
    const auto count = parse_count(steps[2], most);
    if (!from || !to || !count || from->size() != to->size()) return std::nullopt;
    for (int i = 0; i < *count; ++i) {
      const double share = *count == 1 ? 0 : static_cast<double>(i) / (*count - 1);
      std::string value;
      for (size_t k = 0; k < from->size(); ++k)
        value += (k == 0 ? "" : ",") + number_text((1 - share) * double{(*from)[k]} + share * double{(*to)[k]});
      varied.values.push_back(std::move(value));
    }
    return varied;
  }
  varied.values = split(rest, ';');
  for (const std::string& value : varied.values)
    if (value.empty()) return std::nullopt;
  if (steps.size() != 1 || varied.values.size() > static_cast<size_t>(most)) return std::nullopt;
  return varied;
}

std::optional<FrameTimes> parse_frames(const std::string& text) {
  constexpr int most_frames = 999'999;
  const std::vector<std::string> parts = split(text, ':');
  if (parts.size() == 1) {
    const auto count = parse_count(text, most_frames);
    return count ? std::optional(FrameTimes{.count = *count, .at_scene_time = true}) : std::nullopt;
  }
  if (parts.size() != 3) return std::nullopt;
  const auto time = [](const std::string& part) {
    const auto number = support::parse_float_in_range(part);
    return number && *number >= -1e9f && *number <= 1e9f ? number : std::nullopt;
  };
  const auto from = time(parts[0]), to = time(parts[1]);
  const auto count = parse_count(parts[2], most_frames);
  return from && to && count && *from <= *to ? std::optional(FrameTimes{*from, *to, *count, false}) : std::nullopt;
}

std::optional<NumberedPath> NumberedPath::parse(const std::string& text) {
  NumberedPath path;
  bool has_field = false;
  for (size_t i = 0; i < text.size(); ++i) {
    std::string& part = has_field ? path.after_ : path.before_;
    if (text[i] != '%') {
      part += text[i];
      continue;
    }
    if (i + 1 < text.size() && text[i + 1] == '%') {
      part += '%';
      ++i;
      continue;
    }
    size_t end = i + 1;
    while (end < text.size() && text[end] >= '0' && text[end] <= '9') ++end;
    const std::string digits = text.substr(i + 1, end - i - 1);
    if (has_field || end == text.size() || text[end] != 'd' || digits.size() > 3) return std::nullopt;
    has_field = true;
    path.fill_ = digits.starts_with('0') ? '0' : ' ';
    path.width_ = digits.empty() ? 0 : static_cast<size_t>(std::stoi(digits));
    i = end;
  }
  return has_field ? std::optional(path) : std::nullopt;
}

std::string NumberedPath::of(int number) const {
  const std::string digits = std::to_string(number);
  return before_ + std::string(width_ - std::min(width_, digits.size()), fill_) + digits + after_;
}

}  // namespace isoshade::cli
