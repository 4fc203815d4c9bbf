// SPDX-License-Identifier: Apache-2.0
// Where the fields of a struct and the members of a block lie in memory, in each layout that a program may fill them in.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "compiler/ir/type.h"

namespace isoshade::interface {

/// The layouts, one a row: name, what it is for the manual.
#define ISOSHADE_LAYOUTS(LAYOUT)                                                                             \
  LAYOUT(cpp,                                                                                                \
         "the struct of the generated C++, with `float` as the number type; the same on x86-64 and AArch64") \
  LAYOUT(std430, "storage buffers and push constants of GLSL")                                               \
  LAYOUT(std140, "uniform blocks of GLSL and of WebGL2")

#define ISOSHADE_LAYOUT_NAME(name, doc) name,
enum class Layout : uint8_t { ISOSHADE_LAYOUTS(ISOSHADE_LAYOUT_NAME) };
#undef ISOSHADE_LAYOUT_NAME

/// In bytes.
struct Extent {
  uint32_t size = 0, alignment = 1;

  friend bool operator==(const Extent&, const Extent&) = default;
};

/// Of a field. A bool has 1 byte in C++ and 4 in GLSL, where every number but 0 is true.
Extent extent_of(ir::Type type, Layout layout);
/// Of an array of `count` such elements; in GLSL also of a matrix, whose columns are elements.
Extent extent_of_array(Extent element, uint32_t count, Layout layout);

struct StructLayout {
  std::vector<uint32_t> offsets;  ///< of the fields
  Extent whole;                   ///< the size is also the stride of an array of the structs
};

/// The layout of a struct of these fields; at least one. Where a block of GLSL has the struct as its only member, the
/// offsets are those in the block.
StructLayout lay_out(std::span<const ir::Type> fields, Layout layout);
StructLayout lay_out(std::span<const Extent> fields, Layout layout);

}  // namespace isoshade::interface
