// SPDX-License-Identifier: Apache-2.0
// glTF: of a .glb bytes are damaged; of its JSON words too, and its chunk is then as long as they need.
#include <cmath>

#include "compiler/lower/frame_layout.h"
#include "compiler/support/assert.h"
#include "runtime/scene/mesh_formats.h"
#include "tests/fuzz/damage.h"
#include "tests/fuzz/mutate.h"
#include "tests/fuzz/reader.h"
#include "tests/unit/gltf_files.h"
#include "tests/unit/image_files.h"

namespace isoshade {
namespace {

using namespace testing;
using support::assert_that;

std::vector<std::string> good() {
  const std::string nodes = square_json(
      all_attributes, R"([{"children": [1, 2], "scale": [2, 2, 2]}, {"mesh": 0}, {"mesh": 0, "matrix":
[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}])");
  return {glb(square_json(), square_data()), glb(nodes, square_data()), glb(materials_json(), square_data()),
          textured_glb(png_file(1, 1, 8, 0, {"a"})),
          square_json(all_attributes, one_node, R"("uri": "a.bin", )")};
}

/// The JSON of a .glb, or what is none as it is.
std::string json_of(const std::string& bytes) {
  constexpr size_t header = 20;
  if (!bytes.starts_with("glTF") || bytes.size() < header) return bytes;
  return bytes.substr(header, bytes.find("BIN", header) - header - 4);
}

std::string damaged(const std::vector<std::string>& files, uint32_t seed) {
  Random random(seed);
  std::string bytes = random.any(files);
  if (bytes.starts_with("glTF") && random.one_in(2)) {
    damage_file(bytes, random);
    return bytes;
  }
  const std::string text = Mutator({json_of(bytes)}, static_cast<uint32_t>(random.below(1u << 31))).next();
  return bytes.starts_with("glTF") ? glb(text, square_data()) : text;
}

bool read(const std::string& bytes) {
  static const Folder folder;
  static const std::string data = folder.write("a.bin", square_data());
  support::Diagnostics diagnostics;
  const std::string name = bytes.starts_with("glTF") ? "m.glb" : "m.gltf";
  std::filesystem::remove(folder.path() + "/" + name);  // a file system may wait where one is written anew
  const auto model = scene::load_gltf(folder.write(name, bytes), {}, diagnostics);
  assert_that(model.has_value() != diagnostics.has_errors(), "neither a mesh nor errors");
  if (!model) return false;
  const scene::Mesh& mesh = model->mesh;
  size_t first_index = 0, first_vertex = 0;
  for (const scene::ModelPart& part : model->parts) {
    assert_that(part.first_index == first_index && part.first_vertex == first_vertex, "parts that do not follow");
    assert_that(part.index_count > 0 && part.index_count % 3 == 0, "a part that has no triangles");
    first_index += part.index_count;
    first_vertex += part.vertex_count;
    assert_that(first_index <= mesh.indices.size(), "a part beyond the indices");
    for (size_t i = part.first_index; i < first_index; ++i)
      assert_that(mesh.indices[i] >= part.first_vertex && mesh.indices[i] < first_vertex,
            "an index of another part");
  }
  assert_that(first_index == mesh.indices.size(), "indices of no part");
  assert_that(first_vertex * lower::vertex_word::stride == mesh.vertices.size(), "vertices of no part");
  for (const float value : mesh.vertices)
    assert_that(std::isnormal(value) || value == 0, "a vertex that is no number");
  return true;
}

}  // namespace

const Reader gltf_reader = {"gltf", good, damaged, nullptr, read};

}  // namespace isoshade
