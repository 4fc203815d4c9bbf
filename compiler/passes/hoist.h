// SPDX-License-Identifier: Apache-2.0
// What is the same for all pixels of a draw is computed once for the draw, and pixels read it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "compiler/ir/module.h"

namespace isoshade::passes {

/// What is the same all over a draw, and where its pixels find what is computed of it.
struct DrawRate {
  /// Of the kernel: the first word of the draw's record; none: it is word 0.
  std::optional<size_t> parameter;
  std::vector<uint32_t> buffers;      ///< what is loaded from these at a place that is the same is the same
  /// Of the records in this buffer only these words, and only at constant places.
  struct Records {
    uint32_t buffer, stride;
    std::vector<uint32_t> words;
  };
  std::optional<Records> records;
  std::vector<uint32_t> late_words;  ///< of the draw's record: written only when the values have been computed
  uint32_t floats = 0, integers = 0;  ///< the buffer of the records; the same memory as integers
  uint32_t first = 0;                 ///< the word of the record from which on values may be stored
};

/// The values of a draw.
struct DrawValues {
  ir::Module module;
  uint32_t entry = 0;  ///< its only parameter is that of DrawRate; its results lie in the record in their order
  uint32_t first = 0;  ///< the first word of them
  uint32_t words = 0;  ///< a vector has as many as components; what is no float is stored as the integer
};

/// Moves out of the kernel, and of the functions that it calls, every operation whose operands depend on nothing but
/// what is the same all over a draw; in a branch or a loop, too. The kernel loads the results from the draw's record and
/// passes them to the functions as parameters of the names that the values had. Addresses of words in the record stay.
/// Nothing if there is no such operation; then the module stays as it is.
///
/// Bit-exact: the same operations on the same operands. A value that was not asked for by any pixel may now be computed
/// where a precondition does not hold; then no pixel looks at it.
/// Needs: bodies for all calls, no ddx and no ddy, and nothing dead. Leaves: nothing dead; `kernel` is its index then.
std::optional<DrawValues> hoist(ir::Module& module, uint32_t& kernel, const DrawRate& rate);

/// How many values hoist() would move, for tests: none after it ran.
size_t operations_at_draw_rate(const ir::Module& module, uint32_t kernel, const DrawRate& rate);

}  // namespace isoshade::passes
