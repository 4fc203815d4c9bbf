// SPDX-License-Identifier: Apache-2.0
// What is asked of the data of a chunk of an OpenEXR file before the library unpacks them: that they give every sample of
// the chunk. OpenEXR 3.1 does not ask that; it takes the samples that are missing from memory that nothing has written.
#pragma once

#include <cstdint>
#include <string_view>

#include "runtime/scene/exr_file.h"

namespace isoshade::scene::exr_file {

/// Whether the data give all samples of these pixels. What PIZ, PXR24, B44 and B44A give is asked by the library.
bool data_fill(const Part& part, const Window& pixels, std::string_view data);

/// The samples along `pixels`, the first of which has one, where one of every `sampling` has one.
int64_t samples(int64_t pixels, int64_t sampling);
/// The rows of these pixels that have samples of a channel.
int64_t sampled_rows(const Part& part, const Window& pixels, const Channel& channel);
int64_t bytes_of(PixelType type);

/// Whether zlib unpacks the data to exactly so many bytes.
bool inflates_to(std::string_view data, int64_t size);

/// The same of the data of DWAA and DWAB.
bool dwa_fills(const Part& part, const Window& pixels, std::string_view data);

}  // namespace isoshade::scene::exr_file
