// SPDX-License-Identifier: Apache-2.0
#include "tests/equivalence/pure_host.h"

#include <gtest/gtest.h>

namespace isoshade::equivalence {

using functions::traced::Float;
using functions::traced::Int;
using lower::Vec3;

namespace {

// What varies is linear, so that derivatives are exact.

constexpr const char* glsl_host = R"(
int isoshade_light_count() { return 2; }
bool isoshade_has_environment() { return true; }
float isoshade_time() { return 1.25; }
int isoshade_pass_index() { return 2; }
int isoshade_pass_count() { return 5; }
vec3 isoshade_world_from_object(int column) { return vec3(column == 0, column == 1, 2.0 * float(column == 2) + 0.5 * float(column == 3)); }
vec3 isoshade_object_from_world(int column) { return vec3(column == 0, column == 1, 0.5 * float(column == 2) + 0.5 * float(column == 3)); }
vec3 isoshade_view_from_world(int column) { return vec3(column == 1, column == 0, column >= 2); }
vec3 isoshade_world_from_view(int column) { return vec3(column == 1, column == 0, column >= 2); }
int isoshade_picture_width(int image) { return 8 + image; }
int isoshade_picture_height(int image) { return 4 + image; }
int isoshade_depth_width() { return 8; }
int isoshade_depth_height() { return 4; }
vec2 isoshade_screen_size() { return vec2(8.0, 4.0); }
vec3 isoshade_camera_position() { return vec3(0.5, 1.5, 2.5); }
vec3 isoshade_camera_direction() { return vec3(0.0, 0.0, -1.0); }
vec2 isoshade_depth_numerator() { return vec2(0.25, 0.0); }
vec2 isoshade_depth_denominator() { return vec2(0.0, 1.0); }
)";
constexpr const char* glsl_light = R"(
isoshade_Light isoshade_light(int index, vec3 position) {
  precise vec3 direction = vec3(position.y * 0.5, float(index) + 0.5, position.x);
  precise vec3 color = vec3(float(index) + 1.0, position.z * 0.5, 0.75);
  return isoshade_Light(direction, color);
}
)";
constexpr const char* glsl_light_change = R"(
isoshade_Light isoshade_light_change(int index, vec3 position, vec3 change) {
  precise vec3 direction = vec3(change.y * 0.5, 0.0, change.x);
  precise vec3 color = vec3(0.0, change.z * 0.5, 0.0);
  return isoshade_Light(direction, color);
}
)";
constexpr const char* glsl_environment = R"(
vec3 isoshade_environment(vec3 direction, float roughness) {
  precise vec3 radiance = vec3(abs(direction.x), roughness, abs(direction.z) * 0.5);
  return radiance;
}
)";
constexpr const char* glsl_irradiance = R"(
vec3 isoshade_irradiance(vec3 direction) {
  precise vec3 radiance = vec3(abs(direction.y) * 0.5, 0.25, abs(direction.x));
  return radiance;
}
)";
constexpr const char* glsl_texel = R"(
vec4 isoshade_texel(int image, int x, int y) { return vec4(float(x) * 0.125, float(y) * 0.25, float(image) * 0.5, 1.0); }
)";
constexpr const char* glsl_image_size = R"(
isoshade_ImageSize isoshade_image_size(int image) { return isoshade_ImageSize(8, 4, 2); }
)";
constexpr const char* glsl_image_layer = R"(
int isoshade_image_layer(int image, int layer) { return image + 2 * clamp(layer, 0, 3); }
)";
constexpr const char* glsl_pictures = R"(
vec4 isoshade_picture(int image, int x, int y) { return vec4(float(x) * 0.125, float(y) * 0.25, float(image) * 0.5, 1.0); }
float isoshade_depth(int x, int y) { return float(x) * 0.125; }
)";

}  // namespace

