// SPDX-License-Identifier: Apache-2.0
// GLSL ES 3.00, for WebGL 2.0: pure shaders, but no kernels (it has no storage buffers).
#pragma once

#include "compiler/emit/target.h"

namespace isoshade::glsl_es {

const emit::Target& target();

}  // namespace isoshade::glsl_es
