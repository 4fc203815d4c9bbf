// SPDX-License-Identifier: Apache-2.0
//
// Every function of runtime/lanes as a loop over columns of numbers. lanes_kernels.cpp makes one table of
// them for each lane count and instruction set; lanes_test.cpp compares the tables. No includes: the file is
// compiled for processors that the test may not run on, and must define nothing that the linker could share.
#pragma once

namespace isoshade::lanes::test {

/// Rows of operands as bits. A row is (columns[0][r], columns[1][r], columns[2][r]); count is a multiple
/// of 32.
struct Inputs {
  const int* columns[3];
  int count;
  int uniform[2];  ///< operands that are the same in all rows
  const float* floats;
  const int* ints;
  int table_size;  ///< of floats and ints, which are read by index
};

/// One function. run() writes count results as bits (NaN canonical unless the text says bits_nonnan; bool as
/// 0, 1).
struct Kernel {
  const char* text;  ///< an op of ops.def, or else the C++ that it runs
  void (*run)(const Inputs& inputs, int* results);
};

struct KernelTable {
  int lanes;
  const Kernel* kernels;
  int count;
  /// Copies floats through lanes. count is a multiple of 32.
  void (*copy)(const float* from, float* to, int count);
  /// Of the first `count` lanes: r, g, b and a come from `from` and three more arrays behind it, `stride` apart.
  void (*copy_pixels)(const float* from, int stride, float* to, int count);
  /// Counts how often each side of a branch runs, for `lanes` conditions of 0 or 1.
  void (*count_branch_sides)(const int* conditions, int* then_count, int* other_count);
};

const KernelTable& kernels_portable();  ///< one lane, in standard C++: tests/portable
const KernelTable& kernels_scalar_sse2();
const KernelTable& kernels_scalar_sse4();
const KernelTable& kernels_4x1_sse2();
const KernelTable& kernels_4x1_sse4();
const KernelTable& kernels_4x1_avx2();
const KernelTable& kernels_8x1_avx2();
const KernelTable& kernels_8x2_avx2();
const KernelTable& kernels_8x2_avx512();
const KernelTable& kernels_16x1_avx512();
const KernelTable& kernels_16x2_avx512();

}  // namespace isoshade::lanes::test
