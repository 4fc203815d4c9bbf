// SPDX-License-Identifier: Apache-2.0
//
// The SIMD value types that generated C++ and the function library are written in.
//
//   Float<W, R>  Int<W, R>  Bool<W, R>   W lanes a register (4; 8 with AVX2; 16 with AVX-512), R registers a
//   value
//                                        (1 or 2: two independent registers hide the latency of arithmetic)
//   float        int        bool         one lane, or a value uniform over all lanes; broadcasts implicitly
//   vec<T, N>                            2 to 4 components of any float type
//
// One text, written over a float type F with int_of<F> and bool_of<F>, computes the same bits for every one
// of them. The functions are the column `cpp` of compiler/ir/ops.def. For plain float, int and bool they are
// found by ordinary lookup, so code that uses them says `using namespace isoshade::lanes;` inside a namespace
// of its own.
//
// Rules for the includer:
//   - compile with -ffp-contract=off -frounding-math -fwrapv (g++ also -fsignaling-nans); see float_rules.h;
//   - compute only where an FpGuard is alive on the thread (floats flush denormals; every thread has its own
//   mode);
//   - compile files for different instruction sets as separate files. Everything here is always inlined, so
//   that
//     no linker merges the code of one instruction set into another.
//
// There is no system include below this line: it is what makes a generated file compile in a fifth of a
// second.
#pragma once

#include "runtime/lanes/branch.h"
#include "runtime/lanes/buffer.h"
#include "runtime/lanes/float_rules.h"
#include "runtime/lanes/pair.h"
#include "runtime/lanes/scalar.h"
#include "runtime/lanes/vec.h"
#include "runtime/lanes/vector.h"
