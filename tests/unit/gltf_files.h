// SPDX-License-Identifier: Apache-2.0
// glTF files that the tests make.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>
#include <vector>

namespace isoshade::testing {

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

/// A square in z = 0, 1 wide, of 4 vertices and 6 shorts: positions at byte 0, normals at 48, texture
/// coordinates at 96, colours (bytes) at 128, indices at 144.
inline std::string square_data(float corner = 1) {
  return bytes_of<float>({0, 0, 0, 1, 0, 0, corner, 1, 0, 0, 1, 0}) +
         bytes_of<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}) + bytes_of<float>({0, 1, 1, 1, 1, 0, 0, 0}) +
         bytes_of<uint8_t>({255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 51, 51, 51, 51}) +
         bytes_of<uint16_t>({0, 1, 2, 0, 2, 3});
}
inline constexpr size_t square_bytes = 156;

inline constexpr const char* all_attributes = R"("POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2, "COLOR_0": 3)";
inline constexpr const char* one_node = R"([{"mesh": 0}])";

inline std::string square_json(const std::string& attributes = all_attributes,
                               const std::string& nodes = one_node, const std::string& buffer = "") {
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": )" + nodes +
         R"(, "meshes": [{"primitives": [{"attributes": {)" + attributes +
         R"(}, "indices": 4, "material": 0}]}], "materials": [{"pbrMetallicRoughness": )" +
         R"({"baseColorFactor": [0.5, 0.25, 1, 1], "metallicFactor": 0.75, "roughnessFactor": 0.5}}],
"accessors": [
 {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
 {"bufferView": 0, "byteOffset": 48, "componentType": 5126, "count": 4, "type": "VEC3"},
 {"bufferView": 0, "byteOffset": 96, "componentType": 5126, "count": 4, "type": "VEC2"},
 {"bufferView": 0, "byteOffset": 128, "componentType": 5121, "normalized": true, "count": 4, "type": "VEC4"},
 {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}],
"bufferViews": [{"buffer": 0, "byteLength": 144}, {"buffer": 0, "byteOffset": 144, "byteLength": 12}],
"buffers": [{)" +
         buffer + R"("byteLength": 156}]})";
}

inline std::string glb(std::string json, const std::string& data) {
  while (json.size() % 4 != 0) json += ' ';
  const auto word = [](size_t value) { return bytes_of<uint32_t>({static_cast<uint32_t>(value)}); };
  return "glTF" + word(2) + word(28 + json.size() + data.size()) + word(json.size()) + "JSON" + json +
         word(data.size()) + std::string("BIN\0", 4) + data;
}

/// A .glb of the square, with an image as its base colour, and what refers to it and samples it.
inline std::string textured_glb(const std::string& image, const std::string& reference = R"({"index": 0})",
                                const std::string& sampler = "{}") {
  std::string json = square_json();
  const auto replace = [&](const std::string& from, const std::string& to) {
    json.replace(json.find(from), from.size(), to);
  };
  std::string data = square_data() + image;
  data.resize((data.size() + 3) / 4 * 4);
  replace(R"("roughnessFactor": 0.5}})",
          R"("roughnessFactor": 0.5, "baseColorTexture": )" + reference + R"(}}], "textures": [{"source": 0, "sampler": 0}],
"samplers": [)" + sampler + R"(], "images": [{"mimeType": "image/png", "bufferView": 2})");
  replace(R"("byteLength": 12})", R"("byteLength": 12},
{"buffer": 0, "byteOffset": 156, "byteLength": )" +
                                      std::to_string(image.size()) + "}");
  replace(R"("byteLength": 156})", R"("byteLength": )" + std::to_string(data.size()) + "}");
  return glb(json, data);
}

/// Four squares in a row along x, in this order: of the second material, which is green, of none, of the first,
/// which is square_json's, and again of the second.
inline std::string materials_json() {
  const std::string square = std::string(R"({"primitives": [{"attributes": {)") + all_attributes + "}";
  std::string json = square_json(
      all_attributes, R"([{"children": [1, 2, 3, 4]}, {"mesh": 1}, {"mesh": 2, "translation": [1, 0, 0]},
{"mesh": 0, "translation": [2, 0, 0]}, {"mesh": 1, "translation": [3, 0, 0]}])");
  const auto add_behind = [&](const std::string& text, const std::string& added) {
    json.insert(json.find(text) + text.size(), added);
  };
  add_behind(R"("indices": 4, "material": 0}]})",
             ", " + square + R"(, "indices": 4, "material": 1}]}, )" + square + R"(, "indices": 4}]})");
  add_behind(R"("roughnessFactor": 0.5}})",
             R"(, {"pbrMetallicRoughness": {"baseColorFactor": [0.125, 1, 0.25, 1], "metallicFactor": 0}})");
  return json;
}

/// An empty folder while it lives.
class Folder {
 public:
  Folder() {
    path_ = (std::filesystem::temp_directory_path() / "isoshade-gltf-XXXXXX").string();
    if (mkdtemp(path_.data()) == nullptr) path_.clear();
  }
  ~Folder() {
    std::error_code error;
    if (!path_.empty()) std::filesystem::remove_all(path_, error);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  const std::string& path() const { return path_; }

  /// Writes a file and returns its path.
  std::string write(const std::string& name, const std::string& bytes) const {
    const std::filesystem::path file = std::filesystem::path(path_) / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << bytes;
    return file.string();
  }

 private:
  std::string path_;
};

}  // namespace isoshade::testing
