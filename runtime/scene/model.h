// SPDX-License-Identifier: Apache-2.0
// A mesh with its materials, whatever it comes from: a rule, or a file of some format.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/support/diagnostics.h"
#include "runtime/scene/mesh.h"

namespace isoshade::scene {

/// An encoded image that a material refers to.
struct MaterialImage {
  std::string name;  ///< identifies the image: its file, and which image of the file it is
  std::shared_ptr<const std::string> bytes;
  /// Whether integers in the image are sRGB whatever their width: true of colours, false of data.
  bool srgb = false;
};

/// A metallic-roughness material: values for parameters of an effect, which has them under the same names.
struct Material {
  std::array<float, 3> base_color{1, 1, 1};  ///< linear
  float alpha = 1;
  float alpha_cutoff = 0;     ///< surfaces are drawn where their alpha is not below it
  bool blended = false;       ///< whether surfaces are blended by their alpha
  bool double_sided = false;  ///< whether faces are drawn that are seen from behind
  float metallic = 1;
  float roughness = 1;  ///< alpha, the square of perceptual roughness
  std::array<float, 3> emissive_color{0, 0, 0};
  float normal_scale = 1;
  float occlusion_strength = 1;
  /// By the parameter that takes the image: base_color_texture, metallic_roughness_texture (green: perceptual
  /// roughness, blue: metallic), normal_texture, occlusion_texture, emissive_texture.
  std::map<std::string, MaterialImage> textures;
  /// Further values, by parameter. `unlit`: 1 where the base colour alone is shown. Of a texture T: `T_set`, its set of
  /// texture coordinates, and `T_u` and `T_v`: what is multiplied by (u, v, 1) and gives where the texture is read.
  std::map<std::string, std::vector<float>> values;
  /// The names of values of parameters. Of a texture T: `T_wrap_u` and `T_wrap_v` (periodic, clamp, mirror) and
  /// `T_filter` (closest, linear, trilinear).
  std::map<std::string, std::string_view> names;
};

/// All triangles of one material, and the vertices that only they refer to.
struct ModelPart {
  size_t first_index = 0, index_count = 0;    ///< in Mesh::indices; triples
  size_t first_vertex = 0, vertex_count = 0;  ///< in Mesh::vertices
  int material_index = -1;                    ///< in the file; -1 if these triangles have none
  std::optional<Material> material;
};

struct Model {
  Mesh mesh;
  std::vector<ModelPart> parts;  ///< consecutive parts of the mesh; at least one, none without triangles
};

/// All of a mesh as one part without material.
Model model_of(Mesh mesh);
/// Makes or reads the model of a shape. `where` is the text that names its file, if a document does.
std::optional<Model> make_model(const MeshShape& shape, const support::Span& where,
                                support::Diagnostics& diagnostics);

}  // namespace isoshade::scene
