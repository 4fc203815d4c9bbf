// SPDX-License-Identifier: Apache-2.0
// Frames of several views, without a scene: a light that sees depth alone, a camera whose picture is a texture, and a
// picture whose pixel program reads both.
#include <array>
#include <cmath>
#include <cstring>

#include "compiler/lower/surface.h"
#include "runtime/lanes/float_rules.h"
#include "runtime/render/records.h"
#include "runtime/render/samples.h"
#include "tests/equivalence/scenes.h"

namespace isoshade::equivalence {
namespace {

using driver::Program;
using lower::Float;
using lower::FrameBuffer;
using lower::Int;
using lower::Kernel;
using lower::Vec3;
using lower::Vec4;
namespace image_word = lower::image_word;
namespace view_word = lower::view_word;

constexpr float half_roof = 1, roof_height = 1.5f, half_ground = 4;
const glm::vec3 to_light(2, 10, 1);  ///< the light is infinitely far away
constexpr int light_size = 64;       ///< pixels each way of what the light sees
constexpr float light_height = 12;   ///< of that, in world units

Program vertex_program() {
  Program program;
  program.stage = driver::Stage::vertex;
  program.module = lower::frame_module();
  program.entry = lower::add_vertex_kernel(program.module);
  return program;
}

Kernel pixel_kernel(ir::Module& module) {
  return Kernel(module, "pixel",
                {lower::int_parameter("x"), lower::int_parameter("y"), lower::int_parameter("triangle"),
                 lower::uniform_int("object"), lower::uniform_int("light_count")},
                {{"color", ir::vector_type(4)}});
}

/// A module with the functions that kernels of pixels call.
Program new_pixel_program() {
  Program program;
  program.stage = driver::Stage::pixel;
  program.module = lower::frame_module();
  lower::add_depth_kernel(program.module);
  return program;
}

/// Where the surface is that a pixel shows; objects stand where their meshes do.
Vec3 position(Kernel& k) {
  const lower::Attributes attributes =
      lower::attributes_of_pixel(k, k.integer(0), k.integer(1), k.integer(2));
  return Vec3(k.b, attributes(3, lower::vertex_word::position));
}

/// Red is where the eye of the view is; the rest is 1.
Program eye_program() {
  Program program = new_pixel_program();
  Kernel k = pixel_kernel(program.module);
  const Float eye = k.load(FrameBuffer::view, k.constant(view_word::eye));
  k.b.finish(std::array{Vec4(eye, Float(1.0f), Float(1.0f), Float(1.0f)).value});
  program.entry = k.index;
  return program;
}

/// A field of the record of an image that the program reads.
Int image_field(Kernel& k, int record, int word) {
  return k.load_int(FrameBuffer::layer_records, k.constant(record * image_word::stride + word));
}

/// 4 columns of `rows` from a word of `layers` on, applied to a point.
Vec3 transformed3(Kernel& k, Int first, Vec3 p) {
  const auto column = [&](int i) { return k.load3(FrameBuffer::layers, first, 3 * i); };
  return lower::weighted<Vec3>({column(0), column(1), column(2)}, p) + column(3);
}
Vec4 transformed4(Kernel& k, Int first, Vec3 p) {
  const auto column = [&](int i) { return k.load4(FrameBuffer::layers, first, 4 * i); };
  return lower::weighted<Vec4>({column(0), column(1), column(2)}, p) + column(3);
}

Int limited(Int value, Int count) {
  const Int last = count - Int(1);
  return select(value < Int(0), Int(0), select(value < last, value, last));
}

/// Whether the light sees the point: 1 or 0. Its depth is record 1 of the images.
Float lit(Kernel& k, Vec3 p) {
  const Int camera = image_field(k, 1, image_word::camera);
  const Vec3 seen = transformed3(k, camera + Int(view_word::view), p);
  const Vec4 clip = transformed4(k, camera + Int(view_word::projection), seen);
  const Int width = image_field(k, 1, image_word::width), height = image_field(k, 1, image_word::height);
  const auto pixel = [&](Float across, Int count) {
    return limited(to_int(floor((across * Float(0.5f) + Float(0.5f)) * to_float(count))), count);
  };
  const Int x = pixel(clip[0] / clip[3], width), y = pixel(Float(0.0f) - clip[1] / clip[3], height);
  const Float depth = k.load(FrameBuffer::layers, image_field(k, 1, image_word::first) + (y * width + x));
  const Float bias(0.02f);
  return select(depth > clip[2] / clip[3] + bias, Float(0.0f), Float(1.0f));
}

/// Red and green are x and z of the position, blue is whether it is lit, plus twice its height, and alpha is the red of
/// the second view's color, which is record 4 of the images.
Program shadowed_program() {
  Program program = new_pixel_program();
  Kernel k = pixel_kernel(program.module);
  const Vec3 p = position(k);
  const Int width = image_field(k, 4, image_word::width), height = image_field(k, 4, image_word::height);
  const Int pixel = limited(k.integer(1), height) * width + limited(k.integer(0), width);
  const Float mirror = k.load(FrameBuffer::layers, image_field(k, 4, image_word::first) + pixel * Int(4));
  k.b.finish(std::array{Vec4(p[0], p[2], lit(k, p) + p[1] * Float(2.0f), mirror).value});
  program.entry = k.index;
  return program;
}

constexpr int mirror_width = 40, mirror_height = 30;
constexpr float mirror_background = 0.125f;

/// A roof over a ground, seen by three views.
struct RoofFrame {
  Program vertex = vertex_program(), eye = eye_program(), shadowed = shadowed_program();
  std::vector<uint32_t> indices{0, 1, 2, 0, 2, 3};
  render::Plan plan;
  scene::Camera mirror_camera;