const char* const cpp_host = R"(
struct Host {
  int light_count() const { return 2; }
  bool has_environment() const { return true; }
  float time() const { return 1.25f; }
  int pass_index() const { return 2; }
  int pass_count() const { return 5; }
  vec3<float> world_from_object(int c) const { return {float(c == 0), float(c == 1), 2.0f * float(c == 2) + 0.5f * float(c == 3)}; }
  vec3<float> object_from_world(int c) const { return {float(c == 0), float(c == 1), 0.5f * float(c == 2) + 0.5f * float(c == 3)}; }
  vec3<float> view_from_world(int c) const { return {float(c == 1), float(c == 0), float(c >= 2)}; }
  vec3<float> world_from_view(int c) const { return {float(c == 1), float(c == 0), float(c >= 2)}; }
  int picture_width(int image) const { return 8 + image; }
  int picture_height(int image) const { return 4 + image; }
  int depth_width() const { return 8; }
  int depth_height() const { return 4; }
  vec2<float> screen_size() const { return {8.0f, 4.0f}; }
  vec3<float> camera_position() const { return {0.5f, 1.5f, 2.5f}; }
  vec3<float> camera_direction() const { return {0.0f, 0.0f, -1.0f}; }
  vec2<float> depth_numerator() const { return {0.25f, 0.0f}; }
  vec2<float> depth_denominator() const { return {0.0f, 1.0f}; }
  template <class F>
  isoshade::Light<F> light(int index, vec3<F> position) const {
    return {{position.y * 0.5f, F(float(index) + 0.5f), position.x}, {F(float(index) + 1.0f), position.z * 0.5f, F(0.75f)}};
  }
  template <class F>
  isoshade::Light<F> light_change(int, vec3<F>, vec3<F> change) const {
    return {{change.y * 0.5f, F(0.0f), change.x}, {F(0.0f), change.z * 0.5f, F(0.0f)}};
  }
  template <class F>
  vec3<F> environment(vec3<F> direction, F roughness) const {
    return {abs(direction.x), roughness, abs(direction.z) * 0.5f};
  }
  template <class F>
  vec3<F> irradiance(vec3<F> direction) const {
    return {abs(direction.y) * 0.5f, F(0.25f), abs(direction.x)};
  }
  template <class I>
  vec4<float_of<I>> texel(I image, I x, I y) const {
    return {to_float(x) * 0.125f, to_float(y) * 0.25f, to_float(image) * 0.5f, float_of<I>(1.0f)};
  }
  template <class I>
  isoshade::ImageSize<I> image_size(I) const { return {I(8), I(4), I(2)}; }
  template <class I>
  I image_layer(I image, I layer) const {
    const I from_0 = select(layer > I(0), layer, I(0));
    return image + I(2) * select(from_0 < I(3), from_0, I(3));
  }
  template <class I>
  vec4<float_of<I>> picture(int image, I x, I y) const { return texel(I(image), x, y); }
  template <class I>
  float_of<I> depth(I x, I) const { return to_float(x) * 0.125f; }
};

template <class F>
F lane_floats(const int* in, int stride, int word) {
  int words[lane_count<F>];
  for (int i = 0; i < lane_count<F>; ++i) words[i] = in[i * stride + word];
  return from_bits_normal(load_lanes<int_of<F>>(words));
}
template <class F>
int_of<F> lane_ints(const int* in, int stride, int word) {
  int words[lane_count<F>];
  for (int i = 0; i < lane_count<F>; ++i) words[i] = in[i * stride + word];
  return load_lanes<int_of<F>>(words);
}
template <class I>
void store_ints(int* out, I value) {
  store_lanes(out, value);
}
template <class F>
void store_words(int* out, int stride, int word, F value) {
  int words[lane_count<F>];
  store_lanes(words, bits(value));
  for (int i = 0; i < lane_count<F>; ++i) out[i * stride + word] = words[i];
}
)";

std::string glsl_host_of(const std::string& pure) {
  std::string text = glsl_host;
  const auto asks = [&](const char* what) {
    return pure.find(std::string("ISOSHADE_ASKS_") + what + "\n") != std::string::npos;
  };
  if (asks("LIGHT")) text += glsl_light;
  if (asks("LIGHT_CHANGE")) text += glsl_light_change;
  if (asks("ENVIRONMENT")) text += glsl_environment;
  if (asks("IRRADIANCE")) text += glsl_irradiance;
  if (asks("TEXEL")) text += glsl_texel;
  if (asks("IMAGE_SIZE")) text += glsl_image_size;
  if (asks("IMAGE_LAYER")) text += glsl_image_layer;
  if (asks("PICTURE") || asks("DEPTH")) text += glsl_pictures;
  return text;
}

