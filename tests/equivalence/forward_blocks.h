// SPDX-License-Identifier: Apache-2.0
// What a program gives a forward pair: SPIR-V of its texts, and the contents of its uniform blocks.
#pragma once

#include <array>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <unistd.h>

#include "compiler/driver/forward.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/targets/targets.h"
#include "tests/equivalence/scenes.h"

namespace isoshade::equivalence::forward {

using namespace lower;
using emit::ForwardBlock;
using emit::ForwardLayout;
using emit::ForwardMember;

inline std::vector<uint32_t> spirv_of(const std::string& text, const char* stage) {
  const std::string stem = (std::filesystem::temp_directory_path() / ("isoshade-pair-" + std::to_string(getpid()))).string();
  const std::string source = stem + "." + stage, binary = stem + ".spv";
  std::ofstream(source) << text;
  EXPECT_EQ(std::system(("glslangValidator -V -o " + binary + " " + source + " >&2").c_str()), 0);
  std::ifstream file(binary, std::ios::binary);
  const std::vector<char> bytes(std::istreambuf_iterator<char>(file), {});
  std::vector<uint32_t> words(bytes.size() / 4);
  std::memcpy(words.data(), bytes.data(), 4 * words.size());
  std::filesystem::remove(source);
  std::filesystem::remove(binary);
  return words;
}

/// How many words of a record of parameters a member has.
inline int words_of(const ForwardMember& member) { return member.type.starts_with("vec") ? member.type[3] - '0' : 1; }

/// Writes members of a block by their names.
class BlockWriter {
 public:
  BlockWriter(std::span<std::byte> bytes, std::span<const ForwardMember> members) : bytes_(bytes), members_(members) {}

  void write(const std::string& name, std::span<const float> values, int at = 0) {
    for (const ForwardMember& member : members_)
      if (member.name == name) std::memcpy(&bytes_[static_cast<size_t>(member.offset + at)], values.data(), values.size_bytes());
  }
  /// A whole number that a record holds as a float.
  void write_integer(const std::string& name, float value) {
    write(name, std::array{std::bit_cast<float>(static_cast<int32_t>(value))});
  }
  /// Four columns, of which `words` has three rows.
  void write_affine(const std::string& name, const float* words) {
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

/// What a draw gives each block of its pair.
inline void fill(const ForwardLayout& layout, const ForwardLayout::Block& block, const render::Plan& plan,
          const backends::Draw& draw, std::span<std::byte> bytes) {
  const float* view = plan.frame.picture().words.data();
  const float* object = &plan.frame.objects[static_cast<size_t>(draw.object)];
  BlockWriter writer(bytes, block.members);
  switch (block.block) {
    case ForwardBlock::view:
      writer.write_affine("view_from_world", view + view_word::view);
      writer.write_affine("world_from_view", view + view_word::inverse_view);
      writer.write("clip_from_view", {view + view_word::projection, 16});
      writer.write("eye", {view + view_word::eye, 4});
      writer.write("pixel_size", {view + view_word::pixel_size, 2});
      writer.write("time", {&plan.frame.frame[frame_word::time], 1});
      break;
    case ForwardBlock::object:
      writer.write_affine("world_from_object", object + object_word::model);
      writer.write_affine("object_from_world", object + object_word::inverse);
      writer.write_integer("pass_index", object[object_word::pass_index]);
      writer.write_integer("pass_count", object[object_word::pass_count]);
      break;
    case ForwardBlock::parameters: writer.write_record(object + object_word::parameters); break;
    case ForwardBlock::lights:
      std::memcpy(bytes.data(), &plan.frame.light_count, 4);
      for (int i = 0; i < plan.frame.light_count; ++i) {
        const float* light = &plan.frame.lights[static_cast<size_t>(i * light_word::stride)];
        BlockWriter one(bytes.subspan(static_cast<size_t>(16 + i * layout.light_size)), layout.light);
#define LIGHT(name, words) one.write(#name, {light + light_word::name, words});
#include "compiler/interface/records.def"
      }
      break;
    case ForwardBlock::screen: break;
  }
}

}  // namespace isoshade::equivalence::forward
