// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "compiler/ir/module.h"

namespace isoshade::passes {

/// Leaves drivers nothing to fold: they do it by rules of their own, even under `precise`. Mesa takes x * 0 for
/// 0, x + 0 for x, int(float(i)) for i, and does not flush when it folds constants. They inline calls and unroll
/// loops first, so a constant reaches arithmetic from far away.
///
/// What none of them can fold with is a zero that is not in the program (ir::Opcode::hidden_zero):
/// - A literal zero is the hidden one where it is an operand of arithmetic, an argument, a component of a
///   vector, or an arm of a choice; -0 is its negation. A literal whose magnitude is outside [2^-62, 2^62] is
///   the hidden zero plus that literal: what is left has no products that must be flushed.
/// - Where the driver will know the value, any literal is hidden so: where it is returned, an argument that
///   specialize has left, or carried by a loop. So is a loop's count, or it would be unrolled.
/// - An int that may turn out to be known is or-ed with the hidden zero's bits before it becomes a float.
/// - ftoi of what may be some itof takes it plus the hidden zero.
///
/// Without a hidden zero: x < 0 becomes x <= -2^-126, for no float is denormal, and LLVM would compare the
/// operands of a sum instead of the sum, which may have been flushed; likewise <= > >= and 0 on the left. An op
/// all of whose operands are constant in a component is taken apart.
///
/// `entries` are called by nobody: nobody computes with what they return, their own or what calls gave them.
/// Needs: fold before, and not after (it would evaluate parts of what was taken apart); specialize before.
void hide_foldables(ir::Module& module, std::span<const uint32_t> entries);

}  // namespace isoshade::passes
