// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <limits>

#include "compiler/lower/frame_layout.h"
#include "runtime/scene/mesh_formats.h"
#include "tests/unit/gltf_files.h"

namespace isoshade {
namespace {

using namespace testing;
using scene::Model;
namespace word = lower::vertex_word;

class Gltf : public ::testing::Test {
 protected:
  std::optional<Model> load(const std::string& bytes, const std::string& name = "m.glb") {
    diagnostics_ = support::Diagnostics();
    return scene::load_gltf(folder_.write(name, bytes), {}, diagnostics_);
  }

  Model loaded(const std::string& json, const std::string& data = square_data()) {
    auto model = load(glb(json, data));
    EXPECT_TRUE(model) << diagnostics_.text();
    return model ? *std::move(model) : Model{};
  }

  /// Whether it is refused for this reason.
  bool refuses(const std::string& bytes, const std::string& reason, const std::string& name = "m.glb") {
    if (load(bytes, name)) return false;
    const std::string text = diagnostics_.text();
    EXPECT_NE(text.find(reason), std::string::npos) << text;
    return text.find(reason) != std::string::npos;
  }

  bool refuses_json(const std::string& from, const std::string& to, const std::string& reason) {
    std::string json = square_json();
    const size_t at = json.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    if (at != std::string::npos) json.replace(at, from.size(), to);
    return refuses(glb(json, square_data()), reason);
  }

