// SPDX-License-Identifier: Apache-2.0
// Damaged glTF files: each is read or refused, and what is read keeps the promises of a mesh. With ISOSHADE_FULL
// set there are 5,000 of them.
#include "runtime/scene/gltf.h"

#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>

#include "compiler/lower/frame_layout.h"
#include "tests/fuzz/mutate.h"
#include "tests/unit/gltf_files.h"

namespace isoshade {
namespace {

using namespace testing;

void expect_promises(const scene::GltfModel& model) {
  const scene::Mesh& mesh = model.mesh;
  size_t first_index = 0, first_vertex = 0;
  for (const scene::GltfPart& part : model.parts) {
    ASSERT_EQ(part.first_index, first_index);
    ASSERT_EQ(part.first_vertex, first_vertex);
    ASSERT_GT(part.index_count, 0u);
    ASSERT_EQ(part.index_count % 3, 0u);
    first_index += part.index_count;
    first_vertex += part.vertex_count;
    ASSERT_LE(first_index, mesh.indices.size());
    for (size_t i = part.first_index; i < first_index; ++i) {
      ASSERT_GE(mesh.indices[i], part.first_vertex);
      ASSERT_LT(mesh.indices[i], first_vertex);
    }
  }
  ASSERT_EQ(first_index, mesh.indices.size());
  ASSERT_EQ(first_vertex * lower::vertex_word::stride, mesh.vertices.size());
  for (const float value : mesh.vertices) ASSERT_TRUE(std::isnormal(value) || value == 0);
}

TEST(DamagedGltf, IsReadOrRefused) {
  const Folder folder;
  folder.write("a.bin", square_data());
  const std::string json = square_json(),
                    beside = square_json(all_attributes, one_node, R"("uri": "a.bin", )");
  const std::string nodes = square_json(
      all_attributes, R"([{"children": [1, 2], "scale": [2, 2, 2]}, {"mesh": 0}, {"mesh": 0, "matrix":
[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}])");
  // Of a .glb, bytes are damaged; of its JSON, words too, and its chunk is then as long as they need.
  Mutator binaries({glb(json, square_data()), glb(nodes, square_data()), textured_glb("image")}, 1),
      texts({json, nodes, materials_json()}, 2), files({beside}, 3);
  const int count = std::getenv("ISOSHADE_FULL") != nullptr ? 5000 : 200;
  int read = 0;
  for (int i = 0; i < count; ++i) {
    const bool text = i % 4 == 3;
    const std::string bytes = text         ? files.next()
                              : i % 4 == 0 ? binaries.next()
                                           : glb(texts.next(), square_data());
    support::Diagnostics diagnostics;
    const auto model = scene::load_gltf(folder.write(text ? "m.gltf" : "m.glb", bytes), {}, diagnostics);
    ASSERT_NE(model.has_value(), diagnostics.has_errors()) << "file " << i;
    if (!model) continue;
    ++read;
    ASSERT_NO_FATAL_FAILURE(expect_promises(*model)) << "file " << i;
  }
  EXPECT_GT(read, count / 20);  // else the damage is too great to get beyond the parser
  EXPECT_LT(read, count);
}

}  // namespace
}  // namespace isoshade
