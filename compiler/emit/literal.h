// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace isoshade::emit {

/// A finite float in 9 significant digits, which determine it, with a point or an exponent: "0.5", "1e-30".
std::string decimal(uint32_t bits);

bool is_finite(uint32_t bits);

}  // namespace isoshade::emit
