// SPDX-License-Identifier: Apache-2.0
//
// A select that computes only the sides that are wanted.
#ifndef ISOSHADE_LANES_BRANCH_H
#define ISOSHADE_LANES_BRANCH_H

#include "vector.h"

namespace isoshade::lanes {

/// then() where the condition holds, other() elsewhere. Each side runs once if any lane wants it, and not at
/// all otherwise; it runs for all lanes, so it must be harmless for those that do not want it. The results
/// are of any type that `select` knows for this condition, and may be uniform; the result is what
/// select(condition, then(), other()) would be, of which it has every bit.
template <class Then, class Other>
ISOSHADE_INLINE auto branch(bool condition, Then&& then, Other&& other) {
  using Result = decltype(select(condition, then(), other()));
  if (condition) return Result(then());
  return Result(other());
}

template <int W, int R, class Then, class Other>
ISOSHADE_INLINE auto branch(Bool<W, R> condition, Then&& then, Other&& other) {
  using Result = decltype(select(condition, then(), other()));
  // One call of each in the text, for every call is a copy of the code. A side that did not run is blended
  // away.
  Result if_true{}, if_false{};
  if (any(condition)) if_true = then();
  if (!all(condition)) if_false = other();
  return select(condition, if_true, if_false);
}

}  // namespace isoshade::lanes

#endif
