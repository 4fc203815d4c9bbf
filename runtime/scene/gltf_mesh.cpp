// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>
#include <map>
#include <utility>

#include "compiler/lower/frame_layout.h"
#include "runtime/scene/gltf_parts.h"
#include "runtime/scene/host_math.h"
#include "runtime/scene/mesh_builder.h"

namespace isoshade::scene {
namespace {

namespace word = lower::vertex_word;

constexpr float max_coordinate = 1e9f;  ///< keeps all matrices finite, as format::coordinates

/// The vertex attributes of a primitive; empty if it does not have the attribute.
struct Attributes {
  size_t count = 0;
  std::vector<float> positions, normals, texcoords, texcoords1, tangents, colors;
  int color_width = 0;
};

class Builder {
 public:
  Builder(const tinygltf::Model& model, Refusal& refusal) : model_(model), refusal_(refusal) {}

  std::optional<Model> build();

 private:
  struct Placed {
    int node;
    glm::mat4 parent;
  };
  struct Part {
    int material;  ///< -1: none
    Mesh mesh;
  };

  std::vector<int> roots();
  bool add_node(const Placed& placed, std::vector<Placed>& open);
  std::optional<glm::mat4> local_matrix(const tinygltf::Node& node);
  bool add_primitive(const tinygltf::Primitive& primitive);
  bool read_attributes(const tinygltf::Primitive& primitive, Attributes& attributes);
  bool read_triangles(const tinygltf::Primitive& primitive, size_t vertices, std::vector<uint32_t>& corners);
  Part* part_of(int material);
  bool place_vertex(const Attributes& attributes, size_t i, Mesh& mesh);
  Model join();

