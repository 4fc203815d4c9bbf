// SPDX-License-Identifier: Apache-2.0
// The CSV tables of `isoshade eval`.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "backends/reference/real.h"
#include "compiler/driver/program.h"
#include "compiler/support/diagnostics.h"

namespace isoshade::cli {

/// The words of all rows, row by row, in the order of the fields.
struct Table {
  size_t rows = 0;
  std::vector<int32_t> words;
};

/// The column names of a field: its name, or "l.x" "l.y" ... for vectors and colours, "m.0" ... for matrices.
std::vector<std::string> columns_of(const driver::Field& field);

/// Reads a table whose first line names the columns, in any order. Floats are decimal or hexadecimal ("0x1.8p+1"), `nan`,
/// `inf` or `-inf`; denormals become zeros. Booleans are 0 or 1. Unknown and missing columns are errors.
std::optional<Table> read_table(const support::Source& source, const std::vector<driver::Field>& fields,
                                support::Diagnostics& diagnostics);

/// Writes floats in hexadecimal, which preserves every bit.
std::string write_table(const Table& table, const std::vector<driver::Field>& fields);

/// Writes the numbers of the reference in decimal: up to 40 significant digits.
std::string write_table(std::span<const reference::Real> numbers, size_t rows,
                        const std::vector<driver::Field>& fields);

}  // namespace isoshade::cli
