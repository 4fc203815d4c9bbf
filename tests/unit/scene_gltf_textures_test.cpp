// SPDX-License-Identifier: Apache-2.0
// The images of materials of glTF files, and what is said of those that are none.
#include <array>
#include <gtest/gtest.h>
#include <utility>
#include <vector>

#include "runtime/scene/mesh_formats.h"
#include "tests/unit/gltf_files.h"

namespace isoshade {
namespace {

class GltfTextures : public ::testing::Test {
 protected:
  std::optional<scene::Model> load(const std::string& bytes, const std::string& name = "m.glb") {
    diagnostics_ = support::Diagnostics();
    return scene::load_gltf(folder_.write(name, bytes), {}, diagnostics_);
  }

  static std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
  }

  /// The square in a file of text, with this for its image.
  static std::string gltf(const std::string& image, const std::string& texture = R"({"source": 0})",
                          const std::string& reference = R"("baseColorTexture": {"index": 0})") {
    std::string json =
        testing::square_json(testing::all_attributes, testing::one_node, R"("uri": "m.bin", )");
    return replaced(json, R"("roughnessFactor": 0.5}})",
                    R"("roughnessFactor": 0.5, )" + reference + R"(}}], "textures": [)" + texture +
                        R"(], "images": [)" + image);
  }

  bool refuses(const std::string& json, const std::string& message) {
    folder_.write("in/m.bin", testing::square_data());
    if (load(json, "in/m.gltf")) return false;
    EXPECT_NE(diagnostics_.text().find(message), std::string::npos) << diagnostics_.text();
    return diagnostics_.text().find(message) != std::string::npos;
  }

  testing::Folder folder_;
  support::Diagnostics diagnostics_;
};

TEST_F(GltfTextures, KeepTheirEncodedBytes) {
  const auto model = load(testing::textured_glb("no image"));
  ASSERT_TRUE(model && model->parts.at(0).material) << diagnostics_.text();
  const auto& textures = model->parts[0].material->textures;
  ASSERT_TRUE(textures.contains("base_color_texture"));
  EXPECT_EQ(*textures.at("base_color_texture").bytes, "no image");
}

TEST_F(GltfTextures, BaseColourAndEmissionAreSrgb) {
  folder_.write("m.bin", testing::square_data());
  folder_.write("a.png", "no image");
  const auto model = load(gltf(R"({"uri": "a.png"})", R"({"source": 0})",
                               R"("baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 0}},
"emissiveTexture": {"index": 0}, "normalTexture": {"index": 0}, "occlusionTexture": {"index": 0}, "extras": {)"),
                          "m.gltf");
  ASSERT_TRUE(model && model->parts.at(0).material) << diagnostics_.text();
  const auto& textures = model->parts[0].material->textures;
  ASSERT_EQ(textures.size(), 5u);
  for (const auto& [name, image] : textures)
    EXPECT_EQ(image.srgb, name == "base_color_texture" || name == "emissive_texture") << name;
}

TEST_F(GltfTextures, AreReadFromFilesBelowTheFolder) {
  folder_.write("m.bin", testing::square_data());
  const std::string file = folder_.write("maps/a b+c.png", "no image");
  const auto model = load(gltf(R"({"uri": "maps/a%20b+c.png"})"), "m.gltf");
  ASSERT_TRUE(model && model->parts.at(0).material) << diagnostics_.text();
  const scene::MaterialImage& image = model->parts[0].material->textures.at("base_color_texture");
  EXPECT_EQ(image.name, file);
  EXPECT_EQ(*image.bytes, "no image");
}

TEST_F(GltfTextures, UnreadableImagesAreReportedWithTheReason) {
  EXPECT_TRUE(refuses(gltf(R"({"uri": "no%20such.png"})"),
                      "error[missing-file]: cannot read the image \"no such.png\" of \""));
  EXPECT_TRUE(refuses(gltf(R"({"uri": "no.png"})"), "No such file"));
  folder_.write("out.png", "no image");
  for (const char* uri : {"../out.png", "%2e%2e/out.png", "/etc/passwd"}) {
    EXPECT_TRUE(refuses(gltf(R"({"uri": ")" + std::string(uri) + "\"}"),
                        "it lies outside of the folder of the glTF"));
    EXPECT_NE(diagnostics_.text().find("error[outside-reference]"), std::string::npos);
  }
  EXPECT_TRUE(refuses(gltf(R"({"uri": "."})"), "cannot read the image \".\" of"));
}

TEST_F(GltfTextures, UnusedImagesMayBeMissing) {
  folder_.write("m.bin", testing::square_data());
  EXPECT_TRUE(load(gltf(R"({"uri": "no.png"}, {"uri": "../no.png"})", R"({"source": 0})", R"("extras": 1)"),
                   "m.gltf"))
      << diagnostics_.text();
}

TEST_F(GltfTextures, ImagesBeyondTheirBufferAreRefused) {
  const std::string glb =
      replaced(testing::textured_glb("no image"), "\"byteOffset\": 156", "\"byteOffset\": 165");
  EXPECT_FALSE(load(glb));
  EXPECT_NE(diagnostics_.text().find("error[bad-image]: cannot read the image 0 of"), std::string::npos)
      << diagnostics_.text();
}

