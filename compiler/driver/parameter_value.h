// SPDX-License-Identifier: Apache-2.0
// Values for fields of a parameter block: whether they fit, and as words of a record.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "compiler/driver/parameter_block.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::driver {

/// Whether a record, which holds floats, has the integer; reports one that it has not.
bool check_integer(const Field& field, int64_t value, const support::Span& where, support::Diagnostics& diagnostics);

/// Whether a value has the type of the field and lies in its range; reports one that does not.
bool check_fit(const Field& field, const graph::Literal& literal, const support::Span& where,
               support::Diagnostics& diagnostics);

/// Writes a value into the record. `names`: of an integer's values.
void store(graph::Type type, const std::vector<std::string>& names, const graph::Literal& literal, float* words);

}  // namespace isoshade::driver
