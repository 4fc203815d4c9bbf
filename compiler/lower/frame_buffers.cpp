// SPDX-License-Identifier: Apache-2.0
// The buffers of a frame as modules declare them, with the fields of their records.
#include "compiler/lower/forward.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/lower/stages.h"

namespace isoshade::lower {

std::vector<ir::RecordField> fields_of(FrameBuffer buffer) {
  switch (buffer) {
    case FrameBuffer::triangles:
      return {
#define TRIANGLE(name, words) {"triangle_" #name, triangle_word::name, words},
#include "compiler/interface/records.def"
      };
    case FrameBuffer::objects:
      return {
#define OBJECT(name, words) {"object_" #name, object_word::name, words},
#include "compiler/interface/records.def"
      };
    case FrameBuffer::lights:
      return {
#define LIGHT(name, words) {"light_" #name, light_word::name, words},
#include "compiler/interface/records.def"
      };
    case FrameBuffer::frame:
      return {
#define FRAME(name, words) {"frame_" #name, frame_word::name, words},
#include "compiler/interface/records.def"
      };
    case FrameBuffer::view:
      return {
#define VIEW(name, words) {"view_" #name, view_word::name, words},
#include "compiler/interface/records.def"
      };
    case FrameBuffer::textures:
      return {
#define TEXTURE(name, words) {"texture_" #name, texture_word::name, words},
#include "compiler/interface/records.def"
      };
    case FrameBuffer::vertices:
    case FrameBuffer::inputs:
    case FrameBuffer::texels:
    case FrameBuffer::texel_bytes:
    case FrameBuffer::layers:
    case FrameBuffer::layer_records:
    case FrameBuffer::object_integers: break;
  }
  return {};
}

ir::Module frame_module() {
  ir::Module module;
  for (size_t i = 0; i < std::size(frame_buffers); ++i) {
    const auto buffer = static_cast<FrameBuffer>(i);
    const bool one_record = buffer == FrameBuffer::frame || buffer == FrameBuffer::view;
    module.buffers.push_back(
        {std::string(frame_buffers[i].name), frame_buffers[i].element, fields_of(buffer), one_record});
  }
  return module;
}

}  // namespace isoshade::lower
