// SPDX-License-Identifier: Apache-2.0
//
// The SIMD value types that generated C++ and the function library are written in.
//
//   Float<W, R>  Int<W, R>  Bool<W, R>   W lanes a register: 4; 8 with AVX2; 16 with AVX-512. (x86-64 with g++
//                                        or clang. Elsewhere there is one lane, in standard C++.)
//                                        R registers a value: 1, or 2 to hide the latency of arithmetic.
//   float        int        bool         One lane; or a value uniform over all lanes, broadcast implicitly.
//   vec<T, N>                            2 to 4 components of any float type.
//
// One text, written over a float type F with int_of<F> and bool_of<F>, computes the same bits for every one
// of them. The functions are the column `cpp` of compiler/ir/ops.def. For plain float, int and bool they are
// found by ordinary lookup, so code that uses them says `using namespace isoshade::lanes;` inside a namespace
// of its own.
//
// Rules for the includer:
// - Compile with -std=c++20 -ffp-contract=off -frounding-math -fwrapv (g++ also -fsignaling-nans); see float_rules.h.
// - Compute only in guarded(), or where an FpGuard is alive on the thread: every thread has a mode of its own.
// - Mark functions of lanes ISOSHADE_INLINE, and lambdas __attribute__((always_inline)): values
//   of two registers are passed through memory, which costs more than the pair gains.
// - Compile for each instruction set in files of its own. All that is here is always inlined, so no linker
//   merges the code of one instruction set into another; names of yours must not meet either.
//
// The files of this folder include each other by their names alone, and have include guards that are macros:
// `isoshade compile` writes a copy beside what it generates, and a program may see several copies.
//
// There is no system include below this line: a generated file compiles in a fifth of a second.
#ifndef ISOSHADE_LANES_LANES_H
#define ISOSHADE_LANES_LANES_H

#include "branch.h"
#include "buffer.h"
#include "float_rules.h"
#include "scalar.h"
#include "vec.h"
#include "vector.h"

#endif
