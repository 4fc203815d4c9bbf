// SPDX-License-Identifier: Apache-2.0
//
// What a pure shader, NAME.h as `isoshade compile` writes it, asks of the program that it is linked into. The
// program passes a host, an object of a class of its own:
//
//   template <class F, class Host>
//   vec4<F> shade(const Host& host, const Surface<F>& surface, const Parameters& parameters);
//
// A host has the const members that its shaders ask for, and needs no others; the shader's `requires` names them.
// Each is a concept below, gives::NAME<Host, F>, which says what it means; in GLSL it is a function isoshade_NAME.
// F is the number type: float, or Float<W, R> for W * R points at once. int_of<F> is its int. A host for several
// F writes members as templates:
//
//   struct Host {
//     int light_count() const { return 1; }
//     template <class F>
//     isoshade::Light<F> light(int index, isoshade::lanes::vec3<F> position) const;
//     template <class Ints>
//     isoshade::lanes::vec4<isoshade::lanes::float_of<Ints>> texel(Ints image, Ints x, Ints y) const;
//   };
//
// What holds for lanes (lanes.h) holds for shaders and hosts: no float that a member returns or a struct holds is
// a denormal, and an FpGuard is alive on the thread.
#ifndef ISOSHADE_LANES_HOST_H
#define ISOSHADE_LANES_HOST_H

#include "vec.h"

