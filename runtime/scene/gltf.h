// SPDX-License-Identifier: Apache-2.0
// Meshes from glTF 2.0 files, of which nothing is trusted.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "compiler/support/diagnostics.h"
#include "runtime/scene/mesh.h"

namespace isoshade::scene {

/// Limits that keep hostile files harmless.
inline constexpr size_t max_gltf_bytes = size_t{256} << 20;  ///< of the file, and of its buffers together
inline constexpr int64_t max_gltf_vertices = 2'000'000;      ///< of all its meshes as they are placed
inline constexpr int64_t max_gltf_triangles = 4'000'000;

/// An image of a glTF file, as it is encoded.
struct GltfImage {
  std::string name;  ///< the file and which image of it: nothing else is called so
  std::shared_ptr<const std::string> bytes;
};

/// glTF's metallic-roughness model.
struct GltfMaterial {
  std::array<float, 4> base_color{1, 1, 1, 1};  ///< linear
  float metallic = 1;
  float roughness = 1;  ///< alpha: the square of what the file says, which is perceptual
  std::array<float, 3> emissive_color{0, 0, 0};
  float normal_scale = 1;
  float occlusion_strength = 1;
  /// By the parameter that takes it: base_color_texture, metallic_roughness_texture (green: perceptual roughness, blue:
  /// metallic), normal_texture, occlusion_texture, emissive_texture. Those of other than the first texture coordinates
  /// are left out.
  std::map<std::string, GltfImage> textures;
};

struct GltfModel {
  Mesh mesh;
  std::optional<GltfMaterial> material;  ///< if all triangles have one
  int material_index = -1;               ///< in the file; -1 if there is none
};

/// The triangles of the file's scene (its default one, else its first, else all nodes) as one mesh, in the space
/// of the scene: transforms of nodes are computed into positions, normals and tangents. Each vertex has what the
/// file gives: position, normal, first texture coordinates, tangent, first colours. Without normals faces are
/// flat; without tangents they are found from the texture coordinates; colours are white.
///
/// `path` ends in .gltf or .glb; its buffers lie in the file or below its folder. Reports a file that is missing
/// or too large, that is no glTF, or of which any part that is used is broken: accessors that leave their
/// buffers, indices without vertices, nodes in a circle, numbers that are infinite or not numbers. Morph targets,
/// skins and animations are left out. `where` is the place that names the file, if a document does.
std::optional<GltfModel> load_gltf(const std::string& path, const support::Span& where,
                                   support::Diagnostics& diagnostics);

}  // namespace isoshade::scene