  const tinygltf::Model& model_;
  Refusal& refusal_;
  std::vector<Part> parts_;
  std::map<int, size_t> part_of_material_;
  std::vector<bool> seen_;                ///< nodes
  int64_t vertices_ = 0, triangles_ = 0;  ///< read so far
  // Of the current node.
  glm::mat4 matrix_{1};
  glm::mat3 normal_matrix_{1};
  bool mirrored_ = false;
};

glm::vec3 vector_at(const std::vector<float>& values, size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

glm::vec3 apply(const glm::mat3& matrix, const glm::vec3& v) {
  return matrix[0] * v.x + matrix[1] * v.y + matrix[2] * v.z;
}

/// Transforms a vector and normalises it. Files have normals of any length; scaling by a power of two is exact and
/// keeps very long and very short ones from overflow and underflow.
glm::vec3 direction(const glm::mat3& matrix, glm::vec3 v) {
  const float largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (largest > 0x1p32f) v *= 0x1p-96f;
  if (largest < 0x1p-32f) v *= 0x1p96f;
  return normalize(apply(matrix, v));
}

bool is_finite(const glm::mat3& matrix) {
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r)
      if (!std::isfinite(matrix[c][r])) return false;
  return true;
}

/// The root nodes of the scene.
std::vector<int> Builder::roots() {
  if (!model_.scenes.empty()) {
    const size_t scene = model_.defaultScene < 0 ? 0 : static_cast<size_t>(model_.defaultScene);
    if (scene < model_.scenes.size()) return model_.scenes[scene].nodes;
    refusal_.refuse("its scene does not exist");
    return {};
  }
  std::vector<bool> child(model_.nodes.size());
  for (const tinygltf::Node& node : model_.nodes)
    for (const int c : node.children)
      if (c >= 0 && static_cast<size_t>(c) < child.size()) child[static_cast<size_t>(c)] = true;
  std::vector<int> roots;
  for (size_t n = 0; n < child.size(); ++n)
    if (!child[n]) roots.push_back(static_cast<int>(n));
  return roots;
}

std::optional<glm::mat4> Builder::local_matrix(const tinygltf::Node& node) {
  const auto refuse = [&](const char* reason) {
    refusal_.refuse(std::string("the transform of a node ") + reason);
    return std::nullopt;
  };
  const auto fits = [](const std::vector<double>& values, size_t count) {
    return values.empty() || values.size() == count;
  };
  if (!fits(node.matrix, 16) || !fits(node.translation, 3) || !fits(node.rotation, 4) || !fits(node.scale, 3))
    return refuse("has the wrong size");
  for (const std::vector<double>* values : {&node.matrix, &node.translation, &node.rotation, &node.scale})
    for (const double value : *values)
      if (!(std::abs(value) <= double{max_coordinate})) return refuse("has a number beyond 1e9");
  glm::mat4 matrix(1);
  const auto number = [](double value) { return canonical(static_cast<float>(value)); };
  if (!node.matrix.empty()) {
    for (size_t i = 0; i < 16; ++i)
      matrix[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = number(node.matrix[i]);
    if (matrix[0][3] != 0 || matrix[1][3] != 0 || matrix[2][3] != 0 || matrix[3][3] != 1)
      return refuse("is not affine");
    return matrix;
  }
  glm::mat3 rotation(1);
  if (!node.rotation.empty()) {
    std::array<float, 4> quaternion;
    for (size_t i = 0; i < 4; ++i) quaternion[i] = number(node.rotation[i]);
    if (quaternion == std::array<float, 4>{}) return refuse("is not a rotation");
    rotation = rotation_of_quaternion(quaternion);
  }
  for (int c = 0; c < 3; ++c) {
    const auto i = static_cast<size_t>(c);
    matrix[c] = glm::vec4(rotation[c] * (node.scale.empty() ? 1.0f : number(node.scale[i])), 0);
    if (!node.translation.empty()) matrix[3][c] = number(node.translation[i]);
  }
  return matrix;
}

bool Builder::add_node(const Placed& placed, std::vector<Placed>& open) {
  const auto n = static_cast<size_t>(placed.node);
  if (placed.node < 0 || n >= model_.nodes.size()) return refusal_.refuse("a node does not exist");
  if (seen_[n]) {
    return refusal_.refuse("node " + std::to_string(n) + " has two parents, or is below itself");
  }
  seen_[n] = true;
  const tinygltf::Node& node = model_.nodes[n];
  const auto local = local_matrix(node);
  if (!local) return false;
  const glm::mat4 matrix = multiply(placed.parent, *local);
  for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
    open.push_back({*child, matrix});
  if (node.mesh < 0) return true;
  if (static_cast<size_t>(node.mesh) >= model_.meshes.size()) return refusal_.refuse("a mesh does not exist");
  const float determinant = dot(glm::vec3(matrix[0]), cross(glm::vec3(matrix[1]), glm::vec3(matrix[2])));
  const glm::mat3 normals = normal_matrix(matrix);
  if (!std::isfinite(determinant) || !is_finite(normals))
    return refusal_.refuse("the transforms of its nodes are too large");
  if (determinant == 0) return true;  // files hide nodes by a scale of 0
  matrix_ = matrix;
  normal_matrix_ = normals;
  mirrored_ = determinant < 0;
  const auto& primitives = model_.meshes[static_cast<size_t>(node.mesh)].primitives;
  return std::ranges::all_of(primitives, [&](const auto& primitive) { return add_primitive(primitive); });
}

bool Builder::read_attributes(const tinygltf::Primitive& primitive, Attributes& attributes) {
  const auto find = [&](const char* name) {
    const auto found = primitive.attributes.find(name);
    return found == primitive.attributes.end() ? -1 : found->second;
  };
  const auto read = [&](const char* name, int width, bool integers, std::vector<float>& values) {
    if (!primitive.attributes.contains(name)) return true;
    auto numbers = read_numbers(model_, find(name), width, integers, refusal_);
    if (!numbers) return false;
    if (attributes.count == 0) attributes.count = numbers->count;
    if (numbers->count != attributes.count) {
      return refusal_.refuse(std::string(name) + " has " + std::to_string(numbers->count) +
                             " vertices, not " + std::to_string(attributes.count));
    }
    values = std::move(numbers->values);
    return true;
  };
  if (!primitive.attributes.contains("POSITION")) return true;
  attributes.color_width = components_of(model_, find("COLOR_0")) == 3 ? 3 : 4;
  return read("POSITION", 3, false, attributes.positions) && read("NORMAL", 3, false, attributes.normals) &&
         read("TEXCOORD_0", 2, true, attributes.texcoords) &&
         read("TEXCOORD_1", 2, true, attributes.texcoords1) &&
         read("TANGENT", 4, false, attributes.tangents) &&
         read("COLOR_0", attributes.color_width, true, attributes.colors);
}

/// Reads the indices as separate triangles, whatever the mode of the primitive.
bool Builder::read_triangles(const tinygltf::Primitive& primitive, size_t vertices,
                             std::vector<uint32_t>& corners) {
  std::vector<uint32_t> indices;
  if (primitive.indices >= 0) {
    auto read = read_indices(model_, primitive.indices, refusal_);
    if (!read) return false;
    indices = *std::move(read);
  } else {
    for (size_t i = 0; i < vertices; ++i) indices.push_back(static_cast<uint32_t>(i));
  }
  for (const uint32_t index : indices) {
    if (index >= vertices) {
      return refusal_.refuse("index " + std::to_string(index) + " is out of range: there are " +
                             std::to_string(vertices) + " vertices");
    }
  }
  const bool list = primitive.mode == TINYGLTF_MODE_TRIANGLES || primitive.mode < 0;
  if (list && indices.size() % 3 != 0) return refusal_.refuse("a triangle does not have three corners");
  const size_t count = list ? indices.size() / 3 : indices.size() < 3 ? 0 : indices.size() - 2;
  triangles_ += static_cast<int64_t>(count);
  if (triangles_ > max_gltf_triangles)
    return refusal_.refuse("it has more than " + std::to_string(max_gltf_triangles) + " triangles");
  if (list) {
    corners = std::move(indices);
    return true;
  }
  const bool fan = primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN;
  for (size_t i = 0; i < count; ++i) {
    const size_t odd = i % 2;
    const std::array<size_t, 3> triangle =
        fan ? std::array<size_t, 3>{i + 1, i + 2, 0} : std::array<size_t, 3>{i, i + 1 + odd, i + 2 - odd};
    for (const size_t corner : triangle) corners.push_back(indices[corner]);
  }
  return true;
}

bool Builder::place_vertex(const Attributes& attributes, size_t i, Mesh& mesh) {
  const glm::vec4 position = multiply(matrix_, glm::vec4(vector_at(attributes.positions, i), 1));
  for (int axis = 0; axis < 3; ++axis)
    if (!(std::abs(position[axis]) <= max_coordinate)) return refusal_.refuse("a vertex lies beyond 1e9");
  glm::vec3 normal(0), tangent(0);
  glm::vec2 texcoord(0);
  if (!attributes.normals.empty()) normal = direction(normal_matrix_, vector_at(attributes.normals, i));
  if (!attributes.texcoords.empty())
    texcoord = {attributes.texcoords[2 * i], attributes.texcoords[2 * i + 1]};
  float sign = 1;
  if (!attributes.tangents.empty()) {
    const float* t = &attributes.tangents[4 * i];
    tangent = direction(glm::mat3(matrix_), {t[0], t[1], t[2]});
    sign = (t[3] < 0) != mirrored_ ? -1.0f : 1.0f;
  }
  add_vertex(mesh, glm::vec3(position), normal, texcoord.x, texcoord.y, tangent);
  float* record = &mesh.vertices[mesh.vertices.size() - word::stride];
  record[word::tangent + 3] = sign;
  if (!attributes.texcoords1.empty()) std::copy_n(&attributes.texcoords1[2 * i], 2, record + word::texcoord1);
  if (attributes.colors.empty()) return true;
  for (int c = 0; c < attributes.color_width; ++c) {
    const auto at = i * static_cast<size_t>(attributes.color_width) + static_cast<size_t>(c);
    record[word::color + c] = attributes.colors[at];
  }
  return true;
}

/// Sets face normals for the triangles from an index on, which share no vertices.
void make_flat(Mesh& mesh, size_t first_index) {
  for (size_t t = first_index; t < mesh.indices.size(); t += 3) {
    float* records[3];
    glm::vec3 points[3];
    for (size_t i = 0; i < 3; ++i) {
      records[i] = &mesh.vertices[size_t{mesh.indices[t + i]} * word::stride];
      points[i] = {records[i][0], records[i][1], records[i][2]};
    }
    const glm::vec3 normal =
        normalize(cross(normalize(points[1] - points[0]), normalize(points[2] - points[0])));
    for (float* record : records)
      for (int axis = 0; axis < 3; ++axis) record[word::normal + axis] = canonical(normal[axis]);
  }
}

bool Builder::add_primitive(const tinygltf::Primitive& primitive) {
  const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
  if (mode > TINYGLTF_MODE_TRIANGLE_FAN) return refusal_.refuse("a primitive has an unknown mode");
  if (mode < TINYGLTF_MODE_TRIANGLES) return true;  // points and lines
  Attributes attributes;
  std::vector<uint32_t> corners;
  if (!read_attributes(primitive, attributes)) return false;
  if (attributes.count == 0) return true;
  if (!read_triangles(primitive, attributes.count, corners)) return false;
  if (corners.empty()) return true;
  Part* part = part_of(primitive.material);
  if (part == nullptr) return false;
  if (mirrored_)
    for (size_t t = 0; t < corners.size(); t += 3) std::swap(corners[t + 1], corners[t + 2]);

  Mesh& mesh = part->mesh;
  const int64_t first = vertices_of(mesh);
  const size_t first_index = mesh.indices.size();
  // Flat faces share no vertices; the specification requires new tangents for them.
  const bool flat = attributes.normals.empty();
  if (flat) attributes.tangents.clear();
  const size_t added = flat ? corners.size() : attributes.count;
  vertices_ += static_cast<int64_t>(added);
  if (vertices_ > max_gltf_vertices)
    return refusal_.refuse("it has more than " + std::to_string(max_gltf_vertices) + " vertices");
  for (size_t i = 0; i < added; ++i)
    if (!place_vertex(attributes, flat ? corners[i] : i, mesh)) return false;
  for (size_t i = 0; i < corners.size(); ++i)
    mesh.indices.push_back(static_cast<uint32_t>(first) + (flat ? static_cast<uint32_t>(i) : corners[i]));
  if (flat) make_flat(mesh, first_index);
  if (attributes.tangents.empty())
    add_tangents(mesh, first, first_index, normal_texcoord_set(model_, primitive.material));
  return true;
}

/// Computes outline normals and the bounding box, and missing normals and tangents.
void finish(Mesh& mesh) {
  add_outline_normals(mesh);
  find_box(mesh);
  const auto is_zero = [](const float* v) { return v[0] == 0 && v[1] == 0 && v[2] == 0; };
  for (size_t v = 0; v < mesh.vertices.size(); v += word::stride) {
    float* record = &mesh.vertices[v];
    float* outline = record + word::outline_normal;
    if (is_zero(outline)) outline[1] = 1;
    if (is_zero(record + word::normal)) std::copy_n(outline, 3, record + word::normal);
    if (!is_zero(record + word::tangent)) continue;
    const float* n = record + word::normal;
    const glm::vec3 tangent = perpendicular_to({n[0], n[1], n[2]});
    for (int axis = 0; axis < 3; ++axis) record[word::tangent + axis] = canonical(tangent[axis]);
  }
}

/// The part for the triangles of a material.
Builder::Part* Builder::part_of(int material) {
  if (material >= static_cast<int>(model_.materials.size())) {
    refusal_.refuse("a material does not exist");
    return nullptr;
  }
  material = std::max(material, -1);
  const auto [found, is_new] = part_of_material_.try_emplace(material, parts_.size());
  if (!is_new) return &parts_[found->second];
  if (parts_.size() == max_gltf_parts) {
    refusal_.refuse("its triangles have more than " + std::to_string(max_gltf_parts) + " materials");
    return nullptr;
  }
  return &parts_.emplace_back(Part{material, {}});
}

/// Joins all parts into one mesh.
Model Builder::join() {
  Model model;
  Mesh& mesh = model.mesh;
  for (Part& part : parts_) {
    ModelPart& joined = model.parts.emplace_back();
    joined.material_index = part.material;
    joined.first_index = mesh.indices.size();
    joined.index_count = part.mesh.indices.size();
    joined.first_vertex = static_cast<size_t>(vertices_of(mesh));
    joined.vertex_count = static_cast<size_t>(vertices_of(part.mesh));
    for (const uint32_t index : part.mesh.indices)
      mesh.indices.push_back(static_cast<uint32_t>(joined.first_vertex) + index);
    mesh.vertices.insert(mesh.vertices.end(), part.mesh.vertices.begin(), part.mesh.vertices.end());
    part.mesh = {};  // frees its memory
  }
  return model;
}

std::optional<Model> Builder::build() {
  seen_.resize(model_.nodes.size());
  const std::vector<int> top = roots();
  std::vector<Placed> open;
  for (auto root = top.rbegin(); root != top.rend(); ++root) open.push_back({*root, glm::mat4(1)});
  while (!open.empty() && !refusal_.refused()) {
    const Placed placed = open.back();
    open.pop_back();
    if (!add_node(placed, open)) return std::nullopt;
  }
  if (parts_.empty()) refusal_.refuse("it has no triangles");
  if (refusal_.refused()) return std::nullopt;
  Model joined = join();
  finish(joined.mesh);
  return joined;
}

}  // namespace

std::optional<Model> build_gltf(const tinygltf::Model& model, Refusal& refusal) {
  return Builder(model, refusal).build();
}

}  // namespace isoshade::scene
