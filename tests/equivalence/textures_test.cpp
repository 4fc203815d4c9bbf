// SPDX-License-Identifier: Apache-2.0
// Textures of bytes and of floats: the same bits on every backend, and as each other where they hold the same numbers.
#include <random>

#include "backends/cpu/lane_count.h"
#include "runtime/scene/image_file.h"
#include "tests/equivalence/scenes.h"
#include "tests/unit/gltf_files.h"

namespace isoshade::equivalence {
namespace {

/// A tilted square that shows one noisy picture by two files: p.png has bytes, p.exr their floats.
class TextureFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    constexpr int width = 37, height = 23;
    std::vector<uint8_t> bytes(4 * width * height);
    std::mt19937 random(9);
    for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random());
    const std::string png = scene::png(width, height, bytes);
    scene::FileImage picture = scene::decode_image(png).found.value_or(scene::FileImage());
    ASSERT_TRUE(picture.has_bytes());
    picture.rgba = scene::numbers_of(picture);
    picture.depth.resize(picture.bytes.size());
    folder_.write("p.png", png);
    folder_.write("p.exr", scene::exr(picture.view()));
  }

  /// An image node over the file.
  static std::string image(const std::string& file, const std::string& ports) {
    return R"({"type": "image", "texcoord": "uv", "file": ")" + file + "\", " + ports + "}";
  }
  /// Texels as they are stored, decoded from sRGB, and between four.
  static std::string texels(const std::string& file) {
    return R"("plain": )" + image(file, R"("filtertype": "closest", "colorspace": "linear")") +
           R"(, "srgb": )" + image(file, R"("filtertype": "linear", "colorspace": "srgb")") +
           R"(, "alpha": )" + image(file, R"("to": "color4")") +
           R"(, "color": {"type": "combine3", "in1": "plain.r", "in2": "srgb.g", "in3": "alpha.a", "to": "color3"})";
  }
  static std::string mips(const std::string& file) {
    return R"("color": )" + image(file, R"("filtertype": "trilinear", "colorspace": "srgb")");
  }

  /// What these nodes show.
  render::Plan plan_of(const std::string& nodes) const {
    folder_.write("shown.json", R"({"isoshade": 1, "effect": "shown", "nodes": {
      "at": {"type": "texcoord"}, "uv": {"type": "multiply", "in1": "at", "in2": 3}, )" +
                                    nodes + R"(}, "passes": [{"name": "base", "color": "color"}]})");
    return plan(folder_.write("scene.json", R"({"isoshade": 1, "scene": "s",
      "camera": {"position": [0, 1, 2], "target": [0, 0, 0]},
      "objects": {"square": {"mesh": "plane", "effect": "shown.json"}}})"),
                97, 61);
  }

  /// Draws on every backend, and expects one image.
  static backends::Image draw_everywhere(const render::Plan& plan, const std::string& what) {
    const backends::Image image = draw(plan, *interpreter::create());
    for (const char* lanes : {"1", "4", "8", "16", "8x2", "16x2"})
      if (cpu::lane_count(lanes)->available())
        expect_identical(image, draw(plan, *cpu_backend(lanes)), what + " lanes " + lanes);
#ifdef ISOSHADE_VULKAN
    expect_identical(image, draw(plan, *vulkan_backend()), what + " vulkan");
#endif
    return image;
  }

  testing::Folder folder_;
};

TEST_F(TextureFiles, ByteAndFloatTexelsAreIdentical) {
  const render::Plan bytes = plan_of(texels("p.png"));
  EXPECT_GT(bytes.frame.texel_bytes.size(), size_t{37 * 23});
  const backends::Image shown = draw_everywhere(bytes, "bytes");
  const render::Plan floats = plan_of(texels("p.exr"));
  EXPECT_EQ(floats.frame.texel_bytes.size(), 1u);
  expect_identical(shown, draw_everywhere(floats, "floats"), "bytes and floats");
}

