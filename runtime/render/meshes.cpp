// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/meshes.h"

#include <utility>

#include "compiler/lower/frame_layout.h"

namespace isoshade::render {
std::optional<size_t> MeshStore::find(const scene::Object& object, std::vector<StoredMesh>& meshes,
                                      std::vector<float>& vertices, support::Diagnostics& diagnostics) {
  const scene::MeshShape& shape = object.mesh;
  const Key key{shape.kind, shape.size.x,  shape.size.y, shape.size.z, shape.segments, shape.rings,
                shape.caps, shape.profile, shape.file,   shape.format, shape.fit};
  if (const auto found = numbers_.find(key); found != numbers_.end()) return found->second;
  auto model = scene::make_model(shape, object.mesh_where, diagnostics);
  if (!model) return std::nullopt;
  const size_t first_vertex = vertices.size() / lower::vertex_word::stride;
  vertices.insert(vertices.end(), model->mesh.vertices.begin(), model->mesh.vertices.end());
  StoredMesh& stored = meshes.emplace_back();
  stored.low = model->mesh.low;
  stored.high = model->mesh.high;
  for (scene::ModelPart& from : model->parts) {
    MeshPart& part = stored.parts.emplace_back();
    part.first_vertex = static_cast<uint32_t>(first_vertex + from.first_vertex);
    part.vertex_count = static_cast<uint32_t>(from.vertex_count);
    const auto first = model->mesh.indices.begin() + static_cast<ptrdiff_t>(from.first_index);
    part.indices.assign(first, first + static_cast<ptrdiff_t>(from.index_count));
    for (uint32_t& index : part.indices) index -= static_cast<uint32_t>(from.first_vertex);
    part.material = std::move(from.material);
  }
  return numbers_[key] = meshes.size() - 1;
}

}  // namespace isoshade::render