void define_host(ir::Module& module, const std::map<std::string, interface::HostFunction>& host) {
  for (uint32_t i = 0; i < module.functions.size(); ++i) {
    if (!module.functions[i].is_declaration()) continue;
    const auto found = host.find(module.functions[i].name);
    if (found == host.end()) continue;
    const auto answer = answer_of(found->second);
    if (!answer) continue;
    lower::Kernel k(module, i);
    const auto number = [&](size_t parameter) { return to_float(k.integer(parameter)); };
    switch (answer->call) {
      case interface::HostCall::light: {
        const Vec3 at = k.vector3(1);
        k.b.finish(std::array{
            Vec3(at[1] * Float(0.5f), number(0) + Float(0.5f), at[0]).value,
            Vec3(number(0) + Float(1.0f), at[2] * Float(0.5f), Float(k.b, k.b.constant(0.75f))).value});
        break;
      }
      case interface::HostCall::environment: {
        const Vec3 at = k.vector3(0);
        k.b.finish(std::array{Vec3(abs(at[0]), Float(k.b, k.b.parameter(1)), abs(at[2]) * Float(0.5f)).value});
        break;
      }
      case interface::HostCall::irradiance: {
        const Vec3 at = k.vector3(0);
        k.b.finish(std::array{Vec3(abs(at[1]) * Float(0.5f), Float(k.b, k.b.constant(0.25f)), abs(at[0])).value});
        break;
      }
      case interface::HostCall::texel:
        k.b.finish(std::array{lower::Vec4(number(1) * Float(0.125f), number(2) * Float(0.25f),
                                          number(0) * Float(0.5f), Float(k.b, k.b.constant(1.0f)))
                                  .value});
        break;
      case interface::HostCall::image_size:
        k.b.finish(std::array{k.b.constant(8), k.b.constant(4), k.b.constant(2)});
        break;
      case interface::HostCall::image_layer: {
        const Int layer = k.integer(1), from_0 = select(layer > Int(0), layer, Int(0));
        k.b.finish(std::array{(k.integer(0) + Int(2) * select(from_0 < Int(3), from_0, Int(3))).value});
        break;
      }
      case interface::HostCall::picture:
        k.b.finish(std::array{lower::Vec4(number(0) * Float(0.125f), number(1) * Float(0.25f),
                                          Float(k.b, k.b.constant(static_cast<float>(answer->image) * 0.5f)),
                                          Float(k.b, k.b.constant(1.0f)))
                                  .value});
        break;
      case interface::HostCall::depth: k.b.finish(std::array{(number(0) * Float(0.125f)).value}); break;
      default: FAIL() << module.functions[i].name;
    }
  }
}

ir::ValueId answer(lower::Kernel& k, const interface::place::Host& asked) {
  using enum interface::HostCall;
  const auto vector = [&](std::initializer_list<float> components) {
    std::vector<ir::ValueId> values;
    for (const float component : components) values.push_back(k.b.constant(component));
    return k.b.construct(values);
  };
  const int c = asked.argument;
  const auto is = [](bool holds) { return holds ? 1.0f : 0.0f; };
  switch (asked.call) {
    case light_count: return k.b.constant(2);
    case has_environment: return k.b.constant(true);
    case time: return k.b.constant(1.25f);
    case pass_index: return k.b.constant(2);
    case pass_count: return k.b.constant(5);
    case world_from_object: return vector({is(c == 0), is(c == 1), 2.0f * is(c == 2) + 0.5f * is(c == 3)});
    case object_from_world: return vector({is(c == 0), is(c == 1), 0.5f * is(c == 2) + 0.5f * is(c == 3)});
    case view_from_world:
    case world_from_view: return vector({is(c == 1), is(c == 0), is(c >= 2)});
    case picture_width: return k.b.constant(8 + c);
    case picture_height: return k.b.constant(4 + c);
    case depth_width: return k.b.constant(8);
    case depth_height: return k.b.constant(4);
    case screen_size: return vector({8.0f, 4.0f});
    case camera_position: return vector({0.5f, 1.5f, 2.5f});
    case camera_direction: return vector({0.0f, 0.0f, -1.0f});
    case depth_numerator: return vector({0.25f, 0.0f});
    case depth_denominator: return vector({0.0f, 1.0f});
    case light:
    case light_change:
    case environment:
    case irradiance:
    case texel:
    case image_size:
    case image_layer:
    case picture:
    case depth: break;
  }
  support::bug("no parameter is this");
}

}  // namespace isoshade::equivalence
