// SPDX-License-Identifier: Apache-2.0
// What scenes have at most. The runtime refuses more, and what `isoshade check` proves relies on it.
#pragma once

namespace isoshade::lower {

inline constexpr int max_size = 8192;  ///< of each side of an image or a texture, in pixels
inline constexpr int max_lights = 1024;

}  // namespace isoshade::lower