TEST_F(GltfTextures, TexturesWithoutAnImageAreRefused) {
  const std::string image = R"({"uri": "m.bin"})", texture = R"({"source": 0})";
  EXPECT_TRUE(refuses(gltf(image, R"({"source": 1})"), "error[bad-image]: cannot read the texture 0 of"));
  EXPECT_TRUE(refuses(gltf(image, R"({"source": 1})"), "the image 1 does not exist"));
  EXPECT_TRUE(refuses(gltf(image, "{}"), "it has no image"));
  EXPECT_TRUE(
      refuses(gltf(image, texture, R"("baseColorTexture": {"index": 1})"), "cannot read the texture 1 of"));
  EXPECT_TRUE(refuses(gltf(image, texture, R"("baseColorTexture": {})"), "/baseColorTexture has no index"));
}

TEST_F(GltfTextures, ImagesWithoutASourceAreRefused) {
  const std::string image = "error[bad-image]: cannot read the image 0 of ";
  for (const char* nowhere :
       {"{}", R"({"uri": 5})", R"({"uri": ""})", R"({"uri": "data:image/png;base64,@@@@"})",
        R"({"uri": "a.png", "bufferView": 0})"})
    EXPECT_TRUE(refuses(gltf(nowhere), image)) << nowhere;
}

TEST_F(GltfTextures, IndicesThatAreNotIntegersAreRefused) {
  const std::string image = R"({"uri": "m.bin"})", none = ", not an integer from 0 to 2147483647";
  for (const std::string bad : {"-1", "1e18", "1000000000000000000", "4294967296", "0.5"}) {
    const std::string index = R"({"index": )" + bad + "}", message = " is " + bad + none;
    for (const char* key : {"baseColorTexture", "metallicRoughnessTexture"}) {
      const std::string reference = "\"" + std::string(key) + "\": ";
      EXPECT_TRUE(refuses(gltf(image, R"({"source": 0})", reference + index), message)) << key;
    }
    for (const char* key : {"normalTexture", "occlusionTexture", "emissiveTexture"}) {
      const std::string reference =
          "\"extras\": 1}, \"" + std::string(key) + "\": " + index + ", \"extras\": {";
      EXPECT_TRUE(refuses(gltf(image, R"({"source": 0})", reference), message)) << key;
    }
    EXPECT_TRUE(refuses(gltf(image, R"({"source": )" + bad + "}"), "/textures/0/source" + message));
    EXPECT_TRUE(refuses(gltf(R"({"bufferView": )" + bad + "}"), "/images/0/bufferView" + message));
  }
}

/// What a material of the square says of its parameters.
class GltfMaterials : public GltfTextures {
 protected:
  scene::Material material(const std::string& texture, const std::string& reference, const std::string& more = "") {
    folder_.write("m.bin", testing::square_data());
    folder_.write("a.png", "no image");
    std::string json = gltf(R"({"uri": "a.png"})", texture, reference);
    if (!more.empty()) json = replaced(json, R"("scene": 0)", more + R"(, "scene": 0)");
    const auto model = load(json, "m.gltf");
    EXPECT_TRUE(model && model->parts.at(0).material) << diagnostics_.text();
    EXPECT_EQ(diagnostics_.text(), "");
    return model && model->parts.at(0).material ? *model->parts[0].material : scene::Material();
  }
  scene::Material of_sampler(const std::string& sampler) {
    return material(R"({"source": 0, "sampler": 0})", R"("baseColorTexture": {"index": 0})",
                    R"("samplers": [)" + sampler + "]");
  }
  scene::Material transformed(const std::string& transform) {
    return material(R"({"source": 0})", R"("baseColorTexture": {"index": 0, "texCoord": 1, "extensions": {
"KHR_texture_transform": )" + transform + "}}");
  }
};

TEST_F(GltfMaterials, TexturesWithoutATransformAreReadAtTheTextureCoordinates) {
  const scene::Material made = material(R"({"source": 0})", R"("baseColorTexture": {"index": 0, "texCoord": 1})");
  EXPECT_EQ(made.values.at("base_color_texture_set"), std::vector{1.0f});
  EXPECT_EQ(made.values.at("base_color_texture_u"), (std::vector<float>{1, 0, 0}));
  EXPECT_EQ(made.values.at("base_color_texture_v"), (std::vector<float>{0, 1, 0}));
  EXPECT_EQ(made.values.count("normal_texture_u"), 0u);
}

