// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/forward_blocks.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string_view>

#include "compiler/lower/frame_layout.h"

namespace isoshade::vulkan {

using emit::ForwardBlock;
using emit::ForwardLayout;
using emit::ForwardMember;
using namespace lower;

namespace {

/// Writes members of a block by their names.
class BlockWriter {
 public:
  BlockWriter(std::span<std::byte> bytes, std::span<const ForwardMember> members) : bytes_(bytes), members_(members) {}

  void write(std::string_view name, std::span<const float> values, int at = 0) {
    for (const ForwardMember& member : members_)
      if (member.name == name) std::memcpy(&bytes_[static_cast<size_t>(member.offset + at)], values.data(), values.size_bytes());
  }
  /// A whole number that a record holds as a float.
  void write_integer(std::string_view name, float value) {
    write(name, std::array{std::bit_cast<float>(static_cast<int32_t>(value))});
  }
  /// Four columns, of which `words` has three rows.
  void write_affine(std::string_view name, const float* words) {
    for (int column = 0; column < 4; ++column) {
      const float* from = words + 3 * column;
      write(name, std::array{from[0], from[1], from[2], column == 3 ? 1.0f : 0.0f}, 16 * column);
    }
  }
  /// All members, from the words of a record.
  void write_record(const float* words) {
    for (const ForwardMember& member : members_) {
      const int count = words_of(member);
      std::byte* to = &bytes_[static_cast<size_t>(member.offset)];
      const auto number = static_cast<int32_t>(*words);
      std::memcpy(to, member.type == "int" ? static_cast<const void*>(&number) : words, 4 * static_cast<size_t>(count));
      words += count;
    }
  }

 private:
  std::span<std::byte> bytes_;
  std::span<const ForwardMember> members_;
};

}  // namespace

int words_of(const ForwardMember& member) { return member.type.starts_with("vec") ? member.type[3] - '0' : 1; }

void fill(const ForwardLayout& layout, const ForwardLayout::Block& block, const ForwardSource& source,
          std::span<std::byte> bytes) {
  const backends::Frame& frame = source.frame;
  const backends::View& picture = frame.picture();
  const float* view = picture.words.data();
  const float* object = source.draw != nullptr ? &frame.objects[static_cast<size_t>(source.draw->object)] : nullptr;
  const auto time = std::span(picture.frame.empty() ? frame.frame : picture.frame).subspan(frame_word::time, 1);
  BlockWriter writer(bytes, block.members);
  switch (block.block) {
    case ForwardBlock::view:
      writer.write_affine("view_from_world", view + view_word::view);
      writer.write_affine("world_from_view", view + view_word::inverse_view);
      writer.write("clip_from_view", {view + view_word::projection, 16});
      writer.write("eye", {view + view_word::eye, 4});
      writer.write("pixel_size", {view + view_word::pixel_size, 2});
      writer.write("time", time);
      break;
    case ForwardBlock::object:
      writer.write_affine("world_from_object", object + object_word::model);
      writer.write_affine("object_from_world", object + object_word::inverse);
      writer.write_integer("pass_index", object[object_word::pass_index]);
      writer.write_integer("pass_count", object[object_word::pass_count]);
      break;
    case ForwardBlock::parameters: writer.write_record(source.parameters.data()); break;
    case ForwardBlock::lights:
      std::memcpy(bytes.data(), &frame.light_count, 4);
      for (int i = 0; i < std::min(frame.light_count, emit::most_forward_lights); ++i) {
        const float* light = &frame.lights[static_cast<size_t>(i * light_word::stride)];
        BlockWriter one(bytes.subspan(static_cast<size_t>(16 + i * layout.light_size)), layout.light);
#define LIGHT(name, words) one.write(#name, {light + light_word::name, words});
#include "compiler/interface/records.def"
      }
      break;
    case ForwardBlock::screen:
      writer.write("size", std::array{static_cast<float>(source.width), static_cast<float>(source.height)});
      writer.write("depth_numerator", {view + view_word::depth_numerator, 2});
      writer.write("depth_denominator", {view + view_word::depth_denominator, 2});
      writer.write("time", time);
      writer.write("camera_position", {view + view_word::camera_position, 3});
      writer.write("camera_direction", {view + view_word::camera_direction, 3});
      for (const auto& [name, first] : {std::pair{std::string("view_ray"), view_word::view_ray},
                                        std::pair{std::string("ray_origin"), view_word::ray_origin}}) {
        writer.write(name, {view + first, 3});
        writer.write(name + "_right", {view + first + 3, 3});
        writer.write(name + "_down", {view + first + 6, 3});
      }
      break;
  }
}

}  // namespace isoshade::vulkan
