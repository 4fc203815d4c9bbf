// SPDX-License-Identifier: Apache-2.0
// The arrays that stages load from, word by word. The one definition: lowering writes the loads by it, the
// runtime fills the arrays by it. Every float in them is flushed (no denormals) and every NaN is 0x7fc00000.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "compiler/interface/binding.h"
#include "compiler/ir/type.h"

namespace isoshade::lower {

/// The buffers of every module with stages, in this order; the index is the Vulkan binding (set 0).
enum class FrameBuffer : uint32_t {
  vertices,
  triangles,
  objects,
  lights,
  frame,
  view,
  inputs,
  texels,
  texel_bytes,
  textures,
  layers,
  layer_records,
  object_integers
};

struct FrameBufferInfo {
  std::string_view name;
  ir::Scalar element;
};
inline constexpr FrameBufferInfo frame_buffers[] = {
    {"vertices", ir::Scalar::floating},  ///< mesh vertices, object space
    {"triangles", ir::Scalar::integer},  ///< clipped and snapped, see runtime/raster
    {"objects", ir::Scalar::floating},   ///< transforms and effect parameters; of `post` its parameters alone
    {"lights", ir::Scalar::floating},    //
    {"frame", ir::Scalar::floating},     ///< what is the same for all views: the time
    {"view", ir::Scalar::floating},      ///< of the view that is drawn: its camera, and a matrix for each draw
    {"inputs", ir::Scalar::integer},     ///< of `eval`: one row a record, floats as bits
    {"texels", ir::Scalar::floating},    ///< of textures of floats: r g b a, linear, row by row from the top
    {"texel_bytes", ir::Scalar::integer},  ///< of textures of bytes: r g b a in a word, r in its lowest byte
    {"textures", ir::Scalar::integer},     ///< where each texture lies in one of the two
    {"layers", ir::Scalar::floating},      ///< images that were made before, rows top down: r g b a, or depth alone
    {"layer_records", ir::Scalar::integer},
    {"object_integers", ir::Scalar::integer},  ///< the memory of `objects`; some words of records are integers
};

/// The words of each record (records.def): constants called as its fields, and the words of the whole.
#define ISOSHADE_WORDS(name, words) char name[words];
#define ISOSHADE_FIRST(name, words) inline constexpr int name = static_cast<int>(offsetof(Words, name));

namespace vertex_word {
struct Words {
#define VERTEX ISOSHADE_WORDS
#include "compiler/interface/records.def"
};
#define VERTEX ISOSHADE_FIRST
#include "compiler/interface/records.def"
inline constexpr int stride = sizeof(Words);
}  // namespace vertex_word

namespace triangle_word {
struct Words {
#define TRIANGLE ISOSHADE_WORDS
#include "compiler/interface/records.def"
};
#define TRIANGLE ISOSHADE_FIRST
#include "compiler/interface/records.def"
inline constexpr int stride = sizeof(Words);
static_assert(stride == 16);
}  // namespace triangle_word
namespace triangle_flag {
inline constexpr int wide = 1;    ///< an edge spans 2^15 or more
inline constexpr int over = 2;    ///< the depth test always passes
inline constexpr int back = 4;    ///< its back is seen
inline constexpr int cutout = 8;  ///< a pixel shows it only where the effect's cut-out holds
inline constexpr int blended = 16;      ///< drawn after all that is opaque, and blended with what is there
inline constexpr int keeps_depth = 32;  ///< it is blended and leaves the depth as it was
inline constexpr int bits = 6;
}  // namespace triangle_flag

namespace object_word {
struct Words {
#define OBJECT ISOSHADE_WORDS
#include "compiler/interface/records.def"
};
#define OBJECT ISOSHADE_FIRST
#include "compiler/interface/records.def"
inline constexpr int parameters = sizeof(Words);  ///< they begin here
}  // namespace object_word

namespace light_word {
struct Words {
#define LIGHT ISOSHADE_WORDS
#include "compiler/interface/records.def"
};
#define LIGHT ISOSHADE_FIRST
#include "compiler/interface/records.def"
inline constexpr int stride = sizeof(Words);
}  // namespace light_word

namespace frame_word {
struct Words {
#define FRAME ISOSHADE_WORDS
#include "compiler/interface/records.def"
};
#define FRAME ISOSHADE_FIRST
#include "compiler/interface/records.def"
inline constexpr int count = sizeof(Words);
}  // namespace frame_word

namespace view_word {
struct Words {
#define VIEW ISOSHADE_WORDS
#include "compiler/interface/records.def"
};
#define VIEW ISOSHADE_FIRST
#include "compiler/interface/records.def"
inline constexpr int camera_words = sizeof(Words);  ///< the matrices begin here
inline constexpr int matrix = 16;                   ///< words of each
}  // namespace view_word

namespace texture_word {
struct Words {
#define TEXTURE ISOSHADE_WORDS
#include "compiler/interface/records.def"
};
#define TEXTURE ISOSHADE_FIRST
#include "compiler/interface/records.def"
inline constexpr int stride = sizeof(Words);
}  // namespace texture_word

namespace image_word {
struct Words {
#define LAYER ISOSHADE_WORDS
#include "compiler/interface/records.def"
};
#define LAYER ISOSHADE_FIRST
#include "compiler/interface/records.def"
inline constexpr int stride = sizeof(Words);
}  // namespace image_word

#undef ISOSHADE_WORDS
#undef ISOSHADE_FIRST

namespace image_record = interface::image_record;

/// Where textures of bytes are stored, `texels` begins with the floats that bytes decode to.
namespace byte_table {
inline constexpr int size = 256;
inline constexpr int linear = 0;   ///< n / 255; alpha always uses this
inline constexpr int srgb = size;  ///< srgb_decode(n / 255)
}  // namespace byte_table

}  // namespace isoshade::lower
