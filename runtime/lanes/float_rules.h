// SPDX-License-Identifier: Apache-2.0
//
// What a float is: IEEE-754 binary32, round to nearest even, no fused operations, no denormals. Refuses the
// compiler modes that break this and switches off those it can; sets the processor's mode.
#pragma once

#if !defined(__x86_64__) || !defined(__GNUC__)
#error "runtime/lanes needs g++ or clang on x86-64"
#endif

#if defined(__FAST_MATH__) || __FINITE_MATH_ONLY__ || defined(__ASSOCIATIVE_MATH__) || \
    defined(__RECIPROCAL_MATH__)
#error "runtime/lanes computes exact bits: compile without -ffast-math and its parts"
#endif

// The flags in lanes.h are the contract. These repeat as much of it as a file can say, for one compiled
// without them: no a*b+c becomes an fma, no constant is folded in another mode than the one at run time, ints
// wrap. They hold to the end of the file that includes this, because that is where the shaders are.
// Even with the flags, g++ folds what is exact, and an exact product of two literals may be a denormal, where
// the processor gives zero. So leave no operation on two constants whose result could be one.
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#else
#pragma GCC optimize("fp-contract=off", "rounding-math", "signaling-nans", "wrapv")
#endif

/// Inlined even in debug builds: a register passed through memory costs more than the work, and an
/// out-of-line copy could be shared with a file compiled for a processor that lacks the instructions.
#define ISOSHADE_INLINE [[gnu::always_inline]] inline

namespace isoshade::lanes {

/// While alive, this thread computes as the contract says: to nearest even, denormals are zeros on the way in
/// and out, exceptions are masked. Restores the former mode at the end.
///
/// Compilers do not see that arithmetic depends on the mode, and may move it past a guard. They cannot move
/// loads and stores: what is read from memory after the guard begins and written before it ends is safe. So
/// guard a function that works from memory to memory, not single expressions.
class FpGuard {
 public:
  ISOSHADE_INLINE FpGuard() : former_(__builtin_ia32_stmxcsr()) {
    set((former_ & ~rounding) | flush | masked);
  }
  ISOSHADE_INLINE ~FpGuard() { set(former_); }
  FpGuard(const FpGuard&) = delete;
  FpGuard& operator=(const FpGuard&) = delete;

 private:
  static constexpr unsigned rounding = 0x6000;
  static constexpr unsigned flush = 0x8040;  // flush to zero, denormals are zeros
  static constexpr unsigned masked = 0x1f80;

  ISOSHADE_INLINE static void set(unsigned mode) {
    asm volatile("" ::: "memory");
    __builtin_ia32_ldmxcsr(mode);
    asm volatile("" ::: "memory");
  }

  unsigned former_;
};

}  // namespace isoshade::lanes
