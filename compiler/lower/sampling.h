// SPDX-License-Identifier: Apache-2.0
// Reading textures: functions of the module, made where they are first asked for. No sampler of a device is the same as
// another's, so they are arithmetic like all else.
//
// A texture is the number of its record (frame_layout.h, texture_word). What reads it is left to the kernel, or to the
// engine that takes `shade`:
//   texture_size(picture: int) -> (width: int, height: int, smaller: int)
//   texel_at(picture: int, x: int, y: int) -> (texel: vec4)      0 <= x < width, 0 <= y < height; y down
// `smaller` is how many of the textures after this one are its mip levels.
#pragma once

#include "compiler/interface/binding.h"
#include "compiler/ir/builder.h"
#include "compiler/nodes/row.h"

namespace isoshade::lower {

struct Sampling {
  nodes::Filter filter;
  nodes::AddressMode u, v;
  /// The inputs that choose (Graph::inputs), or ir::none. What is above is then their default.
  uint32_t filter_input = ir::none, u_input = ir::none, v_input = ir::none;

  friend bool operator==(const Sampling&, const Sampling&) = default;
};

/// The numbers of what inputs choose, and whether the filter can be trilinear; ir::none where the Sampling is fixed. And
/// the layer; ir::none for the first.
struct Chosen {
  ir::ValueId filter = ir::none, u = ir::none, v = ir::none;
  bool may_be_trilinear = false;
  ir::ValueId layer = ir::none;
};

/// The colour of a texture at `texcoord`, as a vec4 under `builder`. Beyond edges of AddressMode::constant it is that
/// of the edge. `interface` receives the functions that are made or declared. Trilinear: asks for derivatives of `texcoord`, but the mip level that comes of them counts as constant
/// where derivatives are taken of the result.
/// A choice that inputs make has the bits of the same choice when it is fixed.
ir::ValueId sample(ir::Builder& builder, interface::Interface& interface, const Sampling& sampling, ir::ValueId texture,
                   ir::ValueId texcoord, const Chosen& chosen = {});

/// Gives what sample() left without a body one that reads the frame's buffers.
void define_texture_reads(ir::Module& module, const interface::Interface& interface);

}  // namespace isoshade::lower
