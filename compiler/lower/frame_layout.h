// SPDX-License-Identifier: Apache-2.0
// The arrays that stages load from, word by word. The one definition: lowering writes the loads by it, the
// runtime fills the arrays by it. Every float in them is flushed (no denormals) and every NaN is 0x7fc00000.
#pragma once

#include <cstdint>
#include <string_view>

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
  layer_records
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
};

/// vertices: one record a mesh vertex.
namespace vertex_word {
inline constexpr int position = 0;  ///< x y z, object space
inline constexpr int normal = 3;    ///< x y z, unit, object space
inline constexpr int texcoord = 6;  ///< u v
inline constexpr int tangent =
    8;                            ///< x y z, unit, object space; and 1, or -1 where the bitangent is -(n x t)
inline constexpr int color = 12;  ///< r g b a, linear
inline constexpr int outline_normal =
    16;  ///< x y z, unit, object space: the way out of the surface, one for all vertices at a position
inline constexpr int corner_normals =
    19;  ///< three vectors in object space, packed by functions/octahedral.h: normals of surfaces that meet there
inline constexpr int stride = 22;
}  // namespace vertex_word

/// triangles: one record of 64 bytes. Wound so that the doubled area, y down, is positive.
namespace triangle_word {
inline constexpr int vertex = 0;  ///< three indices into vertices
/// The first word of the object's record, and below it the bits of triangle_flag.
inline constexpr int object = 3;
inline constexpr int position = 4;    ///< x0 y0 x1 y1 x2 y2 in 1/256 pixel, y down, |.| <= 2^21
inline constexpr int depth = 10;      ///< z0 z1 z2 as float bits, reversed: near 1, far 0
inline constexpr int inverse_w = 13;  ///< 1/w of each vertex as float bits; 1 under orthographic projection
inline constexpr int stride = 16;
}  // namespace triangle_word
namespace triangle_flag {
inline constexpr int wide = 1;  ///< an edge spans 2^15 or more
inline constexpr int over = 2;  ///< it is drawn over what is nearer, too
inline constexpr int bits = 2;
}  // namespace triangle_flag

/// objects: one record an object; effect parameters follow in the order of the effect's reflection, each of
/// as many words as it has components (matrices column by column), but file names, which have none; then one word
/// for each image that the effect reads: the number of its record in `textures`, or -1 where there is none.
namespace object_word {
inline constexpr int model = 0;  ///< 4 columns of 3: object space -> world space
inline constexpr int normal =
    12;  ///< 3 columns of 3: object -> world for normals (cofactors; not normalised)
inline constexpr int inverse = 21;  ///< 4 columns of 3: world space -> object space
inline constexpr int program = 33;  ///< the index of the surface program as a float
inline constexpr int parameters = 34;
}  // namespace object_word

/// lights: one record a light.
namespace light_word {
inline constexpr int kind = 0;         ///< 0 directional, 1 point, 2 spot
inline constexpr int direction = 1;    ///< unit, world space, towards the light (spot: against its axis)
inline constexpr int position = 4;     ///< world space
inline constexpr int color = 7;        ///< linear RGB times intensity
inline constexpr int cone_scale = 10;  ///< spot: falloff = saturate(cos(angle) * scale + offset)^2
inline constexpr int cone_offset = 11;
inline constexpr int range = 12;  ///< point, spot: 1 / range^2, 0 for no end
inline constexpr int stride = 16;
}  // namespace light_word

/// textures: one record a texture, followed by those of its mip levels: each is a texture, of half the width and
/// height of the one before (rounded down, at least 1).
namespace texture_word {
inline constexpr int first = 0;  ///< the first of its words: in `texel_bytes` 1 a texel, in `texels` 4
inline constexpr int width = 1;  ///< in texels
inline constexpr int height = 2;
inline constexpr int smaller = 3;  ///< how many of the records that follow are its mip levels
/// Of bytes: the first word of the table in `texels` that says which floats their colours are. Of floats: -1.
inline constexpr int table = 4;
inline constexpr int stride = 5;
}  // namespace texture_word

/// Where textures of bytes are stored, `texels` begins with the floats that bytes are.
namespace byte_table {
inline constexpr int size = 256;
inline constexpr int linear = 0;   ///< n / 255; alpha is always by this
inline constexpr int srgb = size;  ///< srgb_decode(n / 255)
}  // namespace byte_table

/// frame: what is the same for all views.
namespace frame_word {
inline constexpr int time = 0;  ///< seconds
inline constexpr int count = 1;
}  // namespace frame_word

/// view: the camera, then `matrix` words for each draw: 4 columns of 4, object space -> clip space. The uniform
/// `projected` of the vertex kernel is the first word of its draw's matrix.
namespace view_word {
inline constexpr int eye =
    0;  ///< homogeneous, world space: position and 1, or the direction to the viewer and 0
inline constexpr int view = 4;           ///< 4 columns of 3: world space -> view space
inline constexpr int inverse_view = 16;  ///< 4 columns of 3: view space -> world space
inline constexpr int projection = 28;    ///< 4 columns of 4: view space -> clip space
/// What a pixel covers vertically, in world units: a constant, and what is added for each unit of distance along the
/// view. One of them is 0.
inline constexpr int pixel_size = 44;
// What only posts read.
inline constexpr int camera_position = 46;   ///< world space
inline constexpr int camera_direction = 49;  ///< unit, world space: the way it looks
/// World space, in the middle of the screen; then what is added from there to its right and to its lower edge: the way
/// from the camera that reaches one unit of distance along the view further ...
inline constexpr int view_ray = 52;
/// ... and where it begins, from the camera's position: 0 in perspective.
inline constexpr int ray_origin = 61;
/// The distance along the view is (n0 + n1 * depth) / (d0 + d1 * depth).
inline constexpr int depth_numerator = 70;
inline constexpr int depth_denominator = 72;
inline constexpr int camera_words = 74;  ///< the matrices begin here
inline constexpr int matrix = 16;        ///< words of each
}  // namespace view_word

/// layer_records: one record an image. The first is of the image that is made. Of a post, there follow the depth of the
/// picture, the image that the post goes over, and those that its document lists; of a view, the depth and the color of
/// each target that it reads.
namespace image_word {
inline constexpr int made = 0, depth = 1, color = 2;  ///< records
inline constexpr int first = 0;  ///< its first word in `layers`; not of the one that is made
inline constexpr int width = 1;  ///< in pixels
inline constexpr int height = 2;
/// The first of the words in `layers` that hold the camera of the view that drew it (view_word, without matrices); -1
/// where there are none.
inline constexpr int camera = 3;
inline constexpr int stride = 4;
}  // namespace image_word

}  // namespace isoshade::lower
