// SPDX-License-Identifier: Apache-2.0
// The parts of load_gltf. What tinygltf has read is as wrong as the file may be: every index, offset and count
// in it is checked here before it is used.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tiny_gltf.h>
#include <vector>

#include "runtime/scene/gltf.h"

namespace isoshade::scene {

/// Why a file is refused. The first reason stays.
class Refusal {
 public:
  /// Returns false, for callers that return so.
  bool refuse(std::string reason) {
    if (reason_.empty()) reason_ = std::move(reason);
    return false;
  }
  bool refused() const { return !reason_.empty(); }
  const std::string& reason() const { return reason_; }

 private:
  std::string reason_;
};

/// The numbers of an accessor, `width` for each of `count` elements, as floats: integers of normalised ones
/// divided by their greatest. Denormals are zeros, and all are finite.
struct Numbers {
  std::vector<float> values;
  size_t count = 0;
};

/// Takes accessors of `width` components: floats, and if `integers` normalised unsigned bytes and shorts.
std::optional<Numbers> read_numbers(const tinygltf::Model& model, int accessor, int width, bool integers,
                                    Refusal& refusal);
/// Takes scalars that are unsigned bytes, shorts or ints.
std::optional<std::vector<uint32_t>> read_indices(const tinygltf::Model& model, int accessor,
                                                  Refusal& refusal);
/// The components of each element of an accessor: 1 to 4; 0 if there is no such accessor.
int components_of(const tinygltf::Model& model, int accessor);

/// The triangles of the model's scene; no part has its material yet. Computed under lanes::FpGuard, which the
/// caller holds.
std::optional<GltfModel> build_gltf(const tinygltf::Model& model, Refusal& refusal);

/// The bytes of images: at first of those that have files of their own or data URIs, then also of those in buffers
/// that materials need.
struct ImageBytes {
  std::map<int, std::shared_ptr<const std::string>> by_index;
  size_t copied = 0;  ///< from buffers; at most max_gltf_bytes, as views may overlap
};
/// A material that exists, its images with names that begin with `file`. Refuses textures that lead nowhere.
/// Computed under lanes::FpGuard, which the caller holds.
GltfMaterial read_material(const tinygltf::Model& model, int material, const std::string& file,
                           ImageBytes& images, Refusal& refusal);

/// Gives the vertices from `first` on tangents along u, from their positions, normals and texture coordinates;
/// triangles from index `first_index` on point to them. A vertex without a direction of u gets any that is
/// perpendicular to its normal.
void add_tangents(Mesh& mesh, int64_t first, size_t first_index);
/// Some unit vector.
glm::vec3 perpendicular_to(const glm::vec3& normal);

}  // namespace isoshade::scene
