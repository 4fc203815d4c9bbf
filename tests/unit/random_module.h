// SPDX-License-Identifier: Apache-2.0
// Valid modules made at random, rich in what passes look for: special constants, equal expressions, vectors taken
// apart and put together, branches, loops and calls.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "compiler/ir/builder.h"

namespace isoshade::ir {

/// Bits of floats where arithmetic is special: zeros, ones, infinities, NaN, extremes, integers near 2^24 and 2^31.
const std::vector<uint32_t>& special_floats();
const std::vector<uint32_t>& special_ints();

class RandomModule {
 public:
  struct Options {
    bool library_calls = false;  ///< declarations of the function library, and calls of them
    bool loads = true;           ///< from two buffers, the first of floats, the second of ints
    bool defined = false;        ///< no op whose precondition may not hold: all executors agree
  };

  explicit RandomModule(uint64_t seed) : random_(seed) {}

  /// Adds functions to `module`, the last of which is `main`; its first parameter is a uniform int, `count`.
  void add_to(Module& module, const Options& options);
  /// A module of its own, with the buffers.
  Module make(const Options& options);
  Module make() { return make(Options()); }
  /// Words for parameters or buffers of these types, specials among them.
  std::vector<uint32_t> words(const std::vector<Parameter>& parameters);
  std::vector<uint32_t> buffer_words(size_t size);

  uint32_t below(uint32_t bound) { return static_cast<uint32_t>(random_() % bound); }

 private:
  void function(Module& module, const std::string& name, int size);
  void step(Builder& b, int depth);
  void primitive(Builder& b);
  void branch(Builder& b, int depth);
  void loop(Builder& b, int depth);
  void call(Builder& b);
  void library_call(Builder& b);
  void known_shape(Builder& b);
  std::vector<ValueId> block(Builder& b, const std::vector<Type>& yields, int depth);
  ValueId harmless(Builder& b, Precondition precondition, ValueId operand);

  Type any_type();
  ValueId constant(Builder& b, Type type);
  ValueId pick(Builder& b, Type type);
  ValueId uniform_int(Builder& b);
  void add(Builder& b, ValueId value);
  uint32_t float_bits();
  uint32_t int_bits();

  std::mt19937_64 random_;
  Options options_;
  std::vector<ValueId> visible_;
};

}  // namespace isoshade::ir
