// SPDX-License-Identifier: Apache-2.0
#include "compiler/interface/layout.h"

#include <algorithm>

#include "compiler/support/assert.h"

namespace isoshade::interface {

namespace {

constexpr uint32_t word = 4;

constexpr uint32_t rounded_up(uint32_t bytes, uint32_t alignment) {
  return (bytes + alignment - 1) / alignment * alignment;
}

/// The alignment of a vector in GLSL: that of its components times 1, 2, 4, 4 (OpenGL 4.6, 7.6.2.2, rules 1 to 3).
constexpr uint32_t vector_alignment(uint32_t width) { return word * (width == 3 ? 4 : width); }

}  // namespace

Extent extent_of(ir::Type type, Layout layout) {
  const uint32_t width = type.width;
  switch (layout) {
    case Layout::cpp: return type == ir::bool_type ? Extent{1, 1} : Extent{word * width, word};
    case Layout::std430:
    case Layout::std140: return {word * width, vector_alignment(width)};
  }
  support::bug("no such layout");
}

Extent extent_of_array(Extent element, uint32_t count, Layout layout) {
  // Rule 4: the elements of std140 are aligned to 16 bytes.
  if (layout == Layout::std140) element.alignment = rounded_up(element.alignment, 4 * word);
  return {rounded_up(element.size, element.alignment) * count, element.alignment};
}

StructLayout lay_out(std::span<const ir::Type> fields, Layout layout) {
  std::vector<Extent> extents;
  for (const ir::Type type : fields) extents.push_back(extent_of(type, layout));
  return lay_out(extents, layout);
}

StructLayout lay_out(std::span<const Extent> fields, Layout layout) {
  support::assert_that(!fields.empty(), "a struct without fields has no layout in GLSL");
  StructLayout made;
  uint32_t end = 0;
  for (const Extent extent : fields) {
    made.offsets.push_back(rounded_up(end, extent.alignment));
    end = made.offsets.back() + extent.size;
    made.whole.alignment = std::max(made.whole.alignment, extent.alignment);
  }
  // Rule 9: a struct is aligned to 16 bytes, which std430 drops.
  if (layout == Layout::std140) made.whole.alignment = rounded_up(made.whole.alignment, 4 * word);
  made.whole.size = rounded_up(end, made.whole.alignment);
  return made;
}

}  // namespace isoshade::interface
