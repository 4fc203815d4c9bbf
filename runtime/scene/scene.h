// SPDX-License-Identifier: Apache-2.0
// A scene as its document describes it: validated, but nothing is computed yet.
#pragma once

#include <array>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/graph/document.h"
#include "compiler/graph/graph.h"
#include "compiler/graph/setting.h"
#include "compiler/interface/binding.h"
#include "runtime/scene/encode.h"
#include "runtime/scene/mesh.h"

namespace isoshade::scene {

inline constexpr int max_size = interface::max_size;  ///< of each side of the image, in pixels
/// Limits that keep hostile scenes harmless.
inline constexpr int64_t max_instances = 65'536;
inline constexpr size_t max_lights = interface::max_lights;

enum class Projection : uint8_t { perspective, orthographic };
inline constexpr std::string_view projection_names[] = {"perspective", "orthographic"};

/// Looks from `position` to `target`, which differ. `up` is not parallel to the view.
struct Camera {
  Projection projection = Projection::perspective;
  glm::vec3 position{0, 0, 0};
  glm::vec3 target{0, 0, -1};
  glm::vec3 up{0, 1, 0};
  float fov = 45;     ///< perspective: the vertical field of view in degrees
  float height = 2;   ///< orthographic: height of the view in world units
  float near = 0.1f;  ///< distance of the near plane along the view
  float far = 1000;   ///< orthographic: distance of the far plane; perspective has none
};

enum class LightKind : uint8_t { directional, point, spot };
inline constexpr std::string_view light_names[] = {"directional", "point", "spot"};

/// How a light is kept from what lies behind other objects.
struct Shadow {
  int size = 1024;     ///< side of a shadow map, in pixels
  float bias = 1;      ///< of the depth in the map, in units of what a plane needs
  float softness = 2;  ///< width of the edge of a shadow, in pixels of the map
};
inline constexpr int max_shadow_size = 4096;

struct Light {
  static constexpr float default_intensity = 1;
  static constexpr float default_inner_angle = 0;
  static constexpr float default_outer_angle = 45;

  std::string name;
  LightKind kind = LightKind::directional;
  glm::vec3 direction{0, -1,
                      0};       ///< directional, spot: direction in which the light travels; any length but 0
  glm::vec3 position{0, 0, 0};  ///< point, spot
  glm::vec3 color{1, 1, 1};     ///< linear
  float intensity = default_intensity;
  float range = 0;  ///< point, spot: distance at which the light ends; 0: it does not end
  float inner_angle = default_inner_angle;  ///< spot: degrees from the axis up to which the light is full
  float outer_angle =
      default_outer_angle;  ///< spot: degrees from the axis where the light ends; greater than inner_angle
  std::optional<Shadow> shadow;
  support::Span shadow_where;  ///< the size of the shadow, or all of it if it names none
};

/// A disc in the sky.
struct Sun {
  static constexpr float default_size = 1;

