// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/forward.h"

#include <algorithm>

#include "compiler/support/assert.h"

namespace isoshade::emit {
namespace {

using interface::HostCall;
using lower::ForwardInput;

struct Uniform {
  std::string_view block, type, name, doc;
};
constexpr Uniform uniforms[] = {
#define UNIFORM(block, type, name, doc) {#block, #type, #name, doc},
#include "compiler/interface/forward.def"
};

std::vector<ForwardMember> members_of(std::string_view block) {
  std::vector<ForwardMember> members;
  for (const Uniform& uniform : uniforms)
    if (uniform.block == block)
      members.push_back({std::string(uniform.type), std::string(uniform.name), std::string(uniform.doc)});
  return members;
}

struct Vertex {
  std::string_view name;
  int words, word;
};
constexpr Vertex vertex_fields[] = {
#define VERTEX(name, words) {#name, words, lower::vertex_word::name},
#include "compiler/interface/records.def"
};

/// Size and alignment in bytes.
std::pair<int, int> extent(std::string_view type) {
  if (type == "float" || type == "int") return {4, 4};
  if (type == "vec2") return {8, 8};
  if (type == "vec3") return {12, 16};
  if (type == "vec4") return {16, 16};
  if (type == "mat4") return {64, 16};
  support::bug("no such member of a uniform block");
}

int align(int offset, int to) { return (offset + to - 1) / to * to; }

class Layout {
 public:
  explicit Layout(const ForwardProgram& program) : program_(program) {}

  ForwardLayout make() {
    add_attributes();
    for (const ForwardBlock block :
         {ForwardBlock::view, ForwardBlock::object, ForwardBlock::parameters, ForwardBlock::lights, ForwardBlock::screen})
      if (std::optional<ForwardLayout::Block> made = block_of(block)) layout_.blocks.push_back(std::move(*made));
    for (size_t i = 0; i < program_.images.size(); ++i)
      add_sampler("isoshade_image" + std::to_string(i), program_.images[i].field);
    for (size_t i = 0; i < program_.pictures; ++i) add_sampler("isoshade_picture" + std::to_string(i), std::to_string(i));
    if (calls(HostCall::depth)) add_sampler("isoshade_depth_picture", "depth");
    return std::move(layout_);
  }

 private:
  bool is_post() const { return program_.pure->functions[program_.main].kind == PureKind::post_process; }
  bool calls(HostCall call) const {
    const std::vector<HostCall> all = host_calls(*program_.pure);
    return std::ranges::find(all, call) != all.end();
  }

  void add_attributes() {
    if (is_post()) return;
    for (size_t i = 0; i < std::size(vertex_fields); ++i) {
      const Vertex& field = vertex_fields[i];
      const auto reads = [&](const std::optional<lower::ForwardFunction>& function) {
        return function && std::ranges::any_of(function->inputs, [&](const ForwardInput& input) {
          return input.kind == ForwardInput::Kind::attribute && input.word == field.word;
        });
      };
      if (field.word != lower::vertex_word::position && !reads(program_.point) && !reads(program_.vertex)) continue;
      layout_.attributes.push_back({"isoshade_in_" + std::string(field.name), "vec" + std::to_string(field.words),
                                    static_cast<int>(i), std::string(field.name)});
    }
  }

  void add_sampler(std::string name, std::string image) {
    layout_.samplers.push_back(
        {std::move(name), static_cast<int>(forward_block_count + layout_.samplers.size()), std::move(image)});
  }

  std::optional<ForwardLayout::Block> block_of(ForwardBlock block) {
    ForwardLayout::Block made;
    made.block = block;
    made.binding = static_cast<int>(block);
    switch (block) {
      case ForwardBlock::view:
        if (is_post()) return std::nullopt;
        made.name = "isoshade_View";
        made.members = members_of("view");
        break;
      case ForwardBlock::object:
        if (is_post()) return std::nullopt;
        made.name = "isoshade_Object";
        made.members = members_of("object");
        break;
      case ForwardBlock::parameters:
        if (program_.pure->parameters.empty()) return std::nullopt;
        made.name = "isoshade_Parameters";
        for (const PureField& field : program_.pure->parameters) {
          const ir::Type type = field.parameter.type;
          // A bool has no size in a block that all agree on: an int, 0 for false.
          made.members.push_back({std::string(type.is_float() ? ir::name(type) : "int"), field.name, field.parameter.doc});
        }
        break;
      case ForwardBlock::lights:
        if (!calls(HostCall::light_count) && !program_.light) return std::nullopt;
        made.name = "isoshade_Lights";
        layout_.light = members_of("light");
        layout_.light_size = align(place_std140(layout_.light), 16);
        made.members = {{"int", "count", "How many of the lights there are."}};
        place_std140(made.members);
        made.members.push_back({"isoshade_LightRecord", "lights", "The lights.", 16});
        made.size = 16 + most_forward_lights * layout_.light_size;
        break;
      case ForwardBlock::screen:
        if (!is_post()) return std::nullopt;
        made.name = "isoshade_Screen";
        made.members = members_of("screen");
        break;
    }
    if (block != ForwardBlock::lights) made.size = align(place_std140(made.members), 16);
    made.instance = made.name;
    made.instance[std::string_view("isoshade_").size()] += 'a' - 'A';
    return made;
  }

  const ForwardProgram& program_;
  ForwardLayout layout_;
};

}  // namespace

int place_std140(std::vector<ForwardMember>& members, int begin) {
  int offset = begin;
  for (ForwardMember& member : members) {
    const auto [size, alignment] = extent(member.type);
    member.offset = align(offset, alignment);
    offset = member.offset + size;
  }
  return offset;
}

bool is_sampler(const PureShader& shader, const ir::Function& function) {
  const auto found = shader.host.find(function.name);
  if (found == shader.host.end()) return false;
  switch (found->second.host) {
    case interface::Host::sample_closest:
    case interface::Host::sample_linear:
    case interface::Host::sample_trilinear: return true;
    case interface::Host::light:
    case interface::Host::light_change:
    case interface::Host::texel:
    case interface::Host::texture_size:
    case interface::Host::image:
    case interface::Host::depth:
    case interface::Host::mip_level: break;
  }
  return false;
}

ForwardLayout forward_layout(const ForwardProgram& program) { return Layout(program).make(); }

}  // namespace isoshade::emit
