// SPDX-License-Identifier: Apache-2.0
// A kernel decoded for the batched interpreter, which executes one operation after the other for a batch of lanes.
#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

#include "backends/interpreter/steps.h"
#include "compiler/ir/module.h"

namespace isoshade::interpreter {

/// One word of a kernel's arguments, for calls side by side.
struct Argument {
  static Argument uniform(int32_t value) { return {nullptr, 0, value, 0}; }
  /// first, first + 1, ...
  static Argument from(int32_t first) { return {nullptr, 0, first, 1}; }
  /// words[0], words[stride], ...: ints, or the bits of floats.
  static Argument listed(const void* words, int stride = 1) { return {words, stride, 0, 0}; }

  /// The word of one call.
  uint32_t of(int call) const {
    if (words == nullptr)
      return static_cast<uint32_t>(first) + static_cast<uint32_t>(change) * static_cast<uint32_t>(call);
    uint32_t word;
    std::memcpy(&word, static_cast<const std::byte*>(words) + sizeof word * static_cast<size_t>(stride) * static_cast<size_t>(call),
                sizeof word);
    return word;
  }

  const void* words;
  int stride;
  int32_t first;
  int32_t change;  ///< from one call to the next, if there are no words
};

/// Immutable: any number of threads may run it at once.
class Code {
 public:
  /// Decodes a function of a module, all of whose callees have bodies. Of its result words only the first `results` are
  /// computed. `lanes`: 4, 8 or 16, which the machine must have.
  Code(const ir::Module& module, uint32_t function, size_t results, int lanes = widest_lanes());

  /// Calls the kernel `count` times and writes the result words of each call one after another: floats with NaN
  /// canonical, bools as 0 or 1. Parameters that are uniform need uniform arguments. The caller holds an FpGuard.
  void run(const BufferView* buffers, std::span<const Argument> arguments, int count, void* results) const;

  size_t step_count() const { return steps_.size(); }
  size_t register_count() const { return words_; }
  /// The lanes of the machine's widest registers.
  static int widest_lanes();

 private:
  friend class Registers;

  void store(const Context& context, int count, void* to) const;

  const LaneCode& code_;
  int batch_ = 0;  ///< lanes that are computed at once
  uint64_t number_;
  std::vector<Step> steps_;
  std::vector<uint32_t> scalars_;  ///< the constants; the other ones are written before they are read
  uint32_t words_ = 0, masks_ = 0;   ///< how many registers there are
  size_t word_bytes_ = 0, mask_bytes_ = 0;  ///< of a register
  std::vector<Place> parameters_;  ///< one for each word; Pool::none if nothing reads it
  std::vector<Place> results_;
};

}  // namespace isoshade::interpreter
