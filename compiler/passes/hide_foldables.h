// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "compiler/ir/module.h"

namespace isoshade::passes {

/// Rewrites the shapes that drivers fold inexactly, even under `precise` (Mesa: x*0, x+0, 0-x, int(float(i)),
/// and constant with constant, without flushing), into ops that give the same bits and leave nothing to fold:
///     x * (+-0)       the sign as bits, or NaN if x is infinite or NaN
///     x + (+0)        +0 where the bits are those of -0, else x; x - (-0) likewise
///     (+0) - x        -x + (+0), as above
///     (-0) - x        -x, which is a bit operation
///     x / (+-0)       x * (+-inf), which is the same for every x
///     (+-0) / x       the sign as bits, or NaN if x is a zero or NaN
///     ftoi(itof(i))   ftoi(itof(i >> 16) * 65536 + itof(i & 0xffff)): the halves are exact, so the sum rounds as
///                     itof does
///     x < 0           x <= -2^-126: no float is denormal, and LLVM would compare the operands of a sum instead
///                     of the sum, which may have been flushed; likewise <= > >= and 0 on the left
///     c ? -1 : +0     chosen in bits of which none is such a constant, then put right: drivers take it for a bool
///                     made float and lose the zero's sign; likewise 1 and -0, and branches that yield them
/// Vectors of which a component has such a shape, or all of whose operands are constant in a component, are
/// taken apart. Needs: fold before, and not after (it may bring the shapes back by evaluating parts of them).
/// Leaves: no such shape in any function. specialize has kept constants from crossing calls.
void hide_foldables(ir::Module& module);

}  // namespace isoshade::passes
