// SPDX-License-Identifier: Apache-2.0
// Draws a box off screen with the forward shaders of a material, bound by the material's reflection alone: locations, bindings,
// offsets, sizes, images, values of parameters and states of passes are read from it, so this draws any material whose vertex
// attributes the box has. The program's own are the mesh, the camera, the light and the conventions of clip space.
//
//     bound_by_reflection MATERIAL OUT.ppm [PARAMETER=VALUE...]       VALUE is JSON: tiles=[2,2]
//
// MATERIALS is the folder of the reflections and shaders that isoshade_add_graph() made, COLLECTION the one that the paths of
// images are relative to.
#include "vulkan_device.h"

#define GLM_FORCE_DEPTH_ZERO_TO_ONE
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>
#include <spng.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

using nlohmann::json;

constexpr uint32_t width = 480, height = 360;

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("cannot read " + path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The element of a list of the reflection that has this value for a key.
const json& find(const json& list, const char* key, const json& value) {
  for (const json& element : list)
    if (element.contains(key) && element[key] == value) return element;
  throw std::runtime_error(std::string("the reflection has no ") + key + " " + value.dump());
}

// ---------------------------------------------------------------------------------------------------------------------------
// What the program draws.

/// A list for each attribute, by the name that reflections have for it.
struct Mesh {
  std::map<std::string, std::vector<float>> attributes;
  std::vector<uint32_t> indices;
};

Mesh make_box() {
  struct Face {
    glm::vec3 normal, right, up;
  };
  constexpr Face faces[] = {{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}, {{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                            {{0, 1, 0}, {1, 0, 0}, {0, 0, -1}}, {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
                            {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}},  {{0, 0, -1}, {-1, 0, 0}, {0, 1, 0}}};
  Mesh mesh;
  const auto add = [&](const char* attribute, std::initializer_list<float> values) {
    std::vector<float>& list = mesh.attributes[attribute];
    list.insert(list.end(), values);
  };
  uint32_t first = 0;
  for (const Face& face : faces) {
    for (const glm::vec2 corner : {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)}) {
      const glm::vec3 position = 0.5f * (face.normal + face.right * corner.x + face.up * corner.y);
      add("position", {position.x, position.y, position.z});
      add("normal", {face.normal.x, face.normal.y, face.normal.z});
      add("texcoord", {0.5f + 0.5f * corner.x, 0.5f - 0.5f * corner.y});  // v down, as images
      add("color", {1, 1, 1, 1});
      add("tangent", {face.right.x, face.right.y, face.right.z, 1});
    }
    for (const uint32_t corner : {0, 1, 2, 0, 2, 3}) mesh.indices.push_back(first + corner);  // counter-clockwise from outside
    first += 4;
  }
  return mesh;
}

struct Light {
  glm::vec3 direction, color;  // towards the light; times its intensity
};

struct Scene {
  glm::vec3 eye{1.2f, 1.1f, 1.9f};
  glm::mat4 view_from_world = glm::lookAt(eye, glm::vec3(0), glm::vec3(0, 1, 0));
  glm::mat4 clip_from_view = glm::perspective(glm::radians(36.0f), float{width} / float{height}, 0.1f, 10.0f);
  glm::mat4 world_from_object = glm::rotate(glm::mat4(1), glm::radians(-10.0f), glm::vec3(0, 1, 0));
  std::vector<Light> lights{{glm::normalize(glm::vec3(0.5f, 0.8f, 0.6f)), glm::vec3(0.9f, 0.8f, 0.7f)},
                            {glm::normalize(glm::vec3(-0.7f, 0.2f, 0.7f)), glm::vec3(0.2f, 0.3f, 0.5f)}};
  std::array<float, 4> background{0.02f, 0.025f, 0.035f, 0};
};

// ---------------------------------------------------------------------------------------------------------------------------
// Binding.

class Material {
 public:
  /// `settings`: values for parameters; the others have the defaults of the document.
  Material(const std::string& name, json settings)
      : reflection_(json::parse(read_file(MATERIALS "/" + name + ".json"))), settings_(std::move(settings)) {
    for (const auto& [parameter, value] : settings_.items()) find(reflection_["parameters"], "name", parameter);
  }

  /// The commands that draw each pass.
  std::vector<Commands> passes(Device& device, const Mesh& mesh, const Scene& scene) const {
    std::vector<Commands> drawn;
    const VkBuffer indices = device.buffer(mesh.indices, VK_BUFFER_USAGE_INDEX_BUFFER_BIT).buffer;
    for (const json& pair : reflection_["pairs"]) {
      const json& pass = find(reflection_["passes"], "name", pair["pass"]);
      if (pass.contains("enabled"))
        if (const json value = value_of(pass["enabled"]); value == 0 || value == false) continue;

      std::vector<VkDescriptorSetLayoutBinding> bindings;
      const auto declare = [&](const json& bound, VkDescriptorType type) {
        bindings.push_back({bound["binding"], type, 1, VK_SHADER_STAGE_ALL_GRAPHICS, nullptr});
      };
      for (const json& block : pair["blocks"]) declare(block, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER);
      for (const json& sampler : pair["samplers"]) declare(sampler, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER);
      const auto set_layout =
          device.make(vkCreateDescriptorSetLayout, vkDestroyDescriptorSetLayout,
                      VkDescriptorSetLayoutCreateInfo{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                                      .bindingCount = static_cast<uint32_t>(bindings.size()),
                                                      .pBindings = bindings.data()});
      const VkDescriptorSet set = device.descriptor_set(set_layout, bindings);
      for (const json& block : pair["blocks"]) {
        const Buffer buffer = device.buffer(contents(pair, block, scene), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT);
        const VkDescriptorBufferInfo info{buffer.buffer, 0, VK_WHOLE_SIZE};
        device.write(set, block["binding"], &info, nullptr);
      }
      for (const json& sampler : pair["samplers"]) {
        const VkDescriptorImageInfo info{make_sampler(device),
                                         texture(device, find(reflection_["images"], "field", sampler["image"])),
                                         VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
        device.write(set, sampler["binding"], nullptr, &info);
      }
      const auto layout = device.make(vkCreatePipelineLayout, vkDestroyPipelineLayout,
                                      VkPipelineLayoutCreateInfo{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                                                 .setLayoutCount = 1, .pSetLayouts = &set_layout});
      const VkPipeline pipeline = make_pipeline(device, pair, pass["states"], layout);

      std::vector<VkBuffer> vertices;  // a buffer for each attribute
      for (const json& attribute : pair["attributes"]) {
        const auto found = mesh.attributes.find(attribute["vertex"]);
        if (found == mesh.attributes.end()) throw std::runtime_error("the mesh has no " + attribute["vertex"].dump());
        vertices.push_back(device.buffer(found->second, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT).buffer);
      }
      drawn.push_back([=, count = static_cast<uint32_t>(mesh.indices.size())](VkCommandBuffer commands) {
        const std::vector<VkDeviceSize> offsets(vertices.size());
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
        vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, 0, 1, &set, 0, nullptr);
        vkCmdBindVertexBuffers(commands, 0, static_cast<uint32_t>(vertices.size()), vertices.data(), offsets.data());
        vkCmdBindIndexBuffer(commands, indices, 0, VK_INDEX_TYPE_UINT32);
        vkCmdDrawIndexed(commands, count, 1, 0, 0, 0);
      });
    }
    return drawn;
  }

 private:
  json value_of(const json& parameter) const {
    return settings_.contains(parameter) ? settings_[parameter.get<std::string>()]
                                         : find(reflection_["parameters"], "name", parameter)["value"];
  }

  /// The bytes of a uniform block, each value at the offset of its member.
  std::vector<std::byte> contents(const json& pair, const json& block, const Scene& scene) const {
    std::vector<std::byte> bytes(block["size"].get<size_t>());
    const auto set = [&](const json& members, const json& name, const auto& value, size_t begin = 0) {
      const size_t offset = begin + find(members, "name", name)["offset"].get<size_t>();
      if (offset + sizeof value > bytes.size()) throw std::runtime_error(name.dump() + " does not fit into its block");
      std::memcpy(&bytes[offset], &value, sizeof value);
    };
    const json& members = block["members"];
    if (block["role"] == "view") {
      set(members, "view_from_world", scene.view_from_world);
      set(members, "world_from_view", glm::inverse(scene.view_from_world));
      set(members, "clip_from_view", scene.clip_from_view);
      set(members, "eye", glm::vec4(scene.eye, 1));
      set(members, "pixel_size", glm::vec2(0, 2 / (scene.clip_from_view[1][1] * float{height})));
      set(members, "time", 0.0f);
    } else if (block["role"] == "object") {
      set(members, "world_from_object", scene.world_from_object);
      set(members, "object_from_world", glm::inverse(scene.world_from_object));
      set(members, "pass_index", int32_t{0});  // no pass is repeated
      set(members, "pass_count", int32_t{1});
    } else if (block["role"] == "lights") {
      const json& light = pair["light"];
      if (scene.lights.size() > light["count"]) throw std::runtime_error("there are too many lights");
      set(members, "count", static_cast<int32_t>(scene.lights.size()));
      size_t begin = find(members, "name", "lights")["offset"];
      for (const Light& one : scene.lights) {  // directional: kind and all else is 0
        set(light["members"], "direction", one.direction, begin);
        set(light["members"], "color", one.color, begin);
        begin += light["size"].get<size_t>();
      }
    } else if (block["role"] == "parameters") {
      for (const json& field : find(reflection_["structs"], "role", "parameters")["fields"]) {
        const json& member = find(members, "name", field["name"]);
        if (field.contains("image")) {  // negative: there is no image
          const bool has_file = find(reflection_["images"], "field", field["name"]).contains("file");
          set(members, field["name"], has_file ? int32_t{0} : int32_t{-1});
          continue;
        }
        const json value = value_of(field["parameter"]);
        const std::string type = member["type"];
        const size_t components = type.starts_with("vec") ? static_cast<size_t>(type[3] - '0') : 1;
        for (size_t i = 0; i < components; ++i) {
          const json& number = value.is_array() ? value.at(field["first"].get<size_t>() + i) : value;
          if (type == "int")
            set(members, field["name"], number.is_boolean() ? int32_t{number.get<bool>()} : number.get<int32_t>());
          else
            set(members, field["name"], number.get<float>(), sizeof(float) * i);
        }
      }
    } else {
      throw std::runtime_error("unknown block " + block["name"].dump());
    }
    return bytes;
  }

  /// Without filter: the shader filters by itself. With SAMPLING samplers, `samplings` of the image says what belongs here.
  static VkSampler make_sampler(Device& device) {
    return device.make(vkCreateSampler, vkDestroySampler,
                       VkSamplerCreateInfo{.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO, .maxLod = VK_LOD_CLAMP_NONE});
  }

  /// The image's file in the format that decodes it, with mip levels if they are read; a single texel if there is no file.
  static VkImageView texture(Device& device, const json& image) {
    VkExtent3D size{1, 1, 1};
    std::vector<std::byte> texels(4);
    if (image.contains("file")) {
      const std::string png = read_file(COLLECTION "/" + image["file"].get<std::string>());
      spng_ctx* decoder = spng_ctx_new(0);
      spng_ihdr header;
      size_t bytes = 0;
      bool done = spng_set_png_buffer(decoder, png.data(), png.size()) == 0 && spng_get_ihdr(decoder, &header) == 0 &&
                  header.bit_depth <= 8 && spng_decoded_image_size(decoder, SPNG_FMT_RGBA8, &bytes) == 0;
      if (done) {
        size = {header.width, header.height, 1};
        texels.resize(bytes);
        done = spng_decode_image(decoder, texels.data(), bytes, SPNG_FMT_RGBA8, SPNG_DECODE_TRNS) == 0;
      }
      spng_ctx_free(decoder);
      if (!done) throw std::runtime_error(image["file"].dump() + " is not a PNG file of 8 bits");
    }
    const VkFormat format = image["decoding"] == "linear" ? VK_FORMAT_R8G8B8A8_UNORM : VK_FORMAT_R8G8B8A8_SRGB;
    return device.texture(format, size, texels, image["mips"]).view;
  }

  static VkPipeline make_pipeline(Device& device, const json& pair, const json& states, VkPipelineLayout layout) {
    const auto code = [&](const char* extension) {
      return read_file(MATERIALS "/" + pair["file"].get<std::string>() + extension);
    };
    static const std::map<std::string, std::pair<VkFormat, uint32_t>> formats{
        {"float", {VK_FORMAT_R32_SFLOAT, 4}}, {"vec2", {VK_FORMAT_R32G32_SFLOAT, 8}},
        {"vec3", {VK_FORMAT_R32G32B32_SFLOAT, 12}}, {"vec4", {VK_FORMAT_R32G32B32A32_SFLOAT, 16}}};
    std::vector<VkVertexInputBindingDescription> buffers;
    std::vector<VkVertexInputAttributeDescription> attributes;
    for (const json& attribute : pair["attributes"]) {
      const auto [format, bytes] = formats.at(attribute["type"]);
      const auto buffer = static_cast<uint32_t>(buffers.size());
      buffers.push_back({buffer, bytes, VK_VERTEX_INPUT_RATE_VERTEX});
      attributes.push_back({attribute["location"], buffer, format, 0});
    }
    static const std::map<std::string, VkCullModeFlags> culled{
        {"none", VK_CULL_MODE_NONE}, {"back", VK_CULL_MODE_BACK_BIT}, {"front", VK_CULL_MODE_FRONT_BIT}};
    static const std::map<std::string, VkCompareOp> compared{{"nearer", VK_COMPARE_OP_LESS}, {"always", VK_COMPARE_OP_ALWAYS}};
    return device.pipeline({code(".vert.spv"), code(".frag.spv"), buffers, attributes, culled.at(states["cull"]),
                            compared.at(states["depth"]), layout});
  }

  json reflection_, settings_;
};

// ---------------------------------------------------------------------------------------------------------------------------

int main(int count, char** arguments) try {
  if (count < 3) throw std::runtime_error("usage: bound_by_reflection MATERIAL OUT.ppm [PARAMETER=VALUE...]");
  json settings = json::object();
  for (int i = 3; i < count; ++i) {
    const std::string setting = arguments[i];
    const size_t equals = setting.find('=');
    settings[setting.substr(0, equals)] = json::parse(setting.substr(equals + 1));
  }
  const Scene scene;
  Device device;
  const auto passes = Material(arguments[1], settings).passes(device, make_box(), scene);
  const std::vector<uint8_t> pixels = device.draw(passes, width, height, scene.background);
  std::ofstream file(arguments[2], std::ios::binary);
  file << "P6\n" << width << " " << height << "\n255\n";
  size_t covered = 0;
  for (size_t i = 0; i < pixels.size(); i += 4) {
    file.write(reinterpret_cast<const char*>(&pixels[i]), 3);
    covered += pixels[i + 3] != 0;
  }
  if (!file.flush()) throw std::runtime_error(std::string("cannot write ") + arguments[2]);
  std::printf("%s covers %zu of %u pixels\n", arguments[1], covered, width * height);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
