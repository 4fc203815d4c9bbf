// SPDX-License-Identifier: Apache-2.0
// The interpreter backend: the IR itself, a pixel at a time on one thread. It needs no compiler and no
// device, shares no generated text and no fast rasteriser with the others, and so bears witness to both.
#pragma once

#include <memory>

#include "backends/backend.h"

namespace isoshade::interpreter {

std::unique_ptr<backends::Backend> create();

}  // namespace isoshade::interpreter
