// SPDX-License-Identifier: Apache-2.0
// The reference backend: graphs as their authors wrote them, in arithmetic of 57 digits. What all other backends agree
// on is measured against it. It takes programs compiled with driver::CompileOptions::reference.
#pragma once

#include <memory>
#include <vector>

#include "backends/backend.h"
#include "backends/reference/real.h"

namespace isoshade::reference {

/// The most that it draws, each way: a pixel takes some ten thousand times as long as on the cpu.
inline constexpr int max_size = 256;

/// Positions and visibility are those of every backend, in floats: the same triangle is shaded at each pixel. From the
/// loads of the pixel's kernel on, its interpolation too, every number is a Real; the color is rounded at the end.
/// Images of more samples a side than max_size are reported.
std::unique_ptr<backends::Backend> create();

/// As Backend::evaluate, but floats are not rounded. Ints and bools are numbers too.
std::vector<Real> evaluate(const driver::Program& program, std::span<const int32_t> inputs, size_t rows);

}  // namespace isoshade::reference
