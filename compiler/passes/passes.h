// SPDX-License-Identifier: Apache-2.0
// The passes over a module: each what it does, what it needs and what it leaves. pipeline.cpp has their order.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "compiler/functions/tier.h"
#include "compiler/ir/module.h"

namespace isoshade::passes {

/// Replaces ddx and ddy by arithmetic: forward-mode automatic differentiation of their operands, and of nothing else.
///
/// Derivatives start at a function of a stage for which the module has two more, with the same parameters and with
/// ddx_suffix or ddy_suffix appended to the name: these return the derivatives of its results along x and y. From there
/// they propagate by the change rules of ops (tangents.h) and of library functions (functions/functions.def). A
/// function that needs the derivatives of its parameters gets them from its callers as further parameters, in the
/// group "gradients". The derivatives of called functions are computed in functions of their own, `..._change`; that of
/// a function without a body is declared.
///
/// Derivatives of derivatives follow: the same rules apply to what the first ones were made of.
///
/// Needs: a valid module in which no derivative depends on itself, and calls are not yet expanded (the rules are those
/// of the functions, not of their bit operations). Leaves: no ddx and no ddy; a module without any is left as it is.
void derivatives(ir::Module& module);

inline constexpr std::string_view ddx_suffix = "_ddx";
inline constexpr std::string_view ddy_suffix = "_ddy";

/// Rewrites every function in canonical order and drops what nothing uses: instructions, blocks, results of
/// branches, values that loops carry, and origins.
/// The order of a block is depth-first from its yields: a value's operands come before it, in their order. What
/// inner blocks use from outside counts as operands of the instruction that contains them. So the order depends
/// only on the data flow, and not on the order in which a builder made the instructions (where C++ leaves the
/// evaluation order of arguments open). Values, instructions, blocks and origins get the numbers of text IR.
/// Needs: a valid module. Leaves: nothing dead inside functions; print and parse give back the same module.
void renumber(ir::Module& module);

/// Constant folding. Replaces
/// - ops and calls on constants by their results, as the interpreter computes them; not where a precondition
///   fails, nor calls that read buffers or take very long;
/// - ops that equal an operand, or a cheaper op, for every value including NaN, infinities and both zeros
///   (identities.h);
/// - ops on constants that one select chooses by a select of the results; a branch's result that is constant on
///   both sides by a select;
/// - a branch with a constant condition by the side taken; inside the sides of a branch, choices on its condition;
///   results that both sides yield alike by that value; a
///   loop that runs never or once by its initial values or its body.
/// Works on the functions from index `first` on. Calls of library functions that have no body yet are evaluated
/// with the bodies of the tier; without a tier they stay.
/// Needs: a valid module. Leaves: the replaced instructions in no block (renumber drops them).
void fold(ir::Module& module, std::optional<functions::Tier> tier = {}, size_t first = 0);

/// Common subexpression elimination: replaces an instruction by an equal one before it, in its block or in an enclosing
/// one. Two instructions are equal if they have the same op and operands, in either order where the op commutes. Calls
/// and loads are merged, too, since everything is pure; branches and loops are not. A name is kept.
/// Needs: a valid module. Leaves: the replaced instructions in no block (renumber drops them).
void cse(ir::Module& module);

/// Dead code elimination: drops the functions that the entries do not reach through calls. The others are sorted,
/// callees before callers, in the order in which they are called; `entries` is updated to the new indices. Buffers
/// stay.
/// Needs: a valid module without dead calls (renumber). Leaves: only functions that are reached.
void dce(ir::Module& module, std::vector<uint32_t>& entries);

/// Replaces what the ranges of parameters decide, in functions of documents: comparisons with a known outcome, and
/// what can have only one value, by constants; sums with a zero by the other operand where that is never -0; min, max,
/// clamp and saturate of values within the limits, and magnitudes of positive values, by the operand that they return.
/// Bit-exact. Relies on parameters being in range (scenes are checked when loaded); takes NaN and the signs of zeros
/// into account; ranges contain every float that the ops can give.
/// Needs: bodies for all calls. Leaves: comparisons that are constants, for fold.
void decide(ir::Module& module, functions::Tier tier);

/// How many operations (ir/expansion.h) one side of a branch must save at least. They are well above the test of all lanes
/// and the moves of results, because pixels that disagree on a condition save nothing.
struct SinkLimits {
  uint64_t varying = 32;
  uint64_t uniform = 8;  ///< where the condition is the same for all pixels
};

/// Sinks what only one outcome of a choice needs into a branch, which lanes and pixels skip where none needs it. Selects on
/// one condition of which none needs another become one branch, if what one operand of each alone needs
/// reaches the limits; branches take in, too, what only one side of them uses. Bit-exact: all is pure, and a select
/// never looks at the operand that it does not choose. Bodies of the library stay: they are written without branches.
/// Returns how many branches were made.
/// Needs: a valid module; constants folded, or costs are overestimated. Leaves: choices on the condition of a branch
/// inside of its sides, for fold.
size_t sink(ir::Module& module, const SinkLimits& limits = {});

/// Gives each call with constant arguments a clone of its callee in which the constants are folded. A driver
/// inlines calls and then folds constants by rules of its own (see hide_foldables), so no constant may cross a
/// call. It also saves work: pow(x, 2.4) need not split the exponent. Callees without float arithmetic (min,
/// clamp, ...) stay, because choosing among constants is exact. Short clones of library functions are inlined.
/// Needs: a valid module whose functions have bodies. Leaves: no call that passes a constant to arithmetic;
/// functions that are no longer called (dce drops them). A module that would grow by more than 200,000
/// instructions keeps its remaining calls.
void specialize(ir::Module& module);

/// Drops parameters that their function does not read, results that no caller reads, and what is dead then: constants in a
/// function may leave nothing to do with what its callers compute for it. Entries keep theirs, and so
/// do functions of the host and of the library, which others know.
/// Needs: a valid module without dead code inside functions (renumber). Leaves: only functions that are reached, callees
/// before callers (dce).
void drop_unread(ir::Module& module, std::vector<uint32_t>& entries);

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

/// Replaces `/` and `sqrt` by the library's div_exact and sqrt_exact, for devices that do not round them correctly:
/// these compute the same bits by + - * and integer ops.
/// Leaves: no fdiv and no fsqrt; declarations of the two functions if the module did not have them.
void exact_division(ir::Module& module);

/// Replaces imulhi and umulhi by calls of functions that multiply 16-bit halves, for languages without a product of 64 bits.
/// Exact for all operands. Leaves: no imulhi and no umulhi, and the one or two functions behind the module's other functions.
void multiply_by_halves(ir::Module& module);

/// Moves runs of instructions from long blocks into functions of their own, `NAME_part_1` and so on. A part's
/// parameters are the values that the run reads, its results the values that others read from it. The reason: the
/// time that a C++ compiler takes grows with the square of a function's length (figures in targets/cpp/cpp.h). Uniform and
/// varying instructions go into separate runs, so that loop counts stay uniform. Bit-exact: no operation changes, nor
/// do its operands.
/// Needs: a valid module. Leaves: a valid module in which a block computes about `longest` values, unless it is one
/// long list of arguments.
void cut_long(ir::Module& module, size_t longest);

}  // namespace isoshade::passes