  Folder folder_;
  support::Diagnostics diagnostics_;
};

glm::vec3 vector_at(const Model& model, size_t vertex, int at) {
  const float* v = &model.mesh.vertices[vertex * word::stride + static_cast<size_t>(at)];
  return {v[0], v[1], v[2]};
}

TEST_F(Gltf, ReadsEveryAttributeOfTheFile) {
  const Model model = loaded(square_json());
  ASSERT_EQ(model.mesh.vertices.size(), 4u * word::stride);
  EXPECT_EQ(model.mesh.indices, (std::vector<uint32_t>{0, 1, 2, 0, 2, 3}));
  EXPECT_EQ(vector_at(model, 2, word::position), glm::vec3(1, 1, 0));
  EXPECT_EQ(vector_at(model, 2, word::normal), glm::vec3(0, 0, 1));
  EXPECT_EQ(vector_at(model, 2, word::outline_normal), glm::vec3(0, 0, 1));
  EXPECT_EQ(model.mesh.vertices[2 * word::stride + word::texcoord], 1.0f);
  EXPECT_EQ(vector_at(model, 1, word::color), glm::vec3(0, 1, 0));
  EXPECT_EQ(model.mesh.vertices[3 * word::stride + word::color + 3], 0.2f);
  EXPECT_EQ(model.mesh.high, glm::vec3(1, 1, 0));
  ASSERT_EQ(model.parts.size(), 1u);
  const auto& material = model.parts[0].material;
  ASSERT_TRUE(material);
  EXPECT_EQ(material->base_color[1], 0.25f);
  EXPECT_EQ(material->metallic, 0.75f);
  EXPECT_EQ(material->roughness, 0.25f);  // what is perceptual is squared
}

TEST_F(Gltf, ReadsAlphaModesAndSides) {
  const auto material = [&](const std::string& keys) {
    std::string json = square_json();
    const std::string from = R"("materials": [{)";
    json.replace(json.find(from), from.size(), from + keys);
    return loaded(json).parts.at(0).material.value();
  };
  EXPECT_EQ(material("").alpha_cutoff, 0.0f);
  EXPECT_FALSE(material("").double_sided);
  EXPECT_EQ(material(R"("alphaMode": "OPAQUE", "alphaCutoff": 0.3, )").alpha_cutoff, 0.0f);
  EXPECT_EQ(material(R"("alphaMode": "MASK", )").alpha_cutoff, 0.5f);
  EXPECT_EQ(material(R"("alphaMode": "MASK", "alphaCutoff": 0.25, )").alpha_cutoff, 0.25f);
  EXPECT_EQ(material(R"("alphaMode": "MASK", "alphaCutoff": 1.5, )").alpha_cutoff, 1.5f);
  EXPECT_TRUE(material(R"("doubleSided": true, )").double_sided);
  EXPECT_TRUE(material(R"("alphaMode": "BLEND", )").blended);
  EXPECT_FALSE(material(R"("alphaMode": "MASK", )").blended);
}

TEST_F(Gltf, TextWithASeparateBufferGivesTheSameMesh) {
  folder_.write("a b.bin", square_data());
  const auto model = load(square_json(all_attributes, one_node, R"("uri": "a%20b.bin", )"), "m.gltf");
  ASSERT_TRUE(model) << diagnostics_.text();
  EXPECT_EQ(model->mesh.vertices, loaded(square_json()).mesh.vertices);
}

TEST_F(Gltf, ComputesRightHandedTangentsAlongU) {
  const Model model = loaded(square_json());
  for (size_t v = 0; v < 4; ++v) {
    EXPECT_EQ(vector_at(model, v, word::tangent), glm::vec3(1, 0, 0));
    EXPECT_EQ(model.mesh.vertices[v * word::stride + word::tangent + 3], 1.0f);
  }
}

TEST_F(Gltf, MeshesWithoutNormalsAreFlatShaded) {
  const Model model = loaded(square_json(R"("POSITION": 0)"));
  ASSERT_EQ(model.mesh.vertices.size(), 6u * word::stride);
  for (size_t v = 0; v < 6; ++v) {
    EXPECT_EQ(vector_at(model, v, word::normal), glm::vec3(0, 0, 1));
    EXPECT_NEAR(glm::length(vector_at(model, v, word::tangent)), 1.0f, 1e-6f);  // though it has no texture
    EXPECT_EQ(vector_at(model, v, word::color), glm::vec3(1));
  }
}

TEST_F(Gltf, AppliesTheTransformsOfNestedNodes) {
  const Model model = loaded(square_json(all_attributes, R"([
    {"children": [1], "translation": [10, 0, 0], "scale": [2, 2, 2]},
    {"mesh": 0, "rotation": [0, 0.70710678, 0, 0.70710678]}])"));
  const glm::vec3 corner = vector_at(model, 1, word::position), normal = vector_at(model, 1, word::normal);
  EXPECT_LT(glm::length(corner - glm::vec3(10, 0, -2)), 1e-5f);
  EXPECT_LT(glm::length(normal - glm::vec3(1, 0, 0)), 1e-6f);
}

TEST_F(Gltf, MirroringTransformsKeepTheOutsideOutside) {
  const Model model = loaded(square_json(all_attributes, R"([{"mesh": 0, "scale": [-1, 1, 1]}])"));
  for (size_t t = 0; t < 6; t += 3) {
    const auto point = [&](size_t i) { return vector_at(model, model.mesh.indices[t + i], word::position); };
    EXPECT_GT(glm::cross(point(1) - point(0), point(2) - point(0)).z, 0.0f);
  }
  EXPECT_EQ(vector_at(model, 0, word::normal), glm::vec3(0, 0, 1));
  EXPECT_EQ(vector_at(model, 0, word::tangent), glm::vec3(-1, 0, 0));
  EXPECT_EQ(model.mesh.vertices[word::tangent + 3], -1.0f);
}

TEST_F(Gltf, HasOnePartPerMaterialInFileOrder) {
  const Model model = loaded(materials_json());
  ASSERT_EQ(model.parts.size(), 3u);
  EXPECT_EQ(model.parts[0].material_index, 1);
  EXPECT_EQ(model.parts[0].index_count, 12u);  // the first square and the last
  EXPECT_EQ(vector_at(model, 5, word::position).x, 4);
  ASSERT_TRUE(model.parts[0].material && model.parts[2].material);
  EXPECT_EQ(model.parts[0].material->base_color[1], 1);
  EXPECT_EQ(model.parts[1].material_index, -1);
  EXPECT_FALSE(model.parts[1].material);
  EXPECT_EQ(model.parts[2].material_index, 0);
  EXPECT_EQ(model.parts[2].material->metallic, 0.75f);
  EXPECT_EQ(model.mesh.high, glm::vec3(4, 1, 0));
  EXPECT_EQ(model.mesh.indices[12], 8u);
  size_t indices = 0, vertices = 0;
  for (const scene::ModelPart& part : model.parts) {
    EXPECT_EQ(part.first_index, indices);
    EXPECT_EQ(part.first_vertex, vertices);
    indices += part.index_count;
    vertices += part.vertex_count;
  }
  EXPECT_EQ(indices, model.mesh.indices.size());
  EXPECT_EQ(vertices * word::stride, model.mesh.vertices.size());
}

TEST_F(Gltf, RejectsTooManyMaterials) {
  std::string primitives, materials;
  for (size_t i = 1; i <= scene::max_gltf_parts; ++i) {
    primitives += R"(, {"attributes": {"POSITION": 0}, "indices": 4, "material": )" + std::to_string(i) + "}";
    materials += ", {}";
  }
  std::string json = square_json();
  const auto add_behind = [&](const std::string& text, const std::string& added) {
    json.insert(json.find(text) + text.size(), added);
  };
  add_behind(R"("indices": 4, "material": 0})", primitives);
  add_behind(R"("roughnessFactor": 0.5}})", materials);
  EXPECT_TRUE(refuses(glb(json, square_data()), "more than 4096 materials"));
}

TEST_F(Gltf, ContainsNoDenormals) {
  const Model model = loaded(square_json(), square_data(1e-40f));
  EXPECT_EQ(vector_at(model, 2, word::position).x, 0.0f);
}

TEST_F(Gltf, RefusesInfinityAndNaN) {
  for (const float bad : {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()})
    EXPECT_TRUE(refuses(glb(square_json(), square_data(bad)), "infinite or NaN"));
  EXPECT_TRUE(refuses(glb(square_json(), square_data(3e9f)), "beyond 1e9"));
}

TEST_F(Gltf, RefusesAccessorsBeyondTheirBuffer) {
  EXPECT_TRUE(refuses_json(R"("count": 4, "type": "VEC3", "min")", R"("count": 13, "type": "VEC3", "min")",
                           "accessor 0 extends beyond its buffer view"));
  EXPECT_TRUE(refuses_json(R"("count": 4, "type": "VEC3", "min")",
                           R"("count": 1537228672809129302, "type": "VEC3", "min")", "not an integer"));
  EXPECT_TRUE(
      refuses_json(R"("byteOffset": 48)", R"("byteOffset": 18446744073709551615)", "not an integer"));
  EXPECT_TRUE(refuses_json(R"("byteOffset": 48)", R"("byteOffset": 2147483647)", "accessor 1"));
  EXPECT_TRUE(refuses_json(R"("byteLength": 144)", R"("byteLength": 157)", "extends beyond its buffer"));
  EXPECT_TRUE(refuses_json(R"("byteOffset": 144)", R"("byteOffset": 2147483640)", "its buffer"));
  EXPECT_TRUE(refuses_json(R"("bufferView": 1)", R"("bufferView": 2)", "bufferView"));
  EXPECT_TRUE(refuses_json(R"("POSITION": 0)", R"("POSITION": 70)", "does not exist"));
  EXPECT_TRUE(refuses_json(R"("POSITION": 0)", R"("POSITION": 4)", "wrong type"));
  EXPECT_TRUE(
      refuses_json(R"("count": 4, "type": "VEC2")", R"("count": 3, "type": "VEC2")", "3 vertices, not 4"));
  EXPECT_TRUE(refuses_json(R"("count": 6)", R"("count": 5)", "three corners"));
}

TEST_F(Gltf, RefusesOutOfRangeIndices) {
  std::string data = square_data();
  data[144] = 4;
  EXPECT_TRUE(refuses(glb(square_json(), data), "index 4 is out of range: there are 4 vertices"));
}

TEST_F(Gltf, RefusesIndicesThatAreNotIntegers) {
  const std::string none = ", not an integer from 0 to 2147483647";
  EXPECT_TRUE(refuses_json(R"("POSITION": 0)", R"("POSITION": -7)",
                           "/meshes/0/primitives/0/attributes/POSITION is -7" + none));
  // Its lowest 32 bits are 0.
  EXPECT_TRUE(
      refuses_json(R"("material": 0)", R"("material": 4294967296)", "/material is 4294967296" + none));
  EXPECT_TRUE(
      refuses_json(R"([{"mesh": 0}])", R"([{"children": [0.5]}])", "/nodes/0/children/0 is 0.5" + none));
  EXPECT_TRUE(refuses_json(R"("scene": 0)", R"("scene": "a")", "/scene is a string" + none));
  EXPECT_TRUE(refuses_json(R"("componentType": 5126)", R"("componentType": 4294972422)", none));
}

TEST_F(Gltf, RefusesQuantitiesThatAreNotNumbers) {
  EXPECT_TRUE(refuses_json(R"("metallicFactor": 0.75)", R"("metallicFactor": "0.75")",
                           "/materials/0/pbrMetallicRoughness/metallicFactor is a string, not a number"));
  EXPECT_TRUE(refuses_json(R"([0.5, 0.25, 1, 1])", R"([0.5, null, 1, 1])", "/baseColorFactor/1 is null"));
  EXPECT_TRUE(refuses_json(R"([{"mesh": 0}])", R"([{"mesh": 0, "translation": ["1", 0, 0]}])",
                           "/nodes/0/translation/0 is a string"));
  EXPECT_TRUE(refuses_json("[0.5, 0.25, 1, 1]", "[0.5, 0.25, 1]", "/baseColorFactor is an array of 3 numbers, not 4"));
  EXPECT_TRUE(refuses_json("[0.5, 0.25, 1, 1]", "1", "/baseColorFactor is a number, not an array of 4 numbers"));
  EXPECT_TRUE(refuses_json("0.75", "[0.75]", "/metallicFactor is an array, not a number"));
  EXPECT_TRUE(refuses_json(R"([{"mesh": 0}])", R"([{"mesh": 0, "scale": [1, 1]}])",
                           "/nodes/0/scale is an array of 2 numbers, not 3"));
}

TEST_F(Gltf, RefusesAlphaModesAndSidesThatAreNone) {
  const std::string material = R"("materials": [{)";
  EXPECT_TRUE(refuses_json(material, material + R"("alphaMode": "blend", )",
                           "/materials/0/alphaMode is \"blend\", not \"OPAQUE\", \"MASK\" or \"BLEND\""));
  EXPECT_TRUE(refuses_json(material, material + R"("alphaMode": 1, )", "/materials/0/alphaMode is a number, not"));
  EXPECT_TRUE(refuses_json(material, material + R"("alphaMode": "MASK", "alphaCutoff": "x", )",
                           "/materials/0/alphaCutoff is a string, not a number"));
  EXPECT_TRUE(refuses_json(material, material + R"("doubleSided": 1, )", "/doubleSided is a number, not true or false"));
}

TEST_F(Gltf, NamesBuffersWhoseDataUriCannotBeDecodedWithoutPrintingIt) {
  const std::string rest(5000, 'A');
  for (const std::string& uri : {"data:;base64," + rest, "data:application/octet-stream;base64," + rest}) {
    EXPECT_TRUE(refuses(square_json(all_attributes, one_node, R"("uri": ")" + uri + R"(", )"),
                        "cannot read the buffer 0 of ", "m.gltf"));
    EXPECT_NE(diagnostics_.text().find("its data URI cannot be decoded to 156 bytes"), std::string::npos);
    EXPECT_LT(diagnostics_.text().size(), 500u);
  }
}

TEST_F(Gltf, RejectsOtherVersions) {
  EXPECT_TRUE(refuses_json(R"({"version": "2.0"})", R"({"version": "1.0"})", "of version \"1.0\", not 2"));
  EXPECT_TRUE(refuses_json(R"({"version": "2.0"})", R"({"version": 2.0})", "it is not a glTF"));
}

TEST_F(Gltf, IgnoresFaultsInUnusedParts) {
  std::string json = square_json();
  json.insert(1, R"("extras": {"source": -1}, "animations": [{"channels": [{"target": -1}]}], )");
  EXPECT_TRUE(load(glb(json, square_data()))) << diagnostics_.text();
}

TEST_F(Gltf, RefusesCyclesOfNodes) {
  EXPECT_TRUE(refuses_json(R"([{"mesh": 0}])", R"([{"children": [1]}, {"children": [0], "mesh": 0}])",
                           "two parents, or is below itself"));
  EXPECT_TRUE(refuses_json(R"([{"mesh": 0}])", R"([{"children": [7]}])", "a node does not exist"));
  EXPECT_TRUE(refuses_json(R"([{"mesh": 0}])", R"([{"mesh": 9}])", "a mesh does not exist"));
  EXPECT_TRUE(refuses_json(R"([{"mesh": 0}])", R"([{}])", "no triangles"));
}

TEST_F(Gltf, RefusesFilesOutsideItsFolder) {
  folder_.write("secret.bin", square_data());
  for (const char* uri : {"../secret.bin", "%2e%2e/secret.bin", "../inside/../secret.bin"}) {
    const std::string json =
        square_json(all_attributes, one_node, R"("uri": ")" + std::string(uri) + R"(", )");
    EXPECT_TRUE(refuses(json, "outside-reference", "inside/m.gltf")) << uri;
  }
  EXPECT_TRUE(
      refuses(square_json(all_attributes, one_node, R"("uri": "/etc/passwd", )"), "not found", "m.gltf"));
}

TEST_F(Gltf, RefusesFilesThatWouldCrashTinygltf) {
  const std::string deep = std::string(100'000, '[') + std::string(100'000, ']');
  EXPECT_TRUE(refuses_json(R"("scene": 0)", R"("extras": )" + deep, "too-deep"));
  EXPECT_TRUE(refuses_json(R"("byteLength": 156)", R"("byteLength": 0)", "no byteLength"));
  EXPECT_TRUE(refuses_json(R"("byteLength": 156)", R"("byteLength": 400000000)", "more than 256 MiB"));
}

TEST_F(Gltf, WarnsOnceAboutEachUnsupportedFeature) {
  struct Case {
    const char* from;
    const char* to;
    const char* name;
  };
  const Case cases[] = {
      {R"("materials": [{)", R"("materials": [{"alphaMode": "BLEND", )", nullptr},
      {R"("materials": [{)", R"("materials": [{"alphaMode": "MASK", "alphaCutoff": 0.3, )", nullptr},
      {R"("materials": [{)", R"("materials": [{"alphaMode": "OPAQUE", )", nullptr},
      {R"("materials": [{)", R"("materials": [{"doubleSided": true, )", nullptr},
      {R"("materials": [{)", R"("materials": [{"normalTexture": {"index": 0, "texCoord": 2}, )",
       "texture coordinates beyond the second set"},
      {R"("materials": [{)",
       R"("materials": [{"normalTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"texCoord": 2}}}, )",
       "texture coordinates beyond the second set"},
      {R"("TEXCOORD_0": 2)", R"("TEXCOORD_0": 2, "TEXCOORD_1": 2, "TEXCOORD_2": 2, "TEXCOORD_3": 2)",
       "texture coordinates beyond the second set"},
      {R"("TEXCOORD_0": 2)", R"("TEXCOORD_0": 2, "_OWN": 2)", nullptr},
      {R"("COLOR_0": 3)", R"("COLOR_0": 3, "COLOR_1": 3)", "vertex colours beyond the first set"},
      {R"("COLOR_0": 3)", R"("COLOR_0": 3, "JOINTS_0": 3, "WEIGHTS_0": 3)", "skins"},
      {R"("materials": [{)", R"("materials": [{"extensions": {"KHR_materials_unlit": {}}, )", nullptr},
      {R"("materials": [{)", R"("materials": [{"extensions": {"KHR_materials_clearcoat": {}}, )",
       "the extension \"KHR_materials_clearcoat\""},
      {R"("scene": 0)", R"("scene": 0, "extensionsUsed": ["KHR_texture_transform", "KHR_mesh_quantization"])",
       "the extension \"KHR_mesh_quantization\""},
      {R"("scene": 0)",
       R"("scene": 0, "extensionsUsed": ["KHR_lights_punctual"], "extensions": {"KHR_lights_punctual": {}})",
       "the extension \"KHR_lights_punctual\""},
      {R"("scene": 0)", R"("scene": 0, "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 1}}])",
       "cameras"},
      {R"("scene": 0)", R"("scene": 0, "samplers": [{"wrapS": 33071, "magFilter": 9728, "minFilter": 9984}])",
       nullptr},
      {R"("scene": 0)", R"("scene": 0, "skins": [{"joints": [0]}])", nullptr},
      {R"([{"mesh": 0}])", R"([{"mesh": 0, "skin": 0}])", "skins"},
      {R"("indices": 4)", R"("targets": [{"POSITION": 0}], "indices": 4)", "morph targets"},
      {R"("scene": 0)", R"("scene": 0, "animations": [{"channels": [], "samplers": []}])", "animations"},
      {R"("scene": 0)", R"("scene": 0, "extras": {"alphaMode": "BLEND"})", nullptr},
  };
  for (const Case& test : cases) {
    std::string json = square_json();
    json.replace(json.find(test.from), std::string(test.from).size(), test.to);
    load(glb(json, square_data()));
    const std::string text = diagnostics_.text();
    const size_t warned = text.find("warning[ignored-feature]");
    if (test.name == nullptr) {
      EXPECT_EQ(warned, std::string::npos) << test.to << "\n" << text;
      continue;
    }
    ASSERT_NE(warned, std::string::npos) << test.to << "\n" << text;
    EXPECT_EQ(text.find("warning[ignored-feature]", warned + 1), std::string::npos) << text;
    EXPECT_NE(text.find(std::string(" uses ") + test.name + ", which isoshade does not read"),
              std::string::npos)
        << text;
  }
}

