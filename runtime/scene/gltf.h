// SPDX-License-Identifier: Apache-2.0
// Meshes from glTF 2.0 files, of which nothing is trusted.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "compiler/support/diagnostics.h"
#include "runtime/scene/mesh.h"

namespace isoshade::scene {

/// Limits that keep hostile files harmless.
inline constexpr size_t max_gltf_bytes = size_t{256} << 20;  ///< of the file, and of its buffers together
inline constexpr int64_t max_gltf_vertices = 2'000'000;      ///< of all its meshes as they are placed
inline constexpr int64_t max_gltf_triangles = 4'000'000;
inline constexpr size_t max_gltf_parts = 4096;

/// An image of a glTF file, as it is encoded.
struct GltfImage {
  std::string name;  ///< the file and which image of it: nothing else is called so
  std::shared_ptr<const std::string> bytes;
  /// Whether it is of a texture that glTF has as sRGB whatever its depth: base colour and emission.
  bool srgb = false;
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

/// All triangles of one material, and the vertices that they alone point to.
struct GltfPart {
  size_t first_index = 0, index_count = 0;    ///< in Mesh::indices; triples
  size_t first_vertex = 0, vertex_count = 0;  ///< in Mesh::vertices
  int material_index = -1;                    ///< in the file; -1 if these triangles have none
  std::optional<GltfMaterial> material;
};

struct GltfModel {
  Mesh mesh;
  std::vector<GltfPart>
      parts;  ///< one after the other they are the mesh; at least one, none without triangles
};

/// The triangles of the file's scene (its default one, else its first, else all nodes) as one mesh, in the space
/// of the scene: transforms of nodes are computed into positions, normals and tangents. Each vertex has what the
/// file gives: position, normal, first texture coordinates, tangent, first colours. Without normals faces are
/// flat; without tangents they are found from the texture coordinates; colours are white. Outline normals know
/// no parts. Materials come in the order in which their first triangles do, and the triangles of each in theirs.
///
/// `path` ends in .gltf or .glb; its buffers lie in the file or below its folder. Reports a file that is missing
/// or too large, that is no glTF, or of which any part that is used is broken: accessors that leave their
/// buffers, indices without vertices, nodes in a circle, numbers that are infinite or not numbers. Morph targets,
/// skins and animations are left out. `where` is the place that names the file, if a document does.
std::optional<GltfModel> load_gltf(const std::string& path, const support::Span& where,
                                   support::Diagnostics& diagnostics);

}  // namespace isoshade::scene
