// SPDX-License-Identifier: Apache-2.0
// How texts and arrays are written into a page.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace isoshade::page {

/// A file of the page's own source, runtime/page/web. They are embedded in the command.
struct PageFile {
  std::string_view path;  ///< in that folder: "page.css"
  std::string_view text;
};
std::span<const PageFile> page_files();

/// The bytes in base64 (RFC 4648), padded.
std::string base64(std::span<const std::byte> bytes);
template <class Number>
std::string base64(std::span<const Number> numbers) {
  return base64(std::as_bytes(numbers));
}
/// The number of characters of that.
constexpr size_t base64_size(size_t bytes) { return (bytes + 2) / 3 * 4; }

/// JSON as the text of a <script>: the same JSON, without the characters that may end or change the element.
std::string script_json(std::string json);

/// The source of a content security policy that allows an element with exactly this text: 'sha256-...'.
std::string policy_source(std::string_view text);

}  // namespace isoshade::page
