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
/// PNG and JPEG; nothing else that stb would read.
Read<ImageHeader> read_stb_header(std::string_view bytes);
Read<FileImage> decode_by_stb(std::string_view bytes);

}  // namespace isoshade::scene
