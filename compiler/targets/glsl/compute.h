// SPDX-License-Identifier: Apache-2.0
// What the shaders of stages.h have in common, and the compute shaders that make triangles and find what is seen.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "compiler/emit/printer.h"
#include "compiler/lower/frame_layout.h"

namespace isoshade::glsl {

inline constexpr std::string_view push_words =
    "layout(push_constant) uniform Push { int object, light_count, program, first, count, width, origin_x, "
    "origin_y, "
    "projected";

/// "layout(set = 0, binding = 8) ": the first after those of the frame, or a later one.
std::string binding(size_t after_frame, std::string_view layout = "std430, ");
/// That of a buffer of the frame.
std::string binding(lower::FrameBuffer buffer);

inline constexpr std::string_view canonical_bits =
    "// The bits of a float; NaN is one value.\n"
    "int canonical(float x) { int bits = floatBitsToInt(x); return (bits & 0x7fffffff) > 0x7f800000 ? "
    "0x7fc00000 : bits; "
    "}\n";
inline constexpr std::string_view canonical_vector =
    "ivec4 canonical(vec4 v) { return ivec4(canonical(v.x), canonical(v.y), canonical(v.z), canonical(v.w)); "
    "}\n";

/// `int number_of(int order)` of shaders that declare `triangles`.
std::string numbered();

std::string vertex_compute_main();

std::string setup_interface();
/// `called` is the kernel.
std::string setup_main(const emit::FunctionText& called);

/// Of depth and cutout. `used`: the buffers of the frame that they read.
std::string seen_interface(std::vector<bool>& used);
/// `called` is the kernel of a cut-out, or null.
std::string seen_main(const emit::FunctionText* called);

}  // namespace isoshade::glsl
