// SPDX-License-Identifier: Apache-2.0
// The reference backend computes graphs as their authors wrote them, with 57 digits. The error of all other backends,
// which agree on every bit, is measured against it. Its programs are compiled with driver::CompileOptions::reference.
#pragma once

#include <memory>
#include <vector>

#include "backends/backend.h"
#include "backends/reference/real.h"

namespace isoshade::reference {

/// The largest side of an image: a pixel takes about ten thousand times as long as on the cpu.
inline constexpr int max_size = 256;

/// Positions and visibility are computed in floats, as by every backend, so each pixel shows the same triangle. In the
/// pixel kernel every number from the loads on is a Real; only the color is rounded, at the end. Reports images with
/// more than max_size samples a side.
std::unique_ptr<backends::Backend> create();

/// As Backend::evaluate, but floats are not rounded. Ints and bools are numbers too.
std::vector<Real> evaluate(const driver::Program& program, std::span<const int32_t> inputs, size_t rows);

}  // namespace isoshade::reference
