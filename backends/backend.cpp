// SPDX-License-Identifier: Apache-2.0
#include "backends/backend.h"

#include <algorithm>

#include "backends/shared.h"
#include "runtime/lanes/lanes.h"

namespace isoshade::backends {
namespace {

using lower::FrameBuffer;

constexpr std::string_view smaller_image = "make a smaller image with --size";

struct Contents {
  std::string_view what;
  std::string_view way_out;
  Largest Frame::*largest = nullptr;
};

Contents contents_of(FrameBuffer array) {
  switch (array) {
    case FrameBuffer::vertices:
      return {"the vertices of all meshes", "use meshes of fewer vertices", &Frame::largest_mesh};
    case FrameBuffer::triangles:
      return {"the triangles to draw", "draw fewer copies, or meshes of fewer triangles",
              &Frame::largest_mesh};
    case FrameBuffer::objects:
    case FrameBuffer::object_integers: return {"the parameters of all copies of objects", "draw fewer copies"};
    case FrameBuffer::view: return {"the matrices of all copies of objects", "draw fewer copies"};
    case FrameBuffer::lights: return {"the lights", "use fewer lights"};
    case FrameBuffer::texels:
      return {"the textures of more than 8 bits a number", "use smaller images, or of 8 bits",
              &Frame::largest_in_texels};
    case FrameBuffer::texel_bytes:
      return {"the textures of 8 bits a number", "use smaller images", &Frame::largest_in_texel_bytes};
    case FrameBuffer::inputs: return {"the table's inputs", "evaluate fewer rows at a time"};
    case FrameBuffer::layers: return {"the images that a program reads", smaller_image, &Frame::largest_shadow};
    case FrameBuffer::frame:
    case FrameBuffer::textures:
    case FrameBuffer::layer_records: break;
  }
  return {lower::frame_buffers[static_cast<size_t>(array)].name, smaller_image};
}

}  // namespace

void Image::resize(int w, int h, bool has_color) {
  width = w;
  height = h;
  const size_t pixels = static_cast<size_t>(w) * static_cast<size_t>(h);
  rgba.resize(has_color ? 4 * pixels : 0);
  depth.resize(pixels);
}

TileCounts& TileCounts::operator+=(const TileCounts& other) {
  tiles += other.tiles;
  empty += other.empty;
  kept += other.kept;
  blocks += other.blocks;
  blocks_of_one_object += other.blocks_of_one_object;
  return *this;
}

TileCounts& TileCounts::operator-=(const TileCounts& other) {
  tiles -= other.tiles;
  empty -= other.empty;
  kept -= other.kept;
  blocks -= other.blocks;
  blocks_of_one_object -= other.blocks_of_one_object;
  return *this;
}

bool is_finite(std::span<const float> numbers) {
  using Floats = lanes::Float<4, 1>;
  const auto is_special = [](const auto& x) { return (lanes::bits_nonnan(x) & lanes::exponent_bits) == lanes::exponent_bits; };
  const size_t in_registers = numbers.size() / 4 * 4;
  auto special = lanes::Bool<4, 1>(false);
  for (size_t i = 0; i < in_registers; i += 4) special = special | is_special(lanes::load_lanes<Floats>(&numbers[i]));
  return !any(special) && std::ranges::none_of(numbers.subspan(in_registers), is_special);
}

size_t word_count(std::span<const driver::Field> fields) {
  size_t sum = 0;
  for (const driver::Field& field : fields) sum += static_cast<size_t>(field.words);
  return sum;
}

void report_too_large(FrameBuffer array, size_t bytes, const ArrayLimit& limit, const Frame* frame,
                      support::Diagnostics& diagnostics) {
  const Contents contents = contents_of(array);
  const Largest* largest =
      frame == nullptr || contents.largest == nullptr ? nullptr : &(frame->*contents.largest);
  support::Diagnostic& report =
      diagnostics.report(support::Id::device_limit, largest == nullptr ? support::Span{} : largest->where,
                         std::string(contents.what) + " take " + std::to_string(bytes) + " bytes; " +
                             std::string(limit.taker) + " takes at most " + std::to_string(limit.bytes));
  if (largest != nullptr && !largest->what.empty()) report.note("the largest is " + largest->what);
  const bool is_shadow = frame != nullptr && largest == &frame->largest_shadow && !largest->what.empty();
  report.suggest(std::string(is_shadow ? smaller_shadow : contents.way_out) + (limit.is_cpu ? "" : "; or draw it with --backend cpu"));
}

}  // namespace isoshade::backends