  explicit RoofFrame(int samples) {
    const lanes::FpGuard guard;
    plan.samples = samples;
    const int side = render::samples_each_way(samples);
    backends::Frame& frame = plan.frame;
    frame.programs = {&vertex, &eye, &shadowed};
    frame.frame.resize(lower::frame_word::count);
    add_square(half_ground, 0);
    add_square(half_roof, roof_height);

    scene::Camera light;
    light.projection = scene::Projection::orthographic;
    light.position = to_light;
    light.target = glm::vec3(0);
    light.height = light_height;
    light.far = 30;
    add_view(light, light_size, light_size, {"the light", light_size, light_size, false}, {}, 1);
    mirror_camera.position = {-3, 4, 6};
    mirror_camera.target = glm::vec3(0);
    add_view(mirror_camera, mirror_width, mirror_height, {"the mirror", mirror_width, mirror_height}, {}, 1);
    frame.views.back().background[0] = mirror_background;
    scene::Camera camera;
    camera.position = {3, 5, 7};
    camera.target = glm::vec3(0);
    add_view(camera, 96, 64, {"the picture", 96 * side, 64 * side}, {0, 1}, 2);
  }
  RoofFrame(const RoofFrame&) = delete;
  RoofFrame& operator=(const RoofFrame&) = delete;

