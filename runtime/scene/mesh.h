// SPDX-License-Identifier: Apache-2.0
// Meshes made by rule. A shape has the same bits on every machine.
#pragma once

#include <compare>
#include <cstdint>
#include <glm/vec3.hpp>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

namespace isoshade::threads {
class Workers;
}

namespace isoshade::scene {

/// Shapes that are made by rule, and meshes that are read from files.
enum class MeshKind : uint8_t { sphere, plane, box, icosphere, cylinder, cone, torus, lathe, file };
/// The names of those made by rule; files are called by their formats (mesh_formats.h).
inline constexpr std::string_view ruled_mesh_names[] = {"sphere",   "plane", "box",   "icosphere",
                                                        "cylinder", "cone",  "torus", "lathe"};
static_assert(std::size(ruled_mesh_names) == static_cast<size_t>(MeshKind::file));

inline constexpr int64_t max_segments = 1024;      ///< of a mesh, along each direction
inline constexpr int64_t max_subdivisions = 8;     ///< of an icosphere
inline constexpr size_t max_profile_points = 256;  ///< of a lathe

/// A point of the profile of a lathe: a circle around the y axis.
struct ProfilePoint {
  float radius = 0, height = 0;  ///< the radius is 0 only at an end
  bool smooth = true;            ///< no edge runs along the circle
  auto operator<=>(const ProfilePoint&) const = default;
};

/// The description of a mesh. Equal shapes have equal meshes.
struct MeshShape {
  MeshKind kind = MeshKind::sphere;
  /// (Ico)sphere: the radius in each component; plane: x and z; box: x, y and z; cylinder, cone: the radius and
  /// the height; torus: the radius of the circle in the tube's middle, and that of the tube, which is less.
  glm::vec3 size{1, 1, 1};
  int segments = 64;  ///< around the axis; plane: along x and along z
  int rings = 32;     ///< sphere: from pole to pole; cylinder, cone: along the side; torus: around the tube;
                      ///< icosphere: how often its triangles are cut into four
  bool caps = true;   ///< cylinder, cone: whether their ends are closed
  std::vector<ProfilePoint> profile{};  ///< lathe: at least 2 points; consecutive ones differ
  std::string file{};                   ///< file: its path
  size_t format = 0;                    ///< file: in mesh_formats
  bool fit = false;                     ///< file: centred, and scaled to unit size
  bool operator==(const MeshShape&) const = default;
};

/// Vertices are records of lower::vertex_word, indices are triples. Triangles are counter-clockwise seen from outside
/// (a plane: from above; a lathe: from the right of the profile's direction); none is degenerate.
struct Mesh {
  std::vector<float> vertices;
  std::vector<uint32_t> indices;
  glm::vec3 low{0, 0, 0}, high{0, 0, 0};  ///< the bounding box
};

/// All but the lathe are centred on the origin; y is the axis of revolution. Longitude runs from -z over -x, +z and +x,
/// and u with it; v runs down.
///
/// Sphere: poles at +y (v = 0) and -y. Icosphere: the same texture on triangles of nearly one size; u passes 1
/// in those that cross the seam. Plane: in y = 0, facing +y, u along +x and v along +z. Box: each face has its
/// own 4 vertices. Cylinder, cone (its tip at +y): v is 0 to 1 on the side and on each cap, from its middle at
/// the top, to its middle at the bottom. Torus: v runs around the tube from the inside over the top. Lathe: v
/// is the remaining fraction of the profile's length. Tangents run along u, normal x tangent against v; vertices
/// are white.
///
/// `shape` is not a file. Works on the threads of `workers` if there are any; the bits do not depend on that.
Mesh make_mesh(const MeshShape& shape, threads::Workers* workers = nullptr);
/// At least as many vertices as the mesh of a shape that is not a file has; not many more.
int64_t most_vertices(const MeshShape& shape);

/// Centres the bounding box on the origin and scales it so that its longest edge is 1.
void fit_to_unit_size(Mesh& mesh);

}  // namespace isoshade::scene