TEST_F(TextureFiles, LayersAreIdenticalEverywhereAndThoseOfTheirFiles) {
  constexpr int width = 12, height = 7, layers = 3;
  std::vector<uint8_t> bytes(4 * width * height * layers), half(4 * (width / 2) * (height / 2) * layers);
  std::mt19937 random(4);
  for (std::vector<uint8_t>* all : {&bytes, &half})
    for (uint8_t& byte : *all) byte = static_cast<uint8_t>(random());
  folder_.write("strip.png", scene::png(width, height * layers, bytes));
  folder_.write("half.png", scene::png(width / 2, height / 2 * layers, half));
  for (int i = 0; i < layers; ++i) {
    const std::string number = std::to_string(i);
    const auto part = [&](const std::vector<uint8_t>& all) {
      return std::span(all).subspan(all.size() / layers * static_cast<size_t>(i), all.size() / layers);
    };
    folder_.write("layer" + number + ".png", scene::png(width, height, part(bytes)));
    folder_.write("half" + number + ".png", scene::png(width / 2, height / 2, part(half)));
    folder_.write("one" + number + ".json", R"({"isoshade": 1, "image": "one", "layers": [{"levels": ["layer)" + number +
                                                R"(.png", "half)" + number + R"(.png"]}]})");
  }
  folder_.write("strip.json", R"({"isoshade": 1, "image": "strip", "layers": [{"levels": ["strip.png", "half.png"], "count": 3}]})");
  folder_.write("files.json", R"({"isoshade": 1, "image": "files", "layers": [{"file": "layer0.png"}, {"file": "layer1.png"},
{"file": "layer2.png"}]})");
  // Layers that vary by pixel, also beyond both ends.
  const auto varying = [&](const std::string& file, const std::string& filter) {
    return R"("far": {"type": "multiply", "in1": "at.x", "in2": 7}, "off": {"type": "subtract", "in1": "far", "in2": 2},
"down": {"type": "floor", "in": "off"}, "layer": {"type": "convert", "in": "down", "to": "integer"},
"color": )" + image(file, R"("layer": "layer", "filtertype": ")" + filter + "\"");
  };
  for (const char* filter : {"closest", "linear", "trilinear"}) {
    draw_everywhere(plan_of(varying("strip.json", filter)), filter);
    for (int i = 0; i < layers; ++i) {
      const std::string number = std::to_string(i), ports = R"("filtertype": ")" + std::string(filter) + "\"";
      const auto shown = [&](const std::string& file, const std::string& layer) {
        return draw(plan_of(R"("color": )" + image(file, ports + layer)), *interpreter::create());
      };
      const backends::Image of_file = shown("one" + number + ".json", "");
      expect_identical(of_file, shown("strip.json", R"(, "layer": )" + number), "layer " + number + " " + filter);
      if (i == 0) expect_identical(of_file, shown("strip.json", ""), "no layer");
      if (i == 0) expect_identical(of_file, shown("strip.json", R"(, "layer": -4)"), "before the first layer");
      if (i + 1 == layers) expect_identical(of_file, shown("strip.json", R"(, "layer": 99)"), "after the last layer");
      if (std::string_view(filter) != "trilinear")
        expect_identical(of_file, shown("files.json", R"(, "layer": )" + number), "of files, " + number);
      else
        expect_identical(shown("layer" + number + ".png", ""), shown("files.json", R"(, "layer": )" + number),
                         "computed levels of files, " + number);
    }
  }
}

TEST_F(TextureFiles, ChoicesOfParametersAreThoseOfTheNode) {
  const auto shown = [&](const std::string& parameters, const std::string& u, const std::string& v,
                         const std::string& filter) {
    folder_.write("shown.json", R"({"isoshade": 1, "effect": "shown", "parameters": {)" + parameters + R"json(},
"nodes": {"at": {"type": "texcoord", "index": 1}, "uv": {"type": "expression", "code": "at * 3 - vector2(1)", "at": "at"},
"color": )json" + image("p.png", R"("default": 0.25, "uaddressmode": )" + u + R"(, "vaddressmode": )" + v +
                                 R"(, "filtertype": )" + filter) +
                                  R"(}, "passes": [{"name": "base", "color": "color"}]})");
    return plan(folder_.write("scene.json", R"({"isoshade": 1, "scene": "s",
"camera": {"position": [0, 1, 2], "target": [0, 0, 0]},
"objects": {"square": {"mesh": "plane", "effect": "shown.json"}}})"),
                61, 37);
  };
  const auto quoted = [](const char* name) { return '"' + std::string(name) + '"'; };
  const auto parameter = [&](const char* name, const char* names, const char* value) {
    return quoted(name) + R"(: {"type": "integer", "enum": [)" + names + R"(], "value": )" + quoted(value) + "}";
  };
  for (const char* u : {"periodic", "mirror", "constant"})
    for (const char* v : {"clamp", "periodic"})
      for (const char* filter : {"closest", "linear", "trilinear"}) {
        const std::string what = std::string(u) + " " + v + " " + filter;
        const backends::Image fixed = draw(shown("", quoted(u), quoted(v), quoted(filter)), *interpreter::create());
        const std::string modes = R"("periodic", "clamp", "mirror", "constant")";
        const render::Plan chosen =
            shown(parameter("u", modes.c_str(), u) + ", " + parameter("v", modes.c_str(), v) + ", " +
                      parameter("f", R"("closest", "linear", "trilinear")", filter),
                  R"({"link": "u"})", R"({"link": "v"})", R"({"link": "f"})");
        expect_identical(fixed, draw_everywhere(chosen, what), what);
      }
}

TEST_F(TextureFiles, MipLevelsAreIdenticalOnEveryBackend) {
  for (const char* file : {"p.png", "p.exr"}) draw_everywhere(plan_of(mips(file)), file);
}

}  // namespace
}  // namespace isoshade::equivalence