TEST_F(Gltf, RejectsRequiredExtensionsAndLaterVersions) {
  for (const char* name :
       {"KHR_draco_mesh_compression", "KHR_materials_pbrSpecularGlossiness", "KHR_lights_punctual"})
    EXPECT_TRUE(
        refuses_json(R"("scene": 0)", R"("extensionsRequired": [")" + std::string(name) + R"("])", name));
  EXPECT_TRUE(refuses_json(R"("version": "2.0")", R"("version": "2.0", "minVersion": "3.0")",
                           "requires glTF"));
  EXPECT_TRUE(refuses_json(R"("version": "2.0")", R"("version": "2.1", "minVersion": "2.1")",
                           "requires glTF"));
  std::string json = square_json();
  json.replace(json.find(R"("version": "2.0")"), 16, R"("version": "2.1", "minVersion": "2.0")");
  loaded(json);
  json.insert(json.find(R"("scene": 0)"), R"("extensionsRequired": ["KHR_texture_transform",
"KHR_materials_emissive_strength", "KHR_materials_unlit"], )");
  loaded(json);
}

/// The texture coordinates of the first set, mirrored in u.
std::string second_set(std::string json) {
  json.replace(json.find(R"("COLOR_0": 3)"), 12, R"("TEXCOORD_1": 5)");
  json.insert(json.find(R"(],
"bufferViews")"), R"(, {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"})");
  json.insert(json.find(R"(],
"buffers")"), R"(, {"buffer": 0, "byteOffset": 156, "byteLength": 32})");
  return json.replace(json.find(R"("byteLength": 156)"), 17, R"("byteLength": 188)");
}

TEST_F(Gltf, ReadsTwoSetsOfTextureCoordinates) {
  const std::string data = square_data() + bytes_of<float>({1, 1, 0, 1, 0, 0, 1, 0});
  const Model model = loaded(second_set(square_json()), data);
  for (size_t vertex = 0; vertex < 4; ++vertex) {
    const float* record = &model.mesh.vertices.at(vertex * word::stride);
    EXPECT_EQ(record[word::texcoord1], 1 - record[word::texcoord]);
    EXPECT_EQ(record[word::texcoord1 + 1], record[word::texcoord + 1]);
  }
}

TEST_F(Gltf, MeshesWithOneSetOfTextureCoordinatesRepeatIt) {
  const Model model = loaded(square_json());
  for (size_t vertex = 0; vertex < 4; ++vertex)
    for (const int axis : {0, 1})
      EXPECT_EQ(model.mesh.vertices.at(vertex * word::stride + word::texcoord1 + axis),
                model.mesh.vertices.at(vertex * word::stride + word::texcoord + axis));
}

TEST_F(Gltf, TangentsRunAlongTheSetOfTheNormalTexture) {
  const std::string data = square_data() + bytes_of<float>({1, 1, 0, 1, 0, 0, 1, 0});
  std::string json = second_set(square_json());
  EXPECT_EQ(vector_at(loaded(json, data), 0, word::tangent), glm::vec3(1, 0, 0));
  std::string image = R"("images": [{"uri": "data:image/png;base64,QUJD"}], "textures": [{"source": 0}], )";
  json.insert(json.find(R"("scene": 0)"), image);
  json.insert(json.find(R"("pbrMetallicRoughness")"), R"("normalTexture": {"index": 0, "texCoord": 1}, )");
  const Model model = loaded(json, data);
  EXPECT_EQ(vector_at(model, 0, word::tangent), glm::vec3(-1, 0, 0));
  EXPECT_EQ(model.mesh.vertices.at(word::tangent + 3), -1.0f);
}

TEST_F(Gltf, RefusesOffsetsThatAreNotIntegers) {
  EXPECT_TRUE(refuses_json(R"("byteOffset": 48)", R"("byteOffset": -48)", "not an integer"));
  EXPECT_TRUE(refuses_json(R"("byteOffset": 144)", R"("byteOffset": 1e18)", "not an integer"));
  EXPECT_TRUE(refuses_json(R"("count": 4)", R"("count": -4)", "not an integer"));
  EXPECT_TRUE(refuses_json(R"("byteLength": 144)", R"("byteLength": 1.5)", "not an integer"));
}

TEST_F(Gltf, NormalsOfAnyLengthAreNormalised) {
  for (const float length : {1e-37f, 1e-20f, 1.0f, 1e20f, 3e38f}) {
    std::string data = square_data();
    for (size_t v = 0; v < 4; ++v) std::memcpy(&data[48 + 12 * v + 8], &length, 4);
    for (const char* node : {R"([{"mesh": 0}])", R"([{"mesh": 0, "scale": [1000, 1000, 1000]}])",
                             R"([{"mesh": 0, "scale": [0.001, 0.001, 0.001]}])"}) {
      const Model model = loaded(square_json(all_attributes, node), data);
      for (size_t v = 0; v < 4; ++v)
        EXPECT_NEAR(glm::distance(vector_at(model, v, word::normal), glm::vec3(0, 0, 1)), 0, 2e-7f)
            << length << " " << node;
    }
  }
  EXPECT_TRUE(refuses_json(R"([{"mesh": 0}])",
                           R"([{"children": [1], "scale": [1e9, 1e9, 1e-9]},
    {"children": [2], "scale": [1e9, 1e9, 1e-9]}, {"mesh": 0, "scale": [1e9, 1e9, 1e-9]}])",
                           "too large"));
}

TEST_F(Gltf, RefusesFilesThatAreNotGltf) {
  const std::string good = glb(square_json(), square_data());
  EXPECT_TRUE(refuses("glTF", "first chunk"));
  EXPECT_TRUE(refuses(good.substr(0, 200), "first chunk"));
  EXPECT_TRUE(refuses(good.substr(0, good.size() - 1), "bad-mesh"));
  EXPECT_TRUE(refuses("{}", "bad-mesh", "m.gltf"));
  EXPECT_TRUE(refuses("no JSON", "syntax", "m.gltf"));
  EXPECT_TRUE(refuses_json(R"("scene": 0)", R"("extensionsRequired": ["KHR_draco_mesh_compression"])",
                           "KHR_draco_mesh_compression"));
  support::Diagnostics diagnostics;
  EXPECT_FALSE(scene::load_gltf("no such file.glb", {}, diagnostics));
  EXPECT_NE(diagnostics.text().find("missing-file"), std::string::npos);
}

}  // namespace
}  // namespace isoshade
