// SPDX-License-Identifier: Apache-2.0
#include "runtime/scene/image_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "compiler/support/read_file.h"
#include "compiler/support/visible.h"
#include "runtime/scene/output_file.h"
#include "runtime/scene/scene.h"

namespace isoshade::scene {

using support::Diagnostics;
using support::Id;
using support::quote;

namespace {

enum class Format { png, exr, unknown };

Format format_of(const std::string& path) {
  if (path == "-") return Format::png;
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".png" || extension == ".PNG") return Format::png;
  if (extension == ".exr" || extension == ".EXR") return Format::exr;
  return Format::unknown;
}

}  // namespace

bool check_image_path(const std::string& path, Diagnostics& diagnostics) {
  if (format_of(path) != Format::unknown) return true;
  diagnostics.report(Id::unwritable_file, "the name does not tell the image format of " + quote(path))
      .suggest("end the name in .png or .exr");
  return false;
}

bool write_image(const std::string& path, const ImageView& image, Encoding encoding, float exposure,
                 Diagnostics& diagnostics) {
  if (!check_image_path(path, diagnostics)) return false;
  if (format_of(path) == Format::exr) return write_file(path, exr(image), diagnostics);
  return write_file(path, png(image.width, image.height, encode(image.rgba, encoding, exposure)),
                    diagnostics);
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

struct Codec {
  bool (*is)(std::string_view);
  Read<ImageHeader> (*read_header)(std::string_view);
  Read<FileImage> (*decode)(std::string_view);
};
constexpr Codec codecs[] = {{is_png, read_png_header, decode_png},
                            {is_jpeg, read_jpeg_header, decode_jpeg},
                            {is_exr, read_exr_header, decode_exr},
                            {is_hdr, read_hdr_header, decode_hdr}};
constexpr const char* unknown_format = "it is not a PNG, JPEG, HDR or EXR file";

}  // namespace

Read<ImageHeader> read_header(std::string_view bytes) {
  for (const Codec& codec : codecs)
    if (codec.is(bytes)) return codec.read_header(bytes);
  return {{}, unknown_format};
}

Read<FileImage> decode_image(std::string_view bytes) {
  for (const Codec& codec : codecs)
    if (codec.is(bytes)) return codec.decode(bytes);
  return {{}, unknown_format};
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
