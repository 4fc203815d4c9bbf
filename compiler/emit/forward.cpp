// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/forward.h"

#include <algorithm>
#include <array>

#include "compiler/interface/layout.h"
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

constexpr auto std140 = interface::Layout::std140;

interface::Extent extent_of(const ForwardMember& member) {
  if (const std::optional<ir::Type> type = ir::type_from_name(member.type)) return interface::extent_of(*type, std140);
  support::assert_that(member.type == "mat4", member.type);
  return interface::extent_of_array(interface::extent_of(ir::vector_type(4), std140), 4, std140);
}

/// Places members one behind another; returns how much memory the struct or block takes.
interface::Extent place(std::vector<ForwardMember>& members, std::span<const interface::Extent> extents) {
  const interface::StructLayout layout = interface::lay_out(extents, std140);
  for (size_t i = 0; i < members.size(); ++i) members[i].offset = static_cast<int>(layout.offsets[i]);
  return layout.whole;
}

interface::Extent place(std::vector<ForwardMember>& members) {
  std::vector<interface::Extent> extents;
  for (const ForwardMember& member : members) extents.push_back(extent_of(member));
  return place(members, extents);
}

class Layout {
 public:
  explicit Layout(const ForwardProgram& program) : program_(program) {}

  ForwardLayout make() {
    add_attributes();
    for (const ForwardBlock block :
         {ForwardBlock::view, ForwardBlock::object, ForwardBlock::parameters, ForwardBlock::lights, ForwardBlock::screen})
      if (std::optional<ForwardLayout::Block> made = block_of(block)) layout_.blocks.push_back(std::move(*made));
    for (size_t i = 0; i < program_.images.size(); ++i)
      add_sampler("isoshade_image" + std::to_string(i), program_.images[i].field, program_.images[i].layers);
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

  void add_sampler(std::string name, std::string image, bool layers = false) {
    layout_.samplers.push_back(
        {std::move(name), static_cast<int>(forward_block_count + layout_.samplers.size()), std::move(image), layers});
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
      case ForwardBlock::lights: {
        if (!calls(HostCall::light_count) && !program_.light) return std::nullopt;
        made.name = "isoshade_Lights";
        layout_.light = members_of("light");
        const interface::Extent light = place(layout_.light);
        layout_.light_size = static_cast<int>(light.size);
        made.members = {{"int", "count", "How many of the lights there are."}, {"isoshade_LightRecord", "lights", "The lights."}};
        const std::array extents{interface::extent_of(ir::int_type, std140),
                                 interface::extent_of_array(light, most_forward_lights, std140)};
        made.size = static_cast<int>(place(made.members, extents).size);
        break;
      }
      case ForwardBlock::screen:
        if (!is_post()) return std::nullopt;
        made.name = "isoshade_Screen";
        made.members = members_of("screen");
        break;
    }
    if (block != ForwardBlock::lights) made.size = static_cast<int>(place(made.members).size);
    made.instance = made.name;
    made.instance[std::string_view("isoshade_").size()] += 'a' - 'A';
    return made;
  }

  const ForwardProgram& program_;
  ForwardLayout layout_;
};

}  // namespace

bool is_sampler(const PureShader& shader, const ir::Function& function) {
  const auto found = shader.host.find(function.name);
  if (found == shader.host.end()) return false;
  switch (found->second.host) {
    case interface::Host::sample_closest:
    case interface::Host::sample_linear:
    case interface::Host::sample_trilinear: return true;
    case interface::Host::light:
    case interface::Host::light_change:
    case interface::Host::environment:
    case interface::Host::irradiance:
    case interface::Host::texel:
    case interface::Host::texture_size:
    case interface::Host::texture_layer:
    case interface::Host::image:
    case interface::Host::depth:
    case interface::Host::mip_level: break;
  }
  return false;
}

ForwardLayout forward_layout(const ForwardProgram& program) { return Layout(program).make(); }

namespace {

/// The device's blending that is closest to isoshade's; empty for none.
std::string_view blend_factors(interface::Blend blend) {
  switch (blend) {
    case interface::Blend::none: return "";
    case interface::Blend::over: return "SRC_ALPHA, ONE_MINUS_SRC_ALPHA for rgb and ONE, ONE_MINUS_SRC_ALPHA for alpha";
    case interface::Blend::add: return "SRC_ALPHA, ONE for rgb and ZERO, ONE for alpha";
    case interface::Blend::multiply: return "DST_COLOR, ONE_MINUS_SRC_ALPHA for rgb and ZERO, ONE for alpha";
    case interface::Blend::premultiplied: return "ONE, ONE_MINUS_SRC_ALPHA";
  }
  return "";
}

}  // namespace

std::vector<std::string> forward_notes(interface::Blend blend, bool is_post) {
  std::vector<std::string> notes{
      std::string("Outside the contract of isoshade: the hardware interpolates") +
      (is_post ? "" : ", takes derivatives over blocks of pixels") +
      " and may round in its own way, so pictures are close to those of isoshade, but not the same bits."};
  const std::string_view factors = blend_factors(blend);
  if (!factors.empty()) notes.push_back("Draw it after what is opaque, with the blend factors " + std::string(factors) + ".");
  return notes;
}

}  // namespace isoshade::emit
