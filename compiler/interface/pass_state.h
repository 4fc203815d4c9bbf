// SPDX-License-Identifier: Apache-2.0
// The fixed state of a pass of an effect. Parser, schema, manual and reflection loop over pass_states(); what a value
// does stands where it acts (runtime/raster/clip.cpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace isoshade::interface {

// VALUE(name, what it means for the manual)
#define ISOSHADE_CULL(VALUE)                     \
  VALUE(none, "every face is drawn")                 \
  VALUE(back, "faces seen from behind are left out") \
  VALUE(front, "faces seen from the front are left out")
#define ISOSHADE_DEPTH_TEST(VALUE)                                                                        \
  VALUE(nearer, "a pixel keeps the nearest face; of equally near ones, the one that is drawn first")      \
  VALUE(always, "the pass is drawn over everything, nearer faces too; objects are drawn in the order of the scene")

// STATE(type, member and key, default, values, what it is for the manual)
#define ISOSHADE_PASS_STATES(STATE)                                                                              \
  STATE(Cull, cull, back, ISOSHADE_CULL, "Which faces of the mesh are left out; a mirroring transform changes nothing") \
  STATE(DepthTest, depth, nearer, ISOSHADE_DEPTH_TEST, "Which faces of a pixel are seen")

#define ISOSHADE_VALUE(name, doc) name,
#define ISOSHADE_ENUM(Type, member, fallback, VALUES, doc) enum class Type : uint8_t { VALUES(ISOSHADE_VALUE) };
ISOSHADE_PASS_STATES(ISOSHADE_ENUM)
#undef ISOSHADE_ENUM
#undef ISOSHADE_VALUE

struct PassState {
#define ISOSHADE_MEMBER(Type, member, fallback, VALUES, doc) Type member = Type::fallback;
  ISOSHADE_PASS_STATES(ISOSHADE_MEMBER)
#undef ISOSHADE_MEMBER

  friend bool operator==(const PassState&, const PassState&) = default;
};

struct PassStateRow {
  std::string_view key, doc;
  std::vector<std::string_view> values, value_docs;
  size_t fallback;  ///< in values
  size_t (*get)(const PassState& state);
  void (*set)(PassState& state, size_t value);
};
std::span<const PassStateRow> pass_states();

}  // namespace isoshade::interface
