// SPDX-License-Identifier: Apache-2.0
// What a forward pair of shaders computes around the functions of an effect or a post: the same values, by the same functions,
// as the kernels of stages.h, but of the attributes of a vertex or a pixel and of uniforms instead of words of buffers.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "compiler/lower/kernel.h"
#include "compiler/lower/stages.h"

namespace isoshade::lower {

/// What a parameter of such a function is given.
struct ForwardInput {
  enum class Kind : uint8_t {
    attribute,  ///< of the mesh: `width` words of a vertex record, from `word` on
    words,      ///< of a record of `buffer`, which the pair has as uniforms
    pixel,      ///< x (word 0) or y (word 1) of the pixel, an int
    index,      ///< of a light
    position,   ///< in world space
    front,      ///< whether the front of the triangle is seen
    shown       ///< where what is seen lies in world space
  } kind{};
  FrameBuffer buffer{};
  int word = 0, width = 0;
  friend bool operator==(const ForwardInput&, const ForwardInput&) = default;
};

struct ForwardFunction {
  uint32_t function = 0;             ///< in the module
  std::vector<ForwardInput> inputs;  ///< of each parameter
};

/// Adds a function with the values of these bindings, which are surface attributes, as its results.
ForwardFunction add_forward_surface(ir::Module& module, std::span<const interface::Binding> bindings,
                                    const char* name = "surface_at");
/// The same for a post, of bindings that vary by pixel.
ForwardFunction add_forward_screen(ir::Module& module, std::span<const interface::Binding> bindings);
/// Adds a function with the direction towards a light of any kind and what arrives from it.
ForwardFunction add_forward_light(ir::Module& module);

// In the files of the kernels that these are parts of:

/// The words of a buffer's records that emitted text names. Records of vertices are read through functions that get the
/// first word of an attribute; `objects` of a post and `layers` have no such records.
std::vector<ir::RecordField> fields_of(FrameBuffer buffer);

/// The unit direction towards the light whose record begins at `record`, and the radiance that arrives from it.
std::array<ir::ValueId, 2> light_values(Kernel& kernel, Int record, Vec3 position, LightKinds kinds);
/// Gives the arguments of bindings of the screen, in a kernel whose first parameters are x and y. `kernel` must outlive
/// it.
std::function<ir::ValueId(const interface::Binding&)> screen_arguments(Kernel& kernel);
/// Gives the functions that read images their bodies.
void define_reads(ir::Module& module, const interface::Interface& interface);
/// The value of each binding, in a kernel whose first parameters are x and y.
std::vector<ir::ValueId> screen_values(Kernel& kernel, std::span<const interface::Binding> bindings);

}  // namespace isoshade::lower
