// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/meshes.h"

#include <algorithm>
#include <utility>

#include "compiler/lower/frame_layout.h"
#include "runtime/render/plan_keys.h"

namespace isoshade::render {
namespace {

constexpr size_t stride = lower::vertex_word::stride;

/// How many vertices may be made before it is known whether the scene is within its limits; at least one mesh is.
constexpr int64_t most_made_ahead = 1'000'000;

size_t vertex_count(const StoredMesh& mesh) {
  size_t count = 0;
  for (const MeshPart& part : mesh.parts) count += part.vertex_count;
  return count;
}

}  // namespace

/// Makes the mesh of an object, and those of the objects after it, as far as they are made by rule and not known.
void MeshStore::make_next(std::span<const scene::Object> objects, size_t object) {
  std::vector<std::pair<const scene::MeshShape*, scene::Model*>> jobs;
  int64_t vertices = 0;
  for (; object < objects.size(); ++object) {
    const scene::MeshShape& shape = objects[object].mesh;
    if (shape.kind == scene::MeshKind::file) continue;
    std::string key = key_of(shape);
    if (numbers_.contains(key) || former_.numbers.contains(key)) continue;
    const int64_t more = scene::most_vertices(shape);
    if (!jobs.empty() && vertices + more > most_made_ahead) break;
    const auto [made, is_new] = made_.try_emplace(std::move(key));
    if (!is_new) continue;
    vertices += more;
    jobs.emplace_back(&shape, &made->second);
  }
  workers_.for_each(jobs.size(), [&](size_t i) {
    *jobs[i].second = scene::model_of(scene::make_mesh(*jobs[i].first, &workers_));
  });
}

bool MeshStore::take_former(const std::string& key) {
  const auto found = former_.numbers.find(key);
  if (found == former_.numbers.end()) return false;
  StoredMesh& mesh = meshes_.emplace_back(std::move(former_.meshes[found->second]));
  const size_t first = mesh.parts.front().first_vertex, count = vertex_count(mesh);
  const size_t to = vertices_.size() / stride;
  const auto begin = former_.vertices.begin() + static_cast<ptrdiff_t>(first * stride);
  vertices_.insert(vertices_.end(), begin, begin + static_cast<ptrdiff_t>(count * stride));
  for (MeshPart& part : mesh.parts) part.first_vertex = static_cast<uint32_t>(part.first_vertex - first + to);
  former_.numbers.erase(found);
  return true;
}

std::optional<size_t> MeshStore::find(std::span<const scene::Object> objects, size_t object,
                                      support::Diagnostics& diagnostics) {
  const scene::MeshShape& shape = objects[object].mesh;
  std::string key = key_of(shape);
  if (const auto found = numbers_.find(key); found != numbers_.end()) return found->second;
  if (!take_former(key)) {
    std::optional<scene::Model> model;
    if (shape.kind == scene::MeshKind::file) {
      model = scene::make_model(shape, objects[object].mesh_where, diagnostics);
      if (!model) return std::nullopt;
    } else {
      if (!made_.contains(key)) make_next(objects, object);
      const auto made = made_.find(key);
      model = std::move(made->second);
      made_.erase(made);
    }
    const size_t first_vertex = vertices_.size() / stride;
    vertices_.insert(vertices_.end(), model->mesh.vertices.begin(), model->mesh.vertices.end());
    StoredMesh& stored = meshes_.emplace_back();
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
  }
  return numbers_[std::move(key)] = meshes_.size() - 1;
}

void MeshStore::begin_again() {
  former_ = {std::exchange(numbers_, {}), std::exchange(meshes_, {}), std::exchange(vertices_, {})};
  made_.clear();
}

}  // namespace isoshade::render
