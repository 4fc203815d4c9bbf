// SPDX-License-Identifier: Apache-2.0
// The meshes of a frame: each shape is made or read once.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "runtime/scene/mesh.h"
#include "runtime/scene/model.h"
#include "runtime/scene/scene.h"

namespace isoshade::render {

/// The triangles of one material, which are drawn at once.
struct MeshPart {
  uint32_t first_vertex = 0;  ///< in Frame::vertices
  uint32_t vertex_count = 0;
  std::vector<uint32_t> indices;            ///< triples, relative to first_vertex
  std::optional<scene::Material> material;  ///< if the mesh has materials
};

/// A mesh of the frame.
struct StoredMesh {
  std::vector<MeshPart> parts;            ///< at least one
  glm::vec3 low{0, 0, 0}, high{0, 0, 0};  ///< the bounding box
};

class MeshStore {
 public:
  /// The number of an object's mesh in `meshes`: that of an earlier mesh of the same shape, or of a new one, which is
  /// added there, and its vertices to `vertices`. Reports a file that is not a mesh.
  std::optional<size_t> find(const scene::Object& object, std::vector<StoredMesh>& meshes,
                             std::vector<float>& vertices, support::Diagnostics& diagnostics);

 private:
  /// A MeshShape as a key that can be ordered.
  using Key = std::tuple<scene::MeshKind, float, float, float, int, int, bool,
                         std::vector<scene::ProfilePoint>, std::string, size_t, bool>;
  std::map<Key, size_t> numbers_;
};

}  // namespace isoshade::render