TEST_F(GltfMaterials, TransformsScaleThenTurnThenMove) {
  using Row = std::vector<float>;
  const scene::Material moved = transformed(R"({"offset": [0.5, 0.25], "scale": [2, 3]})");
  EXPECT_EQ(moved.values.at("base_color_texture_u"), (Row{2, 0, 0.5f}));
  EXPECT_EQ(moved.values.at("base_color_texture_v"), (Row{0, 3, 0.25f}));
  EXPECT_EQ(moved.values.at("base_color_texture_set"), Row{1});
  // A quarter turn against the clock takes u, to the right, to -v, up.
  const scene::Material turned =
      transformed(R"({"offset": [1, 0], "rotation": 1.5707963267948966, "scale": [2, 3], "texCoord": 0})");
  const Row u = turned.values.at("base_color_texture_u"), v = turned.values.at("base_color_texture_v");
  for (const auto& [row, expected] : {std::pair{u, Row{0, 3, 1}}, {v, Row{-2, 0, 0}}})
    for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(row.at(i), expected[i], 1e-6) << i;
  EXPECT_EQ(turned.values.at("base_color_texture_set"), Row{0});
}

TEST_F(GltfMaterials, SamplersChooseTheWrapModeOfEachAxis) {
  const auto modes = [](const scene::Material& made) {
    return std::string(made.names.at("base_color_texture_wrap_u")) + " " +
           std::string(made.names.at("base_color_texture_wrap_v"));
  };
  EXPECT_EQ(modes(of_sampler("{}")), "periodic periodic");
  EXPECT_EQ(modes(of_sampler(R"({"wrapS": 33071, "wrapT": 33648})")), "clamp mirror");
  EXPECT_EQ(modes(of_sampler(R"({"wrapT": 10497, "wrapS": 33648})")), "mirror periodic");
  EXPECT_EQ(modes(material(R"({"source": 0})", R"("baseColorTexture": {"index": 0})")), "periodic periodic");
}

TEST_F(GltfMaterials, SamplersChooseTheNearestFilter) {
  struct Case {
    const char* sampler;
    const char* filter;
  };
  const Case cases[] = {
      {"{}", "trilinear"},
      {R"({"magFilter": 9728, "minFilter": 9987})", "closest"},
      {R"({"magFilter": 9728})", "closest"},
      {R"({"minFilter": 9728})", "closest"},
      {R"({"magFilter": 9729})", "trilinear"},
      {R"({"minFilter": 9729})", "linear"},
      {R"({"magFilter": 9729, "minFilter": 9728})", "linear"},
      {R"({"magFilter": 9729, "minFilter": 9729})", "linear"},
      {R"({"magFilter": 9729, "minFilter": 9985})", "trilinear"},
      {R"({"minFilter": 9984})", "trilinear"},
      {R"({"magFilter": 9729, "minFilter": 9987})", "trilinear"},
  };
  for (const Case& test : cases)
    EXPECT_EQ(of_sampler(test.sampler).names.at("base_color_texture_filter"), test.filter) << test.sampler;
}

TEST_F(GltfMaterials, EmissiveStrengthMultipliesTheFactor) {
  const std::string emissive = R"("baseColorTexture": {"index": 0}}, "emissiveFactor": [0.5, 1, 0])";
  const auto color = [&](const std::string& extension) {
    return material(R"({"source": 0})", emissive + extension + R"(, "extras": {)").emissive_color;
  };
  EXPECT_EQ(color(""), (std::array<float, 3>{0.5f, 1, 0}));
  EXPECT_EQ(color(R"(, "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 5}})"),
            (std::array<float, 3>{2.5f, 5, 0}));
  EXPECT_EQ(color(R"(, "extensions": {"KHR_materials_emissive_strength": {}})"), (std::array<float, 3>{0.5f, 1, 0}));
}

TEST_F(GltfMaterials, UnlitIsAValueOfItsOwn) {
  const auto values = [&](const std::string& extensions) {
    return material(R"({"source": 0})", R"("baseColorTexture": {"index": 0}}, "extensions": {)" + extensions + R"(}, "extras": {)")
        .values;
  };
  EXPECT_EQ(values(R"("KHR_materials_unlit": {})").at("unlit"), std::vector{1.0f});
  EXPECT_EQ(values("").count("unlit"), 0u);
}

TEST_F(GltfMaterials, ExtensionsWithWrongValuesAreRefused) {
  const auto refused = [&](const std::string& transform, const std::string& message) {
    return refuses(gltf(R"({"uri": "a.png"})", R"({"source": 0})",
                        R"("baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": )" + transform +
                            "}}"),
                   message);
  };
  EXPECT_TRUE(refused(R"({"offset": [1]})", "is not an array of two numbers"));
  EXPECT_TRUE(refused(R"({"scale": 2})", "is not an array of two numbers"));
  EXPECT_TRUE(refused(R"({"scale": [1, "2"]})", "is not a number from -1e6 to 1e6"));
  EXPECT_TRUE(refused(R"({"rotation": 1e7})", "is not a number from -1e6 to 1e6"));
  EXPECT_TRUE(refused(R"({"texCoord": -1})", "not an integer from 0"));
  EXPECT_TRUE(refuses(gltf(R"({"uri": "a.png"})", R"({"source": 0, "sampler": 3})"),
                      "the sampler 3 does not exist"));
  EXPECT_TRUE(refuses(replaced(gltf(R"({"uri": "a.png"})"), R"("scene": 0)",
                               R"("samplers": [{"wrapS": "clamp"}], "scene": 0)"),
                      "not an integer from 0"));
}

}  // namespace
}  // namespace isoshade
