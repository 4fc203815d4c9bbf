// SPDX-License-Identifier: Apache-2.0
// The fixed state of a pass of an effect. Parser, schema, manual and reflection loop over pass_states(); what a value
// does stands where it acts (runtime/raster/clip.cpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
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

#define ISOSHADE_BLEND(VALUE)                                                                                     \
  VALUE(none, "the pass is opaque: the nearest face hides what is behind it")                                     \
  VALUE(over, "alpha covers: rgb = c a + d (1 - a), alpha = a + b (1 - a)")                                       \
  VALUE(add, "light is added: rgb = d + c a, alpha = b")                                                          \
  VALUE(multiply, "light is filtered: rgb = d (c a + (1 - a)), alpha = b")                                        \
  VALUE(premultiplied, "as `over`, of colours that are multiplied by alpha: rgb = c + d (1 - a), alpha = a + b (1 - a)")
#define ISOSHADE_DEPTH_WRITE(VALUE)                                                            \
  VALUE(off, "what is drawn later is not hidden by the pass, and neither is it in the depth of the picture") \
  VALUE(on, "a pixel of the pass hides what is drawn later behind it")

// STATE(type, member and key, default, values, what it is for the manual)
#define ISOSHADE_PASS_STATES(STATE)                                                                              \
  STATE(Cull, cull, back, ISOSHADE_CULL, "Which faces of the mesh are left out; a mirroring transform changes nothing") \
  STATE(DepthTest, depth, nearer, ISOSHADE_DEPTH_TEST, "Which faces of a pixel are seen")                         \
  STATE(Blend, blend, none, ISOSHADE_BLEND,                                                                      \
        "What the color (c, a) of the pass makes of the picture (d, b) behind it")                               \
  STATE(DepthWrite, depth_write, off, ISOSHADE_DEPTH_WRITE,                                                      \
        "Whether a pass that is blended changes the depth; an opaque pass always does")

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

inline constexpr int max_repeats = 256;  ///< of a pass

/// How often a pass is drawn, one repetition after the other.
struct Repeat {
  int count = 1;                    ///< if no parameter says it
  std::optional<size_t> parameter;  ///< the index of an input of the document: its value without a fraction
};

}  // namespace isoshade::interface
