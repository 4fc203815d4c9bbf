// SPDX-License-Identifier: Apache-2.0
// A forward pair: an ordinary vertex and fragment shader around the functions of a pass or a post, for programs that rasterise
// in their own way. Hardware interpolates, and samplers and derivatives may be the hardware's, so its pictures are close to
// those of isoshade, but not the same bits.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/emit/pure.h"
#include "compiler/graph/graph.h"
#include "compiler/lower/forward.h"

namespace isoshade::emit {

inline constexpr int most_forward_lights = 16;

enum class ForwardBlock : uint8_t { view, object, parameters, lights, screen };
inline constexpr size_t forward_block_count = 5;

/// An image that the functions read, by its place in the list: the field of Parameters that has its number.
struct ForwardImage {
  std::string field;
  bool mips = false;    ///< levels of half the size are read, too
  bool layers = false;  ///< layers other than the first are read: the texture is an array
};

/// Who filters images.
enum class ForwardSampling : uint8_t {
  fetch,    ///< the functions of isoshade, texel by texel
  samplers  ///< the hardware, by the state of its samplers
};

/// What a pair is made of.
struct ForwardProgram {
  const PureShader* pure = nullptr;
  size_t main = 0;                    ///< in pure->functions: `shade` of a pass, or a post
  std::optional<size_t> move_vertex, coverage;  ///< in pure->functions
  graph::PositionSpace position_space{};
  interface::Blend blend = interface::Blend::none;  ///< of the pass
  std::vector<ForwardImage> images;
  ForwardSampling sampling = ForwardSampling::fetch;  ///< samplers: the functions of `pure` that sample have no body
  size_t pictures = 0;  ///< of a post: how many images it may read beside depth, with the one that it goes over
  std::string name;     ///< of the document and, if it has several, the pass: for the head

  ir::Module module;  ///< of the functions below, optimised
  std::optional<lower::ForwardFunction> point, vertex, light;
  std::vector<interface::Binding> point_bindings, vertex_bindings;  ///< of their results
};

/// A member of a std140 block.
struct ForwardMember {
  std::string type, name;
  std::string doc;
  int offset = 0;  ///< in bytes
};

/// What the program that draws with a pair binds. In Vulkan all bindings are in set 0; in WebGL blocks, samplers and attributes
/// are found by their names.
struct ForwardLayout {
  struct Attribute {
    std::string name, type;
    int location = 0;
    std::string vertex;  ///< the field of a vertex record of isoshade (interface/records.def)
  };
  struct Block {
    ForwardBlock block{};
    std::string name;      ///< "isoshade_View"
    std::string instance;  ///< "isoshade_view"
    int binding = 0;
    std::vector<ForwardMember> members;
    int size = 0;  ///< in bytes
  };
  struct Sampler {
    std::string name;
    int binding = 0;
    std::string image;  ///< the field of Parameters; of a post the picture, or "depth"
    bool layers = false;  ///< the texture is an array
  };
  std::vector<Attribute> attributes;
  std::vector<Block> blocks;
  std::vector<Sampler> samplers;
  std::vector<ForwardMember> light;  ///< the members of a light in the block `lights`
  int light_size = 0;
};

/// Whether a function of the shader's module samples an image as a whole.
bool is_sampler(const PureShader& shader, const ir::Function& function);

/// What the head of a shader says: how far it can be relied on, and how to blend what the pair draws. For Blend::multiply
/// the pair multiplies the color by its alpha.
std::vector<std::string> forward_notes(interface::Blend blend, bool is_post);

ForwardLayout forward_layout(const ForwardProgram& program);

/// The text of each shader.
struct ForwardText {
  std::string vertex, fragment;
};

}  // namespace isoshade::emit
