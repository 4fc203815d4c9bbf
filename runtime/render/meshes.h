// SPDX-License-Identifier: Apache-2.0
// The meshes of a frame: each shape is made or read once.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "runtime/scene/mesh.h"
#include "runtime/scene/model.h"
#include "runtime/scene/scene.h"
#include "runtime/threads/workers.h"

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

/// Makes the meshes of the objects of a scene, in their order. Files are read one after the other; of shapes made by rule
/// those of several objects at a time, on all threads.
class MeshStore {
 public:
  /// The meshes go to `meshes`, their vertices one after the other to `vertices`.
  MeshStore(std::vector<StoredMesh>& meshes, std::vector<float>& vertices, threads::Workers& workers)
      : meshes_(meshes), vertices_(vertices), workers_(workers) {}

  /// The number of an object's mesh in `meshes`: that of an earlier mesh of the same shape, or of a new one. Reports a
  /// file that is not a mesh.
  std::optional<size_t> find(std::span<const scene::Object> objects, size_t object,
                             support::Diagnostics& diagnostics);

  /// Empties `meshes` and `vertices`. Until end_again(), find() takes what was in them before it makes or reads anything.
  void begin_again();
  void end_again() { former_ = {}; }

 private:
  using Numbers = std::map<std::string, size_t>;  ///< by key_of() the shape
  void make_next(std::span<const scene::Object> objects, size_t object);
  /// Takes the mesh from those before; false if it is not among them.
  bool take_former(const std::string& key);

  std::vector<StoredMesh>& meshes_;
  std::vector<float>& vertices_;
  threads::Workers& workers_;
  Numbers numbers_;
  std::map<std::string, scene::Model> made_;  ///< of shapes that no object has asked for yet
  struct Former {
    Numbers numbers;
    std::vector<StoredMesh> meshes;
    std::vector<float> vertices;
  } former_;
};

}  // namespace isoshade::render
