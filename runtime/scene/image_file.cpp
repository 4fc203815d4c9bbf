// SPDX-License-Identifier: Apache-2.0
#include "runtime/scene/image_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "compiler/support/assert.h"
#include "compiler/support/read_file.h"
#include "compiler/support/visible.h"
#include "runtime/scene/output_file.h"
#include "runtime/scene/scene.h"

namespace isoshade::scene {

using support::Diagnostics;
using support::Id;
using support::quote;

namespace {

constexpr ImageFormat formats[] = {
    {"png", "", "PNG", true, is_png, read_png_header, decode_png,
     [](const ByteView& image, const WriteOptions& options) {
       return png(image.width, image.height, image.rgba, options.threads);
     }},
    {"exr", "", "OpenEXR", true, is_exr, read_exr_header, decode_exr, nullptr,
     [](const ImageView& image, const WriteOptions& options) {
       return exr(image, options.compression, options.threads);
     }},
    {"jpg", "jpeg", "JPEG", false, is_jpeg, read_jpeg_header, decode_jpeg,
     [](const ByteView& image, const WriteOptions& options) { return jpeg(image, options.quality); }},
    {"ppm", "", "PPM", false, is_pnm, read_pnm_header, decode_pnm,
     [](const ByteView& image, const WriteOptions&) { return ppm(image); }},
    {"pfm", "", "PFM", false, is_pfm, read_pfm_header, decode_pfm, nullptr,
     [](const ImageView& image, const WriteOptions&) { return pfm(image); }},
    {"hdr", "", "Radiance HDR", false, is_hdr, read_hdr_header, decode_hdr}};

/// The format of this name or alias; null if there is none.
const ImageFormat* format_of_name(std::string_view name) {
  for (const ImageFormat& format : formats)
    if (!name.empty() && (name == format.name || name == format.alias)) return &format;
  return nullptr;
}

/// The format of the ending of this path, in any case; null if there is none.
const ImageFormat* format_of_ending(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  for (char& c : ending) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return ending.empty() ? nullptr : format_of_name(std::string_view(ending).substr(1));
}

/// "PNG, JPEG or EXR".
template <class Text>
std::string list_of(bool (*is_listed)(const ImageFormat&), const Text& text) {
  std::vector<std::string> texts;
  for (const ImageFormat& format : formats)
    if (is_listed(format)) texts.push_back(text(format));
  std::string list;
  for (size_t i = 0; i < texts.size(); ++i) list += (i == 0 ? "" : i + 1 == texts.size() ? " or " : ", ") + texts[i];
  return list;
}

/// Once for all images.
void warn_of_lost_alpha(const ImageFormat& format, const ImageView& image, const std::string& name,
                        Diagnostics& diagnostics) {
  size_t pixels = 0;
  for (size_t i = 3; i < image.rgba.size(); i += 4) pixels += image.rgba[i] < 1.0f;
  const std::string message = "an image with alpha is written as " + std::string(format.title) + ", which has none";
  if (pixels == 0 || std::ranges::find(diagnostics.all(), message, &support::Diagnostic::message) != diagnostics.all().end())
    return;
  diagnostics.report(Id::lost_alpha, message)
      .note(std::to_string(pixels) + " of " + std::to_string(image.rgba.size() / 4) + " pixels of " +
            (name == "-" ? "the image" : quote(name)) + " are not opaque; they are written as they look over black")
      .suggest("write a PNG or EXR file, or give the scene an opaque background");
}

bool is_written(const ImageFormat& format) { return format.is_written(); }
bool is_read(const ImageFormat& format) { return format.decode != nullptr; }

}  // namespace

std::span<const ImageFormat> image_formats() { return formats; }

std::string written_endings() {
  return list_of(is_written, [](const ImageFormat& format) { return "." + std::string(format.name); });
}

const ImageFormat* output_format(const std::string& path, const std::string& name, Diagnostics& diagnostics) {
  const ImageFormat* const told = path == "-" ? nullptr : format_of_ending(path);
  if (name.empty()) {
    const ImageFormat* const format = path == "-" ? &formats[0] : told;
    if (format != nullptr && format->is_written()) return format;
    diagnostics.report(Id::unwritable_file, "the name does not tell the image format of " + quote(path))
        .suggest("end the name in " + written_endings());
    return nullptr;
  }
  const ImageFormat* const format = format_of_name(name);
  support::assert_that(format != nullptr && format->is_written(), "no such format");
  if (told == nullptr || told == format) return format;
  diagnostics.report(Id::unwritable_file, "the name " + quote(path) + " does not fit the format " + name)
      .suggest("end the name in ." + name);
  return nullptr;
}

std::vector<uint8_t> encode_for(const ImageFormat& format, const ImageView& image, const WriteOptions& options,
                                const std::string& name, Diagnostics& diagnostics) {
  if (format.keeps_alpha) return encode(image.rgba, options.encoding, options.exposure, Alpha::straight, options.threads);
  warn_of_lost_alpha(format, image, name, diagnostics);
  return encode(image.rgba, options.encoding, options.exposure, Alpha::over_black, options.threads);
}

bool write_image(const std::string& path, const ImageFormat& format, const ImageView& image,
                 const WriteOptions& options, Diagnostics& diagnostics) {
  if (format.write_bytes != nullptr) {
    const std::vector<uint8_t> bytes = encode_for(format, image, options, path, diagnostics);
    return write_file(path, format.write_bytes({image.width, image.height, bytes}, options), diagnostics);
  }
  if (!format.keeps_alpha) warn_of_lost_alpha(format, image, path, diagnostics);
  return write_file(path, format.write_floats(image, options), diagnostics);
}

bool write_image(const std::string& path, const ImageView& image, const WriteOptions& options, Diagnostics& diagnostics) {
  const ImageFormat* const format = output_format(path, "", diagnostics);
  return format != nullptr && write_image(path, *format, image, options, diagnostics);
}

void make_finite(FileImage& image) {
  for (size_t i = 0; i < image.rgba.size(); i += 4) {
    bool finite = true;
    for (size_t c = i; c < i + 4; ++c) {
      float& value = image.rgba[c];
      if (std::isfinite(value)) continue;
      finite = false;
      value = std::isnan(value) ? 0.0f : std::copysign(greatest_texel, value);
    }
    if (!finite) ++image.not_finite;
  }
}

std::vector<float> numbers_of(const FileImage& image) {
  std::vector<float> numbers = image.rgba;
  numbers.reserve(std::max(numbers.size(), 4 * image.bytes.size()));
  for (const uint32_t word : image.bytes)
    for (int shift = 0; shift < 32; shift += 8)
      numbers.push_back(static_cast<float>(word >> shift & 255) / 255.0f);
  return numbers;
}

namespace {

/// The format that the bytes begin like; null if there is none.
const ImageFormat* format_of_bytes(std::string_view bytes) {
  for (const ImageFormat& format : formats)
    if (is_read(format) && format.is(bytes)) return &format;
  return nullptr;
}

std::string unknown_format() {
  return "it is not a " + list_of(is_read, [](const ImageFormat& format) { return std::string(format.title); }) + " file";
}

}  // namespace

Read<ImageHeader> read_header(std::string_view bytes) {
  const ImageFormat* const format = format_of_bytes(bytes);
  return format != nullptr ? format->read_header(bytes) : Read<ImageHeader>{{}, unknown_format()};
}

Read<FileImage> decode_image(std::string_view bytes) {
  const ImageFormat* const format = format_of_bytes(bytes);
  return format != nullptr ? format->decode(bytes) : Read<FileImage>{{}, unknown_format()};
}

std::string refuse_size(int64_t width, int64_t height) {
  if (width >= 1 && height >= 1 && width <= max_size && height <= max_size) return {};
  return "a side is not from 1 to " + std::to_string(max_size) + " pixels";
}

std::optional<std::string> read_image_file(const std::string& path, Diagnostics& diagnostics,
                                           const support::Span& where) {
  constexpr size_t most = (size_t{2} << 30) - 1;  // readers count in int
  auto [bytes, id, reason] = support::read_file(path, most);
  if (!bytes) diagnostics.report(id, where, "cannot read " + quote(path) + ": " + reason);
  return std::move(bytes);
}

namespace {

template <class T>
std::optional<T> reported(Read<T> read, const std::string& name, Diagnostics& diagnostics,
                          const support::Span& where) {
  if (!read.found) {
    diagnostics.report(Id::bad_image, where,
                       "cannot read the image " + quote(name) + ": " + support::visible(read.reason));
  }
  return std::move(read.found);
}

}  // namespace

std::optional<ImageHeader> read_header(const std::string& name, std::string_view bytes,
                                       Diagnostics& diagnostics, const support::Span& where) {
  return reported(read_header(bytes), name, diagnostics, where);
}

std::optional<FileImage> read_image(const std::string& name, std::string_view bytes, Diagnostics& diagnostics,
                                    const support::Span& where) {
  auto image = reported(decode_image(bytes), name, diagnostics, where);
  if (image && image->not_finite > 0) {
    const bool one = image->not_finite == 1;
    diagnostics
        .report(Id::not_finite, where,
                std::to_string(image->not_finite) + (one ? " pixel" : " pixels") + " of the image " +
                    quote(name) + (one ? " is" : " are") + " not finite")
        .note("infinity is read as 65504, and NaN as 0");
  }
  return image;
}

std::optional<FileImage> read_image(const std::string& path, Diagnostics& diagnostics,
                                    const support::Span& where) {
  const std::optional<std::string> bytes = read_image_file(path, diagnostics, where);
  return bytes ? read_image(path, *bytes, diagnostics, where) : std::nullopt;
}

}  // namespace isoshade::scene
