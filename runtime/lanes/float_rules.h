// SPDX-License-Identifier: Apache-2.0
//
// What a float is: IEEE-754 binary32, round to nearest even, no fused operations, no denormals. Refuses the
// compiler modes that break this and switches off those it can; sets the processor's mode.
//
// On x86-64, g++ and clang give the contract's bits at every number of lanes. Elsewhere there is one lane, in
// standard C++, and what differs from x86-64 is this:
// - AArch64 flushes a tiny result before it is rounded, x86 after. Only products can tell: one whose exact
//   magnitude is at least (1 - 2^-25) * 2^-126 and less than 2^-126 is 2^-126 on x86 and zero on AArch64. These
//   are 2,907,534 of the 2^46 pairs of significands, at the one sum of exponents where the product is that small.
// - Other processors may have no mode that flushes. There every result below 2^-126 differs, and what follows
//   from it.
#ifndef ISOSHADE_LANES_FLOAT_RULES_H
#define ISOSHADE_LANES_FLOAT_RULES_H

#if __cplusplus < 202002L
#error "isoshade/lanes is C++20: compile with -std=c++20"
#endif
#if defined(__FAST_MATH__) || __FINITE_MATH_ONLY__ || defined(__ASSOCIATIVE_MATH__) || \
    defined(__RECIPROCAL_MATH__)
#error "isoshade/lanes computes exact bits: compile without -ffast-math and its parts"
#endif
#if defined(__FLT_EVAL_METHOD__) && __FLT_EVAL_METHOD__ != 0 && __FLT_EVAL_METHOD__ != 16
#error "isoshade/lanes needs floats that are not computed as doubles: on 32-bit x86 use -msse2 -mfpmath=sse"
#endif

/// Whether there are lanes in registers; otherwise only plain float, int and bool. Define it as 0 to get on
/// x86-64 the text of other processors.
#ifndef ISOSHADE_SIMD
#if defined(__x86_64__) && defined(__GNUC__)
#define ISOSHADE_SIMD 1
#else
#define ISOSHADE_SIMD 0
#endif
#endif
#if !ISOSHADE_SIMD && defined(ISOSHADE_LANES) && ISOSHADE_LANES != 1
#error "isoshade/lanes has one lane on this processor: define ISOSHADE_LANES as 1 or not at all"
#endif

// The flags in lanes.h are the contract. These repeat as much of it as a file can say, for one compiled
// without them: no a*b+c becomes an fma, no constant is folded in another mode than the one at run time, ints
// wrap. They hold to the end of the file that includes this, because that is where the shaders are.
// Even with the flags, g++ folds what is exact, and an exact product of two literals may be a denormal, where
// the processor gives zero. So leave no operation on two constants whose result could be one.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("fp-contract=off", "rounding-math", "signaling-nans", "wrapv")
#else
#pragma STDC FP_CONTRACT OFF
#endif

/// Inlined even in debug builds: a register passed through memory costs more than the work, and an
/// out-of-line copy could be shared with a file compiled for a processor that lacks the instructions.
/// ISOSHADE_NOINLINE: a function that is called, so that a large program compiles in time.
#if defined(__GNUC__)
#define ISOSHADE_INLINE [[gnu::always_inline]] inline
#define ISOSHADE_NOINLINE [[gnu::noinline]]
#else
#define ISOSHADE_INLINE inline
#define ISOSHADE_NOINLINE
#endif

namespace isoshade::lanes {

/// While alive, this thread computes as the contract says: to nearest even, denormals are zeros on the way in
/// and out, exceptions are masked. Restores the former mode at the end. Where the processor has no such mode,
/// or the compiler no way to set it, it does nothing.
///
/// Compilers do not see that arithmetic depends on the mode, and may move it past a guard. They cannot move
/// loads and stores: what is read from memory after the guard begins and written before it ends is safe. So
/// guard loops that work from memory to memory; guarded() does it for a single call.
class FpGuard {
 public:
  ISOSHADE_INLINE FpGuard() : former_(get()) { set((former_ & ~cleared) | flush); }
  ISOSHADE_INLINE ~FpGuard() { set(former_); }
  FpGuard(const FpGuard&) = delete;
  FpGuard& operator=(const FpGuard&) = delete;

 private:
#if defined(__SSE__) && defined(__GNUC__)
  using Mode = unsigned;
  static constexpr Mode cleared = 0x6000;         // the rounding
  static constexpr Mode flush = 0x8040 | 0x1f80;  // flush to zero, denormals are zeros; exceptions are masked

  ISOSHADE_INLINE static Mode get() { return __builtin_ia32_stmxcsr(); }
  ISOSHADE_INLINE static void set(Mode mode) {
    asm volatile("" ::: "memory");
    __builtin_ia32_ldmxcsr(mode);
    asm volatile("" ::: "memory");
  }
#elif defined(__aarch64__) && defined(__GNUC__)
  using Mode = unsigned long long;
  static constexpr Mode cleared = 0xc00000 | 0x9f00 | 0x7;  // the rounding, exceptions, alternate handling
  static constexpr Mode flush = 0x1000000;                  // flush to zero, operands and results

  ISOSHADE_INLINE static Mode get() {
    Mode mode;
    asm volatile("mrs %0, fpcr" : "=r"(mode));
    return mode;
  }
  ISOSHADE_INLINE static void set(Mode mode) { asm volatile("msr fpcr, %0" ::"r"(mode) : "memory"); }
#else
  using Mode = unsigned;
  static constexpr Mode cleared = 0;
  static constexpr Mode flush = 0;

  static Mode get() { return 0; }
  static void set(Mode) {}
#endif

  Mode former_;
};

/// The result of work(), computed under an FpGuard from beginning to end. `work` is a lambda that captures by
/// reference, and so reads what it captures from memory while the guard is alive. Literals in it, and what is
/// constexpr outside of it, the compiler may still compute with at compile time.
template <class Work>
ISOSHADE_INLINE auto guarded(const Work& work) {
  const FpGuard guard;
  const Work* hidden = &work;
#if defined(__GNUC__)
  asm volatile("" : "+r"(hidden) : : "memory");
#endif
  const auto result = (*hidden)();
#if defined(__GNUC__)
  asm volatile("" : : "r"(&result) : "memory");
#endif
  return result;
}

}  // namespace isoshade::lanes

#endif
