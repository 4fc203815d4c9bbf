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

#include "compiler/graph/document.h"
#include "compiler/support/diagnostics.h"
#include "compiler/support/read_file.h"
#include "runtime/scene/gltf.h"

namespace isoshade::scene {

/// Why a file is refused. The first reason stays.
class Refusal {
 public:
  /// Of the mesh. Returns false, for callers that return so.
  bool refuse(std::string reason) { return refuse(support::Id::bad_mesh, {}, std::move(reason)); }
  /// Of a part of the file: "the image 2".
  bool refuse(support::Id id, std::string part, std::string reason) {
    if (!refused()) id_ = id, part_ = std::move(part), reason_ = std::move(reason);
    return false;
  }
  bool refused() const { return !reason_.empty(); }
  void report(const std::string& file, const support::Span& where, support::Diagnostics& diagnostics) const;

 private:
  support::Id id_ = support::Id::bad_mesh;
  std::string part_;
  std::string reason_;
};

/// The text of a .gltf file, or of the first chunk of a .glb.
std::optional<std::string> json_of(const std::string& bytes, Refusal& refusal);
bool is_binary(const std::string& bytes);

/// What is asked of the text before tinygltf may read it: that it is JSON and not nested too deep, which would crash
/// it; that it is glTF 2; that its buffers are not too large together; that it requires no extension, as none is read; that each
/// image is somewhere; and that indices and numbers are such: tinygltf takes the lowest 32 bits of an integer, and what
/// is of the wrong kind for nothing.
bool check_json(const graph::Document& document, Refusal& refusal);

/// Warns once, by name, of each feature and extension that the file uses and that is not read. `where` names the file.
void warn_ignored(const graph::Document& document, const std::string& path, const support::Span& where,
                  support::Diagnostics& diagnostics);

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

/// The images of a file, by their numbers: at first those in data URIs, then also those in buffers and in files of
/// their own that materials need.
struct ImageBytes {
  std::string file;    ///< whose images they are, as the user calls it
  std::string folder;  ///< of the file, canonical: images of their own lie in or below it
  std::map<int, std::shared_ptr<const std::string>> by_index;
  size_t total = 0;  ///< of those that were read for materials; at most max_gltf_bytes, as views may overlap
};
/// An image that exists, or a refusal.
std::optional<GltfImage> read_gltf_image(const tinygltf::Model& model, int image, ImageBytes& images,
                                         Refusal& refusal);
/// A material that exists. Refuses textures that lead nowhere. Computed under lanes::FpGuard, which the caller holds.
GltfMaterial read_material(const tinygltf::Model& model, int material, ImageBytes& images, Refusal& refusal);

/// Gives the vertices from `first` on tangents along u, from their positions, normals and texture coordinates;
/// triangles from index `first_index` on point to them. A vertex without a direction of u gets any that is
/// perpendicular to its normal.
void add_tangents(Mesh& mesh, int64_t first, size_t first_index);
/// Some unit vector.
glm::vec3 perpendicular_to(const glm::vec3& normal);

}  // namespace isoshade::scene
