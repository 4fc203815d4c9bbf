// SPDX-License-Identifier: Apache-2.0
#include "compiler/interface/pass_state.h"

namespace isoshade::interface {

#define ISOSHADE_NAME(name, doc) #name,
#define ISOSHADE_DOC(name, doc) doc,
#define ISOSHADE_ROW(Type, member, fallback, VALUES, doc)                                 \
  PassStateRow{#member,                                                                   \
               doc,                                                                       \
               {VALUES(ISOSHADE_NAME)},                                                   \
               {VALUES(ISOSHADE_DOC)},                                                    \
               static_cast<size_t>(Type::fallback),                                       \
               [](const PassState& state) { return static_cast<size_t>(state.member); },  \
               [](PassState& state, size_t value) { state.member = static_cast<Type>(value); }},

std::span<const PassStateRow> pass_states() {
  static const PassStateRow rows[] = {ISOSHADE_PASS_STATES(ISOSHADE_ROW)};
  return rows;
}

}  // namespace isoshade::interface