 private:
  void add_square(float half, float height) {
    for (const auto& [x, z] : {std::pair{-1, 1}, {1, 1}, {1, -1}, {-1, -1}}) {
      std::array<float, lower::vertex_word::stride> vertex{};
      vertex[lower::vertex_word::position] = half * static_cast<float>(x);
      vertex[lower::vertex_word::position + 1] = height;
      vertex[lower::vertex_word::position + 2] = half * static_cast<float>(z);
      plan.frame.vertices.insert(plan.frame.vertices.end(), vertex.begin(), vertex.end());
    }
  }
  void add_view(const scene::Camera& camera, int width, int height, backends::Target target,
                std::vector<size_t> reads, uint32_t pixel_program) {
    const scene::View seen = scene::make_view(camera, width, height);
    backends::View view;
    view.target = std::move(target);
    view.words = render::view_words(camera, seen, width, height);
    view.reads = std::move(reads);
    for (const uint32_t first_vertex : {0u, 4u}) {
      backends::Draw draw;
      draw.pixel_program = pixel_program;
      draw.object = static_cast<int>(plan.frame.objects.size());
      render::append_object({glm::mat4(1), glm::mat4(1), glm::mat3(1)}, pixel_program, {}, {},
                            plan.frame.objects);
      draw.projected = render::append_matrix(seen.projection, view.words);
      draw.first_vertex = first_vertex;
      draw.vertex_count = 4;
      draw.indices = indices;
      view.draws.push_back(draw);
    }
    plan.frame.views.push_back(std::move(view));
  }
};

struct Named {
  std::string name;
  std::unique_ptr<backends::Backend> backend;
};

/// Every backend but the interpreter.
std::vector<Named> compiled_backends() {
  std::vector<Named> all;
  all.push_back({"cpu, 1 lane", cpu_backend("1")});
  all.push_back({"cpu, many lanes", cpu_backend(cpu::lane_count("16")->available() ? "16" : "")});
#ifdef ISOSHADE_VULKAN
  all.push_back({"vulkan", vulkan_backend(driver::Division::native)});
  all.push_back({"vulkan, exact division", vulkan_backend(driver::Division::exact)});
#endif
  return all;
}

TEST(Views, ReadTheTargetsOfEarlierViewsAlikeOnEveryBackend) {
  const std::vector<Named> others = compiled_backends();
  for (const int samples : {1, 4}) {
    const RoofFrame test(samples);
    const backends::Image expected = draw(test.plan, *interpreter::create());
    for (const Named& other : others)
      expect_identical(expected, draw(test.plan, *other.backend),
                       other.name + ", " + std::to_string(samples));
  }
}

TEST(Views, SeeShadowsByTheDepthAloneThatALightSees) {
  const RoofFrame test(1);
  const backends::Image image = draw(test.plan, *interpreter::create());
  const float slope_x = to_light.x / to_light.y, slope_z = to_light.z / to_light.y;
  const float margin = 2 * light_height / light_size;
  int lit = 0, dark = 0, of_mirror = 0;
  for (size_t i = 0; i < image.depth.size(); ++i) {
    if (image.depth[i] == 0) continue;
    const float* const color = &image.rgba[4 * i];
    of_mirror += color[3] == test.mirror_camera.position.x;
    EXPECT_TRUE(color[3] == test.mirror_camera.position.x || color[3] == mirror_background) << color[3];
    const bool is_ground = color[2] < 2;
    if (!is_ground) {
      // It is lit: blue is 1 and twice its height, which interpolation rounds.
      EXPECT_GT(color[2], 2 * roof_height + 0.5f) << i;
      EXPECT_LT(color[2], 2 * roof_height + 1.5f) << i;
      continue;
    }
    // How far inside of the roof's edge the ray to the light passes.
    const float inside = half_roof - std::max(std::abs(color[0] + roof_height * slope_x),
                                              std::abs(color[1] + roof_height * slope_z));
    if (std::abs(inside) < margin) continue;
    EXPECT_EQ(color[2], inside > 0 ? 0.0f : 1.0f) << color[0] << " " << color[1];
    (inside > 0 ? dark : lit) += 1;
  }
  EXPECT_GT(lit, 500);
  EXPECT_GT(dark, 20);
  EXPECT_GT(of_mirror, 100);
}

TEST(Views, OfDepthAloneRunNoPixelProgramAndHoldNoColor) {
  RoofFrame test(1);
  backends::Frame& frame = test.plan.frame;
  std::ranges::fill(std::span(frame.programs).subspan(1), nullptr);
  frame.views.resize(1);
  std::vector<Named> backends = compiled_backends();
  backends.push_back({"interpreter", interpreter::create()});
  std::vector<float> depth;
  for (const Named& tested : backends) {
    const backends::Image image = [&] {
      support::Diagnostics diagnostics;
      backends::Image drawn;
      render::DrawStats stats;
      EXPECT_TRUE(render::render(test.plan, *tested.backend, drawn, stats, diagnostics))
          << diagnostics.text();
      return drawn;
    }();
    EXPECT_TRUE(image.rgba.empty()) << tested.name;
    ASSERT_EQ(image.depth.size(), size_t{light_size * light_size}) << tested.name;
    if (depth.empty()) depth = image.depth;
    EXPECT_EQ(std::memcmp(depth.data(), image.depth.data(), depth.size() * sizeof(float)), 0) << tested.name;
  }
  const auto covered = std::ranges::count_if(depth, [](float d) { return d > 0; });
  EXPECT_GT(covered, 500);
  EXPECT_LT(covered, light_size * light_size);
}

}  // namespace
}  // namespace isoshade::equivalence
