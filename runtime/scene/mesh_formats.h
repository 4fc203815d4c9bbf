// SPDX-License-Identifier: Apache-2.0
// The formats of mesh files. A new one needs a row in mesh_formats, and a reader that makes a Model.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "runtime/scene/model.h"

namespace isoshade::scene {

// glTF 2.0, of which nothing is trusted.

/// Limits that keep hostile files harmless.
inline constexpr size_t max_gltf_bytes = size_t{256} << 20;  ///< of the file, and of its buffers together
inline constexpr int64_t max_gltf_vertices = 2'000'000;      ///< of all its meshes as they are placed
inline constexpr int64_t max_gltf_triangles = 4'000'000;
inline constexpr size_t max_gltf_parts = 4096;

/// The triangles of the file's scene (its default one, else its first, else all nodes) as one mesh, in the space
/// of the scene: transforms of nodes are computed into positions, normals and tangents. Each vertex has what the
/// file gives: position, normal, two sets of texture coordinates, tangent, first colours. Without normals faces are
/// flat; without tangents they are found from the texture coordinates of the normal texture; without a second set the
/// first is repeated; colours are white. Outline normals know
/// no parts. Materials come in the order in which their first triangles do, and the triangles of each in theirs.
///
/// `path` ends in .gltf or .glb; its buffers lie in the file or below its folder. Reports a file that is missing
/// or too large, that is no glTF, or of which any part that is used is broken: accessors that leave their
/// buffers, indices without vertices, nodes in a circle, numbers that are infinite or not numbers. Morph targets,
/// skins and animations are left out. `where` is the place that names the file, if a document does.
std::optional<Model> load_gltf(const std::string& path, const support::Span& where,
                               support::Diagnostics& diagnostics);

struct MeshFormat {
  std::string_view name;                       ///< the `type` of such a mesh in scene documents
  std::string_view title;                      ///< for messages
  std::array<std::string_view, 2> extensions;  ///< of file names; the last is the usual one
  /// Reads a file; `where` is the text that names it, if a document does.
  std::optional<Model> (*load)(const std::string& path, const support::Span& where,
                               support::Diagnostics& diagnostics);
};

inline constexpr MeshFormat mesh_formats[] = {{"gltf", "glTF", {".gltf", ".glb"}, load_gltf}};

/// The format of a file by its extension; the first one if no format has that.
inline size_t mesh_format_of(std::string_view path) {
  const auto found = std::ranges::find_if(mesh_formats, [&](const MeshFormat& format) {
    return std::ranges::any_of(format.extensions, [&](auto extension) { return path.ends_with(extension); });
  });
  return found == std::end(mesh_formats) ? 0 : static_cast<size_t>(found - std::begin(mesh_formats));
}

}  // namespace isoshade::scene
