// SPDX-License-Identifier: Apache-2.0
// A scene as its document describes it: checked, but nothing computed yet.
#pragma once

#include <array>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/graph/document.h"
#include "compiler/graph/graph.h"
#include "compiler/interface/binding.h"
#include "runtime/scene/encode.h"
#include "runtime/scene/mesh.h"

namespace isoshade::scene {

inline constexpr int max_size = interface::max_size;  ///< of each side of the image, in pixels
/// Limits that keep hostile scenes harmless.
inline constexpr int64_t max_instances = 65'536;
inline constexpr size_t max_lights = interface::max_lights;

enum class Projection : uint8_t { perspective, orthographic };

/// Looks from `position` to `target`. Neither coincide, nor is `up` parallel to the view.
struct Camera {
  Projection projection = Projection::perspective;
  glm::vec3 position{0, 0, 0};
  glm::vec3 target{0, 0, -1};
  glm::vec3 up{0, 1, 0};
  float fov = 45;     ///< perspective: the vertical angle of view in degrees
  float height = 2;   ///< orthographic: of the view, in world units
  float near = 0.1f;  ///< distance of the near plane along the view
  float far = 1000;   ///< orthographic: where the depth ends; in perspective it never does
};

enum class LightKind : uint8_t { directional, point, spot };

struct Light {
  std::string name;
  LightKind kind = LightKind::directional;
  glm::vec3 direction{0, -1, 0};  ///< directional, spot: the way the light travels; any length but 0
  glm::vec3 position{0, 0, 0};    ///< point, spot
  glm::vec3 color{1, 1, 1};       ///< linear
  float intensity = 1;
  float range = 0;         ///< point, spot: where the light ends; 0: nowhere
  float inner_angle = 0;   ///< spot: degrees from the axis up to which it shines in full
  float outer_angle = 45;  ///< spot: degrees from the axis where it ends; greater than the inner one
};

/// Scale, then rotate, then translate.
struct Transform {
  glm::vec3 translate{0, 0, 0};
  glm::vec3 rotate{0, 0, 0};                     ///< degrees about x, then y, then z
  std::optional<std::array<float, 4>> rotation;  ///< a quaternion x y z w of length 1, in place of `rotate`
  glm::vec3 scale{1, 1, 1};                      ///< no component is 0
};

/// A value for a parameter of an effect. Whether the effect has it and takes it is checked by render/.
struct Parameter {
  std::string name;
  graph::Literal value;
  support::Span name_where, value_where;
};

/// A parameter that varies along an axis of a grid: from one value to another in equal steps, or by a list.
struct Variation {
  std::string name;
  std::vector<graph::Literal> values;  ///< listed: one for each place along the axis; else `from` and `to`
  bool listed = false;
  support::Span name_where, value_where;
};

/// One axis of a grid of copies.
struct Repeat {
  int64_t count = 1;
  glm::vec3 step{0, 0, 0};  ///< from one copy to the next, in world space
  std::vector<Variation> variations;
};

struct Object {
  std::string name;
  MeshShape mesh;
  std::string effect;  ///< path of the effect's document
  Transform transform;
  std::vector<Parameter> parameters;  ///< no name twice, also not among the variations
  std::vector<Repeat> repeat;         ///< at most 3 axes
  support::Span name_where, effect_where;
  support::Span mesh_where;  ///< nowhere if the user named its file
};

/// What stands for an image where the number of a post is expected.
inline constexpr int scene_image = -1, no_image = -2;
/// How posts call the image that was drawn.
inline constexpr std::string_view scene_image_name = "scene";
inline constexpr size_t max_posts = 64;

/// An image that a post reads: what its document calls it ("color" is the one that it goes over), and which it is:
/// that of an earlier post of the scene, or scene_image.
struct PostInput {
  std::string image;
  int source = scene_image;
  support::Span image_where, source_where;
};

/// A full-screen effect over the finished image. What is not among its inputs as "color" goes over the image of the
/// post before.
struct Post {
  std::string name;
  std::string effect;  ///< path of the post's document
  std::vector<Parameter> parameters;
  std::vector<PostInput> inputs;
  float size = 1;  ///< of the image that it makes, as a fraction of the scene's; rounded up
  support::Span name_where, effect_where, size_where;
};

struct Output {
  Encoding encoding = Encoding::srgb;
  float exposure = 1;  ///< what colours are multiplied by before the encoding
};

struct Scene {
  std::string name;
  support::Source source;
  int width = 640;
  int height = 360;
  int samples = 1;              ///< of each pixel: 1, 4 or 16
  support::Span samples_where;  ///< nowhere if it is not the document that says so
  float time = 0;               ///< what the node `time` gives, in seconds
  Camera camera;
  std::vector<Light> lights;
  std::array<float, 4> background{0, 0, 0, 1};  ///< linear RGBA
  std::vector<Object> objects;
  std::vector<Post> posts;  ///< in the order in which they are run
  Output output;
};

/// Reports everything wrong with a scene document:
///
///     {"isoshade": 1, "scene": "name", "doc": "...", "size": [640, 360], "background": [r, g, b, a],
///      "samples": 1, 4 or 16, "time": 0,
///      "camera": {"type": "perspective", "position": [..], "target": [..], "up": [0, 1, 0], "fov": 45,
///                 "near": 0.1},
///                {"type": "orthographic", ..., "height": 4, "near": 0.1, "far": 1000}
///      "lights": {"sun": {"type": "directional", "direction": [..], "color": [1, 1, 1], "intensity": 1},
///                 "lamp": {"type": "point", "position": [..], "range": 9, ...},
///                 "torch": {"type": "spot", "position": [..], "direction": [..], "inner_angle": 0,
///                           "outer_angle": 45, ...}},
///      "objects": {"ball": {
///        "mesh": "sphere", or {"type": "sphere", "radius": 1, "segments": 64, "rings": 32},
///                {"type": "plane", "size": [1, 1], "segments": 1}, {"type": "box", "size": [1, 1, 1]},
///                {"type": "icosphere", "radius": 1, "subdivisions": 4},
///                {"type": "cylinder" or "cone", "radius": 1, "height": 2, "segments": 64, "rings": 1,
///                 "caps": true},
///                {"type": "torus", "radius": 1, "tube": 0.25, "segments": 64, "rings": 32},
///                {"type": "lathe", "smooth": true, "segments": 64,
///                 "profile": [[radius, height], {"at": [radius, height], "smooth": false}]},
///                {"type": "gltf", "file": "path beside the scene", "fit": false},
///        "effect": "path beside the scene",
///        "transform": {"translate": [..], "rotate": [degrees about x, y, z] or a quaternion,
///                      "scale": 1 or [..]},
///        "parameters": {"roughness": 0.5},
///        "repeat": [{"count": 10, "step": [..], "parameters": {"metallic": {"from": 0, "to": 1},
///                                                              "tint": {"values": [one a place]}}}]}},
///      "posts": [{"name": "fog", "effect": "path beside the scene", "parameters": {"fog_density": 1},
///                 "inputs": {"color": "scene", "glow": "name of an earlier post"}, "size": 0.5}],
///      "output": {"encoding": "srgb" or "linear", "exposure": 1}}
///
/// Only "isoshade", "scene" and "camera" with its position and target are needed. What a scene extends is load.h's.
std::optional<Scene> parse_scene(const graph::Document& document, support::Diagnostics& diagnostics);

/// One copy of an object: its place along each axis of the grid.
struct Instance {
  std::array<int64_t, 3> place{0, 0, 0};
};

/// Copies of an object: the product of its counts.
int64_t instance_count(const Object& object);
/// The copies in the order they are drawn; the first axis runs fastest.
Instance instance(const Object& object, int64_t index);
/// "balls[3,2]" for a copy in a grid, else the object's name.
std::string instance_name(const Object& object, const Instance& instance);
/// Where a copy stands: the object's translation and the steps to it.
glm::vec3 instance_translation(const Object& object, const Instance& instance);
/// The value along an axis: exactly the first at place 0, exactly the last at the last place, and never beyond them.
graph::Literal variation_value(const Variation& variation, int64_t place, int64_t count);

}  // namespace isoshade::scene
