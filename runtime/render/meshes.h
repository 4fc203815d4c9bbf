// SPDX-License-Identifier: Apache-2.0
// The meshes of a frame: each shape made, or read, once.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "runtime/scene/gltf.h"
#include "runtime/scene/mesh.h"
#include "runtime/scene/scene.h"

namespace isoshade::render {

/// What is drawn at once: triangles of one material.
struct MeshPart {
  uint32_t first_vertex = 0;  ///< in Frame::vertices
  uint32_t vertex_count = 0;
  std::vector<uint32_t> indices;                ///< triples, relative to first_vertex
  std::optional<scene::GltfMaterial> material;  ///< that of the file, if it is from one
};

/// A mesh of the frame.
struct StoredMesh {
  std::vector<MeshPart> parts;            ///< at least one
  glm::vec3 low{0, 0, 0}, high{0, 0, 0};  ///< the box around it
};

class MeshStore {
 public:
  /// The number in `meshes` of an object's mesh: that of an earlier one of the same shape, or of a new one that is added
  /// there and, with its vertices, to `vertices`. Reports a file that is no mesh.
  std::optional<size_t> find(const scene::Object& object, std::vector<StoredMesh>& meshes,
                             std::vector<float>& vertices, support::Diagnostics& diagnostics);

 private:
  /// A MeshShape, in an order.
  using Key = std::tuple<scene::MeshKind, float, float, float, int, int, bool,
                         std::vector<scene::ProfilePoint>, std::string, bool>;
  std::map<Key, size_t> numbers_;
};

}  // namespace isoshade::render
