// SPDX-License-Identifier: Apache-2.0
// What decode_image chooses among.
#pragma once

#include <string>
#include <string_view>

#include "runtime/scene/image_file.h"

namespace isoshade::scene {

/// Why an image of this size is not read; empty if it is.
std::string refuse_size(int64_t width, int64_t height);

/// Whether the bytes begin as such a file does.
bool is_exr(std::string_view bytes);
Read<ImageHeader> read_exr_header(std::string_view bytes);
Read<FileImage> decode_exr(std::string_view bytes);
bool is_hdr(std::string_view bytes);
Read<ImageHeader> read_hdr_header(std::string_view bytes);
Read<FileImage> decode_hdr(std::string_view bytes);
bool is_png(std::string_view bytes);
Read<ImageHeader> read_png_header(std::string_view bytes);
Read<FileImage> decode_png(std::string_view bytes);
bool is_jpeg(std::string_view bytes);
Read<ImageHeader> read_jpeg_header(std::string_view bytes);
Read<FileImage> decode_jpeg(std::string_view bytes);

}  // namespace isoshade::scene