namespace isoshade {

/// What arrives at a position from a light.
template <class F>
struct Light {
  lanes::vec3<F> direction;  ///< towards the light, of length 1
  lanes::vec3<F> color;      ///< radiance
};

/// The size of an image in texels.
template <class Ints>
struct ImageSize {
  Ints width;
  Ints height;
  Ints smaller;  ///< how many smaller mip levels it has: the images image + 1, image + 2, ...
};
template <class F>
using ImageSizeOf = ImageSize<lanes::int_of<F>>;

/// A value that may be returned where Wanted is the type of the result.
template <class Value, class Wanted>
concept ConvertsTo = requires(Value (&value)(), void (&take)(Wanted)) {
  take(value());
};

/// One concept a member. All take the host and the number type, also where the member does not depend on it.
namespace gives {

using lanes::int_of;
using lanes::vec2;
using lanes::vec3;
using lanes::vec4;

/// How many lights there are.
template <class Host, class F>
concept light_count = requires(const Host& host) {
  { host.light_count() } -> ConvertsTo<int>;
};

/// What arrives from light `index`, 0 <= index < light_count(), at a position in world space.
template <class Host, class F>
concept light = requires(const Host& host, int index, vec3<F> position) {
  { host.light(index, position) } -> ConvertsTo<Light<F>>;
};

/// How direction and color of a light change, to first order, when the position changes by `change`: zeros for a
/// light that is infinitely far away. Asked for only by effects that take derivatives of what a light gives.
template <class Host, class F>
concept light_change = requires(const Host& host, int index, vec3<F> position, vec3<F> change) {
  { host.light_change(index, position, change) } -> ConvertsTo<Light<F>>;
};

// Numbers of images, and x and y, are within range at the points that need the result. Lanes that take no part in
// a branch may pass any others: clamp them, as load() of lanes does.

/// A texel, linear: red, green, blue, alpha. 0 <= x < width, 0 <= y < height, y down. `image` is the number that
/// the parameters give the image, or a mip level of it, one of the numbers after it.
template <class Host, class F>
concept texel = requires(const Host& host, int_of<F> image, int_of<F> x, int_of<F> y) {
  { host.texel(image, x, y) } -> ConvertsTo<vec4<F>>;
};

/// The size of an image, numbered as for `texel`.
template <class Host, class F>
concept image_size = requires(const Host& host, int_of<F> image) {
  { host.image_size(image) } -> ConvertsTo<ImageSize<int_of<F>>>;
};

/// The number of the image that is a layer of another, by the order of layers: the first for those below 0, the last for
/// those above. Asked for only by shaders that read layers.
template <class Host, class F>
concept image_layer = requires(const Host& host, int_of<F> image, int_of<F> layer) {
  { host.image_layer(image, layer) } -> ConvertsTo<int_of<F>>;
};

/// Whether there is an environment: light from all directions, far away.
template <class Host, class F>
concept has_environment = requires(const Host& host) {
  { host.has_environment() } -> ConvertsTo<bool>;
};

/// The radiance that arrives from a direction in world space of any length, averaged over the lobe that a surface of this
/// roughness (alpha of GGX) reflects. Asked for where there is an environment.
template <class Host, class F>
concept environment = requires(const Host& host, vec3<F> direction, F roughness) {
  { host.environment(direction, roughness) } -> ConvertsTo<vec3<F>>;
};

/// The irradiance of a surface that faces a direction in world space of any length, divided by pi. Asked for where there
/// is an environment.
template <class Host, class F>
concept irradiance = requires(const Host& host, vec3<F> direction) {
  { host.irradiance(direction) } -> ConvertsTo<vec3<F>>;
};

/// Seconds.
template <class Host, class F>
concept time = requires(const Host& host) {
  { host.time() } -> ConvertsTo<float>;
};

/// Which repetition of the pass is drawn, from 0; 0 if the pass is not repeated.
template <class Host, class F>
concept pass_index = requires(const Host& host) {
  { host.pass_index() } -> ConvertsTo<int>;
};
/// How many repetitions the pass has; 1 if it is not repeated.
template <class Host, class F>
concept pass_count = requires(const Host& host) {
  { host.pass_count() } -> ConvertsTo<int>;
};

// Columns of matrices between spaces: 0 to 2 are for vectors, 3 is the translation.

/// Of the matrix from object to world space.
template <class Host, class F>
concept world_from_object = requires(const Host& host, int column) {
  { host.world_from_object(column) } -> ConvertsTo<vec3<float>>;
};
/// Of the matrix from world to object space.
template <class Host, class F>
concept object_from_world = requires(const Host& host, int column) {
  { host.object_from_world(column) } -> ConvertsTo<vec3<float>>;
};
/// Of the matrix from world to view space.
template <class Host, class F>
concept view_from_world = requires(const Host& host, int column) {
  { host.view_from_world(column) } -> ConvertsTo<vec3<float>>;
};
/// Of the matrix from view to world space.
template <class Host, class F>
concept world_from_view = requires(const Host& host, int column) {
  { host.world_from_view(column) } -> ConvertsTo<vec3<float>>;
};

// Posts. Pictures are images of the size of the screen or of their own, made before: 0 is what the post goes
// over, 1, 2, ... are those that it lists.

/// A pixel of a picture. 0 <= x < width, 0 <= y < height, y down.
template <class Host, class F>
concept picture = requires(const Host& host, int image, int_of<F> x, int_of<F> y) {
  { host.picture(image, x, y) } -> ConvertsTo<vec4<F>>;
};
/// The width of a picture in pixels.
template <class Host, class F>
concept picture_width = requires(const Host& host, int image) {
  { host.picture_width(image) } -> ConvertsTo<int>;
};
/// The height of a picture in pixels.
template <class Host, class F>
concept picture_height = requires(const Host& host, int image) {
  { host.picture_height(image) } -> ConvertsTo<int>;
};

/// The depth at a pixel, reversed: 1 at the near plane, 0 where nothing was drawn.
template <class Host, class F>
concept depth = requires(const Host& host, int_of<F> x, int_of<F> y) {
  { host.depth(x, y) } -> ConvertsTo<F>;
};
/// The width of the image of depths in pixels.
template <class Host, class F>
concept depth_width = requires(const Host& host) {
  { host.depth_width() } -> ConvertsTo<int>;
};
/// The height of the image of depths in pixels.
template <class Host, class F>
concept depth_height = requires(const Host& host) {
  { host.depth_height() } -> ConvertsTo<int>;
};

/// The width and height in pixels of the image that is made.
template <class Host, class F>
concept screen_size = requires(const Host& host) {
  { host.screen_size() } -> ConvertsTo<vec2<float>>;
};
/// The position of the camera in world space.
template <class Host, class F>
concept camera_position = requires(const Host& host) {
  { host.camera_position() } -> ConvertsTo<vec3<float>>;
};
/// The unit vector along which the camera looks, in world space.
template <class Host, class F>
concept camera_direction = requires(const Host& host) {
  { host.camera_direction() } -> ConvertsTo<vec3<float>>;
};

// The distance along the view of a depth is (n.x + n.y * depth) / (d.x + d.y * depth).

/// n of the distance.
template <class Host, class F>
concept depth_numerator = requires(const Host& host) {
  { host.depth_numerator() } -> ConvertsTo<vec2<float>>;
};
/// d of the distance.
template <class Host, class F>
concept depth_denominator = requires(const Host& host) {
  { host.depth_denominator() } -> ConvertsTo<vec2<float>>;
};

}  // namespace gives

// What generated code calls: the names are those of the GLSL. One value for all points stands for as many.
namespace lanes {

template <class Host>
  requires gives::light_count<Host, float>
ISOSHADE_INLINE int isoshade_light_count(const Host& host) {
  return host.light_count();
}
template <class Host>
  requires gives::has_environment<Host, float>
ISOSHADE_INLINE bool isoshade_has_environment(const Host& host) {
  return host.has_environment();
}
template <class F, class Host>
  requires gives::environment<Host, F>
ISOSHADE_INLINE vec3<F> isoshade_environment(const Host& host, vec3<F> direction, F roughness) {
  return host.environment(direction, roughness);
}
template <class F, class Host>
  requires gives::irradiance<Host, F>
ISOSHADE_INLINE vec3<F> isoshade_irradiance(const Host& host, vec3<F> direction) {
  return host.irradiance(direction);
}
template <class Host>
  requires gives::time<Host, float>
ISOSHADE_INLINE float isoshade_time(const Host& host) {
  return host.time();
}
template <class Host>
  requires gives::pass_index<Host, float>
ISOSHADE_INLINE int isoshade_pass_index(const Host& host) {
  return host.pass_index();
}
template <class Host>
  requires gives::pass_count<Host, float>
ISOSHADE_INLINE int isoshade_pass_count(const Host& host) {
  return host.pass_count();
}
template <class Host>
  requires gives::world_from_object<Host, float>
ISOSHADE_INLINE vec3<float> isoshade_world_from_object(const Host& host, int column) {
  return host.world_from_object(column);
}
template <class Host>
  requires gives::object_from_world<Host, float>
ISOSHADE_INLINE vec3<float> isoshade_object_from_world(const Host& host, int column) {
  return host.object_from_world(column);
}
template <class Host>
  requires gives::view_from_world<Host, float>
ISOSHADE_INLINE vec3<float> isoshade_view_from_world(const Host& host, int column) {
  return host.view_from_world(column);
}
template <class Host>
  requires gives::world_from_view<Host, float>
ISOSHADE_INLINE vec3<float> isoshade_world_from_view(const Host& host, int column) {
  return host.world_from_view(column);
}
template <class Host>
  requires gives::picture_width<Host, float>
ISOSHADE_INLINE int isoshade_picture_width(const Host& host, int image) {
  return host.picture_width(image);
}
template <class Host>
  requires gives::picture_height<Host, float>
ISOSHADE_INLINE int isoshade_picture_height(const Host& host, int image) {
  return host.picture_height(image);
}
template <class Host>
  requires gives::depth_width<Host, float>
ISOSHADE_INLINE int isoshade_depth_width(const Host& host) {
  return host.depth_width();
}
template <class Host>
  requires gives::depth_height<Host, float>
ISOSHADE_INLINE int isoshade_depth_height(const Host& host) {
  return host.depth_height();
}
template <class Host>
  requires gives::screen_size<Host, float>
ISOSHADE_INLINE vec2<float> isoshade_screen_size(const Host& host) {
  return host.screen_size();
}
template <class Host>
  requires gives::camera_position<Host, float>
ISOSHADE_INLINE vec3<float> isoshade_camera_position(const Host& host) {
  return host.camera_position();
}
template <class Host>
  requires gives::camera_direction<Host, float>
ISOSHADE_INLINE vec3<float> isoshade_camera_direction(const Host& host) {
  return host.camera_direction();
}
template <class Host>
  requires gives::depth_numerator<Host, float>
ISOSHADE_INLINE vec2<float> isoshade_depth_numerator(const Host& host) {
  return host.depth_numerator();
}
template <class Host>
  requires gives::depth_denominator<Host, float>
ISOSHADE_INLINE vec2<float> isoshade_depth_denominator(const Host& host) {
  return host.depth_denominator();
}
template <class F, class Host>
  requires gives::light<Host, F>
ISOSHADE_INLINE Light<F> isoshade_light(const Host& host, int index, vec3<F> position) {
  return host.light(index, position);
}
template <class F, class Host>
  requires gives::light_change<Host, F>
ISOSHADE_INLINE Light<F> isoshade_light_change(const Host& host, int index, vec3<F> position, vec3<F> change) {
  return host.light_change(index, position, change);
}
template <class F, class Host>
  requires gives::texel<Host, F>
ISOSHADE_INLINE vec4<F> isoshade_texel(const Host& host, int_of<F> image, int_of<F> x, int_of<F> y) {
  return host.texel(image, x, y);
}
template <class F, class Host>
  requires gives::image_size<Host, F>
ISOSHADE_INLINE ImageSizeOf<F> isoshade_image_size(const Host& host, int_of<F> image) {
  return host.image_size(image);
}
template <class F, class Host>
  requires gives::image_layer<Host, F>
ISOSHADE_INLINE int_of<F> isoshade_image_layer(const Host& host, int_of<F> image, int_of<F> layer) {
  return host.image_layer(image, layer);
}
template <class F, class Host>
  requires gives::picture<Host, F>
ISOSHADE_INLINE vec4<F> isoshade_picture(const Host& host, int image, int_of<F> x, int_of<F> y) {
  return host.picture(image, x, y);
}
template <class F, class Host>
  requires gives::depth<Host, F>
ISOSHADE_INLINE F isoshade_depth(const Host& host, int_of<F> x, int_of<F> y) {
  return host.depth(x, y);
}

}  // namespace lanes

namespace shared {
/// Where GLSL hides a zero from drivers, which would fold arithmetic with it.
inline constexpr float ISO_ZERO = 0.0f;
}  // namespace shared

}  // namespace isoshade

#endif
