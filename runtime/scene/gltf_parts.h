// SPDX-License-Identifier: Apache-2.0
// The parts of load_gltf. tinygltf does not validate files: every index, offset and count is checked here before it is
// used.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tiny_gltf.h>
#include <vector>

#include "compiler/graph/document.h"
#include "compiler/support/diagnostics.h"
#include "compiler/support/read_file.h"
#include "runtime/scene/mesh_formats.h"

namespace isoshade::scene {

/// Why a file is refused. Keeps the first reason.
class Refusal {
 public:
  /// The mesh is the fault. Returns false, so that callers can return the result.
  bool refuse(std::string reason) { return refuse(support::Id::bad_mesh, {}, std::move(reason)); }
  /// A part of the file is the fault: "the image 2".
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

/// The extensions that are read.
namespace extension {
inline constexpr const char* texture_transform = "KHR_texture_transform";
inline constexpr const char* emissive_strength = "KHR_materials_emissive_strength";
inline constexpr const char* unlit = "KHR_materials_unlit";
}  // namespace extension
inline bool is_read_extension(std::string_view name) {
  return name == extension::texture_transform || name == extension::emissive_strength || name == extension::unlit;
}

/// Checks the text before tinygltf reads it: JSON, not nested so deep that tinygltf crashes; glTF 2; limited total size
/// of the buffers; no required extensions but those that are read; each image has a source; indices are integers and
/// numbers are numbers, those of extensions within 1e6 of 0: tinygltf truncates integers to 32 bits and ignores values
/// of the wrong type.
bool check_json(const graph::Document& document, Refusal& refusal);

/// Checks the data URIs of buffers, of a text that check_json accepts, where tinygltf has refused it: it would print all of
/// a URI.
bool check_buffers(const graph::Document& document, Refusal& refusal);

/// Warns once about each feature and extension that the file uses and isoshade does not read. `where` names the file.
void warn_ignored(const graph::Document& document, const std::string& path, const support::Span& where,
                  support::Diagnostics& diagnostics);

/// The numbers of an accessor as floats: `count` elements of a fixed width. Normalised integers are divided by their
/// maximum. All are finite; denormals become zeros.
struct Numbers {
  std::vector<float> values;
  size_t count = 0;
};

/// Reads accessors of `width` floats, or with `integers` also of normalised unsigned bytes or shorts.
std::optional<Numbers> read_numbers(const tinygltf::Model& model, int accessor, int width, bool integers,
                                    Refusal& refusal);
/// Reads scalars of unsigned bytes, shorts or ints.
std::optional<std::vector<uint32_t>> read_indices(const tinygltf::Model& model, int accessor,
                                                  Refusal& refusal);
/// The number of components of an accessor, 1 to 4; 0 if the accessor does not exist.
int components_of(const tinygltf::Model& model, int accessor);

/// The triangles of the scene; the parts have no materials yet. The caller holds lanes::FpGuard.
std::optional<Model> build_gltf(const tinygltf::Model& model, Refusal& refusal);

/// The images of a file by number: those in data URIs first; those in buffers and in files are added when a material
/// needs them.
struct ImageBytes {
  std::string file;    ///< the path, as the user wrote it
  std::string folder;  ///< canonical folder of the file: image files must lie in or below it
  std::map<int, std::shared_ptr<const std::string>> by_index;
  size_t total = 0;  ///< bytes read for materials; at most max_gltf_bytes, as buffer views may overlap
};
/// Reads an image that exists, or refuses the file.
std::optional<MaterialImage> read_gltf_image(const tinygltf::Model& model, int image, ImageBytes& images,
                                             Refusal& refusal);
/// Reads a material that exists. Refuses textures without an image, and samplers that do not exist. The caller holds lanes::FpGuard.
Material read_material(const tinygltf::Model& model, int material, ImageBytes& images, Refusal& refusal);
/// The set of texture coordinates of the normal texture of a material, 0 or 1: tangents run along its u. A negative
/// number is no material.
int normal_texcoord_set(const tinygltf::Model& model, int material);

/// Computes tangents along the u of a set of texture coordinates for the vertices from `first` on, which the triangles
/// from index `first_index` on use. A vertex where u has no direction gets some tangent perpendicular to its normal.
void add_tangents(Mesh& mesh, int64_t first, size_t first_index, int set);
/// Returns some unit vector perpendicular to `normal`.
glm::vec3 perpendicular_to(const glm::vec3& normal);

}  // namespace isoshade::scene