  glm::vec3 direction{0, -1, 0};  ///< in which its light travels; any length but 0
  glm::vec3 color{1, 1, 1};       ///< linear
  float intensity = 1;            ///< factor of the colour: the irradiance of a surface that faces the sun
  float size = default_size;      ///< its diameter in degrees
};

/// The sky of library/sky.json, and a sun.
struct Sky {
  glm::vec3 horizon{0, 0, 0}, zenith{0, 0, 0}, ground{0, 0, 0};
  float haze = 0;
  std::optional<Sun> sun;
};

/// Light from all directions, far away: of an image in equirectangular projection, or of a sky.
struct Environment {
  std::string file;  ///< empty: `sky`
  Sky sky;
  float rotate = 0;     ///< degrees about y
  float intensity = 1;  ///< a factor
  support::Span where, file_where;
};

/// Scale, then rotate, then translate.
struct Transform {
  glm::vec3 translate{0, 0, 0};
  glm::vec3 rotate{0, 0, 0};                     ///< degrees about x, then y, then z
  std::optional<std::array<float, 4>> rotation;  ///< a quaternion x y z w of length 1, in place of `rotate`
  glm::vec3 scale{1, 1, 1};                      ///< no component is 0
};

/// render/ checks whether the effect has the parameter and the value fits.
using Parameter = graph::GivenParameter;

/// A parameter that varies along an axis of a grid: from one value to another in equal steps, or over a list.
struct Variation {
  std::string name;
  std::vector<graph::Literal>
      values;  ///< listed: one for each copy along the axis; otherwise `from` and `to`
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
  std::vector<Parameter> parameters;  ///< names are unique, also among the variations
  std::vector<Repeat> repeat;         ///< at most 3 axes
  bool casts_shadow = true, receives_shadow = true;
  support::Span name_where, effect_where;
  support::Span mesh_where;  ///< nowhere if the command line names the file
};

/// Values in place of the number of a post.
inline constexpr int scene_image = -1, no_image = -2, motion_image = -3;
/// The names by which posts refer to the rendered image, and to how far things have moved since the frame before.
inline constexpr std::string_view scene_image_name = "scene", motion_image_name = graph::motion_image_name;
inline constexpr size_t max_posts = 64;

/// An image that a post reads: its name in the post's document ("color" is the image that it processes), and its source:
/// the number of an earlier post of the scene, scene_image or motion_image.
struct PostInput {
  std::string image;
  int source = scene_image;
  support::Span image_where, source_where;
};

/// A full-screen effect over the finished image. Without an input "color" it processes the image of the post before.
struct Post {
  std::string name;
  std::string effect;  ///< path of the post's document
  std::vector<Parameter> parameters;
  std::vector<PostInput> inputs;
  float size = 1;  ///< of its image, as a fraction of the scene's; rounded up to pixels
  support::Span name_where, effect_where, size_where;
};

struct Output {
  Encoding encoding = Encoding::srgb;
  float exposure = 1;  ///< factor of colours before the encoding
};

/// The order in which what is blended is drawn.
enum class Sort : uint8_t {
  none,          ///< that of the scene
  back_to_front  ///< by the distance along the view of the middle of each copy's bounds
};
inline constexpr std::string_view sort_names[] = {"none", "back_to_front"};

/// How a value moves from one key of an animation to the next.
enum class Ease : uint8_t { linear, smooth, step };
inline constexpr std::string_view ease_names[] = {"linear", "smooth", "step"};
/// What an animation does after its last key.
enum class Loop : uint8_t { once, repeat, ping_pong };
inline constexpr std::string_view loop_names[] = {"once", "repeat", "ping_pong"};

inline constexpr float default_frames_per_second = 24;
inline constexpr std::array<int, 2> default_size{640, 360};
inline constexpr std::array<float, 4> default_background{0, 0, 0, 1};

/// A parameter of an object or a post that has other values at other times.
struct AnimatedParameter {
  std::string owner, parameter;
  bool operator==(const AnimatedParameter&) const = default;
};

struct Scene {
  std::string name;
  support::Source source;
  int width = default_size[0];
  int height = default_size[1];
  int samples = 1;              ///< per pixel: 1, 4 or 16
  support::Span samples_where;  ///< nowhere if the document does not state it
  float time = 0;               ///< the value of the node `time`, in seconds
  float frames_per_second = default_frames_per_second;
  Camera camera;
  std::vector<Light> lights;
  std::optional<Environment> environment;
  std::array<float, 4> background = default_background;  ///< linear RGBA
  std::vector<Object> objects;
  Sort sort = Sort::none;   ///< of what is blended
  std::vector<Post> posts;  ///< in the order in which they run
  Output output;
  std::vector<AnimatedParameter> animated;
  /// The scene at the frame before, with the same objects, if that is another one than this scene at another `time`.
  std::shared_ptr<Scene> before;
};

/// The scene of a document in the format of format.def. Reports everything that is wrong with it. What the document
/// extends is already merged into it (load.h).
std::optional<Scene> parse_scene(const graph::Document& document, support::Diagnostics& diagnostics);

/// One copy of an object: its position along each axis of the grid.
struct Instance {
  std::array<int64_t, 3> place{0, 0, 0};
};

/// The number of copies: the product of the counts.
int64_t instance_count(const Object& object);
/// The copies in drawing order; the first axis varies fastest.
Instance instance(const Object& object, int64_t index);
/// "balls[3,2]" for a copy in a grid, otherwise the object's name.
std::string instance_name(const Object& object, const Instance& instance);
/// The translation of a copy: the object's, plus the steps to the copy.
glm::vec3 instance_translation(const Object& object, const Instance& instance);
/// The value at a position along an axis: exactly the first at 0, exactly the last at the end, never outside of them.
graph::Literal variation_value(const Variation& variation, int64_t place, int64_t count);

}  // namespace isoshade::scene
