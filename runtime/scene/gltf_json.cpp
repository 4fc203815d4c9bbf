// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "compiler/support/visible.h"
#include "runtime/scene/gltf_parts.h"

namespace isoshade::scene {

using graph::Json;
using support::quote;

namespace {

uint32_t word_at(const std::string& bytes, size_t at) {
  uint32_t word = 0;
  for (size_t i = 4; i > 0; --i) word = word << 8 | static_cast<unsigned char>(bytes[at + i - 1]);
  return word;
}

/// The keys whose values are indices, counts or codes: integers that are not negative.
bool is_index(std::string_view key) {
  static constexpr std::string_view keys[] = {
      "buffer",        "bufferView", "byteLength", "byteOffset", "byteStride", "children",
      "componentType", "count",      "index",      "indices",    "magFilter",  "material",
      "mesh",          "minFilter",  "mode",       "nodes",      "sampler",    "scene",
      "source",        "texCoord",   "wrapS",      "wrapT"};
  return std::ranges::find(keys, key) != std::end(keys);
}

bool check_index(const graph::Document& document, const Json& value, Refusal& refusal) {
  if (value.integral && value.number >= 0 && value.number <= std::numeric_limits<int>::max()) return true;
  const bool is_number = value.kind == Json::Kind::number;
  return refusal.refuse(graph::pointer_at(document, value.begin) + " is " +
                        (is_number ? std::string(document.text(value).substr(0, 40))
                                   : std::string(graph::kind_name(value.kind))) +
                        ", not an integer from 0 to 2147483647");
}

/// A key whose value is a number, or numbers. tinygltf ignores values of other types and lengths.
struct Quantity {
  std::string_view key;
  size_t count = 0;        ///< of an array
  bool is_number = true;   ///< whether it may be a single number
};
const Quantity* quantity_of(std::string_view key) {
  static constexpr Quantity quantities[] = {
      {"alphaCutoff"},     {"baseColorFactor", 4, false}, {"emissiveFactor", 3, false}, {"matrix", 16, false},
      {"metallicFactor"},  {"rotation", 4, false},        {"roughnessFactor"},
      {"scale", 3},  // of a node, or of a normal texture
      {"strength"},        {"translation", 3, false}};
  const auto* found = std::ranges::find(quantities, key, &Quantity::key);
  return found == std::end(quantities) ? nullptr : found;
}

bool check_quantity(const graph::Document& document, const Json& value, const Quantity& quantity, Refusal& refusal) {
  const auto refuse = [&](const Json& wrong, const std::string& what) {
    return refusal.refuse(graph::pointer_at(document, wrong.begin) + " is " + what);
  };
  const auto is_no_number = [&](const Json& wrong) {
    return refuse(wrong, std::string(graph::kind_name(wrong.kind)) + ", not a number");
  };
  if (value.kind == Json::Kind::array) {
    for (const Json& item : value.items)
      if (item.kind != Json::Kind::number) return is_no_number(item);
    if (quantity.count == 0) return is_no_number(value);
    return value.items.size() == quantity.count ||
           refuse(value, "an array of " + std::to_string(value.items.size()) + " numbers, not " +
                             std::to_string(quantity.count));
  }
  if (value.kind != Json::Kind::number) return is_no_number(value);
  return quantity.is_number ||
         refuse(value, "a number, not an array of " + std::to_string(quantity.count) + " numbers");
}

/// Checks a key of a material that is neither an index nor a number.
bool check_word(const graph::Document& document, std::string_view key, const Json& value, Refusal& refusal) {
  static constexpr std::string_view modes[] = {"OPAQUE", "MASK", "BLEND"};
  const auto refuse = [&](const std::string& wanted) {
    const bool is_string = value.kind == Json::Kind::string;
    return refusal.refuse(graph::pointer_at(document, value.begin) + " is " +
                          (is_string ? quote(value.string) : std::string(graph::kind_name(value.kind))) + ", not " +
                          wanted);
  };
  if (key == "doubleSided" && value.kind != Json::Kind::boolean) return refuse("true or false");
  const bool is_mode = value.kind == Json::Kind::string && std::ranges::find(modes, value.string) != std::end(modes);
  return key != "alphaMode" || is_mode || refuse("\"OPAQUE\", \"MASK\" or \"BLEND\"");
}

bool check_limited(const graph::Document& document, const Json& value, Refusal& refusal) {
  constexpr double limit = 1e6;
  if (value.kind == Json::Kind::number && std::abs(value.number) <= limit) return true;
  return refusal.refuse(graph::pointer_at(document, value.begin) + " is not a number from -1e6 to 1e6");
}

/// Checks the extensions that are read.
bool check_extensions(const graph::Document& document, const Json& extensions, Refusal& refusal) {
  for (const graph::Member& extension : extensions.members) {
    if (!is_read_extension(extension.key)) continue;
    for (const auto& [key, key_begin, key_end, value] : extension.value.members) {
      if (key == "texCoord" && !check_index(document, value, refusal)) return false;
      if ((key == "rotation" || key == "emissiveStrength") && !check_limited(document, value, refusal)) return false;
      if (key != "offset" && key != "scale") continue;
      if (value.items.size() != 2)
        return refusal.refuse(graph::pointer_at(document, value.begin) + " is not an array of two numbers");
      for (const Json& item : value.items)
        if (!check_limited(document, item, refusal)) return false;
    }
  }
  return true;
}

/// Checks everything below `value`; with `attributes`, all of its members are indices.
bool check_indices(const graph::Document& document, const Json& value, bool attributes, Refusal& refusal) {
  for (const Json& item : value.items)
    if (!check_indices(document, item, false, refusal)) return false;
  for (const auto& [key, key_begin, key_end, member] : value.members) {
    if (key == "extras") continue;
    if (key == "extensions") {
      if (!check_extensions(document, member, refusal)) return false;
      continue;
    }
    const bool nested = member.kind == Json::Kind::object || member.kind == Json::Kind::array;
    if ((attributes || is_index(key)) && !nested && !check_index(document, member, refusal)) return false;
    const Quantity* quantity = quantity_of(key);
    if (quantity != nullptr && !check_quantity(document, member, *quantity, refusal)) return false;
    if (!check_word(document, key, member, refusal)) return false;
    if (key.ends_with("Texture") && member.kind == Json::Kind::object && member.find("index") == nullptr)
      return refusal.refuse(graph::pointer_at(document, member.begin) + " has no index");
    for (const Json& item : member.items)
      if (is_index(key) && item.kind != Json::Kind::object && !check_index(document, item, refusal))
        return false;
    if (nested && !check_indices(document, member, key == "attributes", refusal)) return false;
  }
  return true;
}

/// Checks the version: glTF 2.
bool check_version(const Json& root, Refusal& refusal) {
  const Json* asset = root.find("asset");
  const Json* version = asset == nullptr ? nullptr : asset->find("version");
  if (version == nullptr || version->kind != Json::Kind::string)
    return refusal.refuse("it is not a glTF: it has no \"asset\" with a \"version\"");
  if (version->string != "2" && !version->string.starts_with("2."))
    return refusal.refuse("it is of version " + quote(version->string) + ", not 2");
  const Json* least = asset->find("minVersion");
  if (least == nullptr || least->string == "2" || least->string == "2.0") return true;
  return refusal.refuse("it requires glTF " + quote(least->string) + ", and isoshade reads 2.0");
}

/// Whether a URI is no data URI, or one that tinygltf can decode; with a `length`, to so many bytes.
bool decodes(const std::string& uri, size_t length = 0) {
  if (!uri.starts_with("data:")) return true;
  std::vector<unsigned char> bytes;
  std::string type;
  return tinygltf::IsDataURI(uri) && tinygltf::DecodeDataURI(&bytes, type, uri, length, length != 0);
}
constexpr std::string_view undecodable = "its data URI cannot be decoded";

/// Checks that each image has a source: otherwise tinygltf would refuse the whole file.
bool check_images(const Json& root, Refusal& refusal) {
  const Json* images = root.find("images");
  if (images == nullptr) return true;
  for (size_t i = 0; i < images->items.size(); ++i) {
    const Json* uri = images->items[i].find("uri");
    std::string_view reason;
    if ((images->items[i].find("bufferView") != nullptr) == (uri != nullptr))
      reason = "it needs either \"uri\" or \"bufferView\"";
    else if (uri != nullptr && (uri->kind != Json::Kind::string || uri->string.empty()))
      reason = "its \"uri\" is not a string, or is empty";
    else if (uri != nullptr && !decodes(uri->string))
      reason = undecodable;
    if (!reason.empty())
      return refusal.refuse(support::Id::bad_image, "the image " + std::to_string(i), std::string(reason));
  }
  return true;
}

}  // namespace

bool is_binary(const std::string& bytes) { return bytes.starts_with("glTF"); }

std::optional<std::string> json_of(const std::string& bytes, Refusal& refusal) {
  if (!is_binary(bytes)) return bytes;
  constexpr size_t header = 20;  // of the file, and of its first chunk
  if (bytes.size() < header || word_at(bytes, 12) > bytes.size() - header) {
    refusal.refuse("it ends before its first chunk does");
    return std::nullopt;
  }
  if (word_at(bytes, 4) != 2) {
    refusal.refuse("it is of version " + std::to_string(word_at(bytes, 4)) + ", not 2");
    return std::nullopt;
  }
  return bytes.substr(header, word_at(bytes, 12));
}

bool check_buffers(const graph::Document& document, Refusal& refusal) {
  const Json* buffers = document.root.find("buffers");
  if (buffers == nullptr) return true;
  for (size_t i = 0; i < buffers->items.size(); ++i) {
    const Json *uri = buffers->items[i].find("uri"), *length = buffers->items[i].find("byteLength");
    if (uri == nullptr || length == nullptr || decodes(uri->string, static_cast<size_t>(length->number))) continue;
    return refusal.refuse(support::Id::bad_mesh, "the buffer " + std::to_string(i),
                          std::string(undecodable) + " to " + std::to_string(static_cast<size_t>(length->number)) + " bytes");
  }
  return true;
}

bool check_json(const graph::Document& document, Refusal& refusal) {
  if (!check_version(document.root, refusal) || !check_images(document.root, refusal)) return false;
  double bytes = 0;
  if (const Json* buffers = document.root.find("buffers")) {
    for (const Json& buffer : buffers->items) {
      const Json* length = buffer.find("byteLength");
      if (length == nullptr || !length->integral || length->number < 1)
        return refusal.refuse("a buffer has no byteLength");
      bytes += length->number;
    }
  }
  if (bytes > static_cast<double>(max_gltf_bytes))
    return refusal.refuse("its buffers have more than " + std::to_string(max_gltf_bytes >> 20) + " MiB");
  if (const Json* required = document.root.find("extensionsRequired")) {
    for (const Json& name : required->items)
      if (!is_read_extension(name.string))
        return refusal.refuse("it requires the extension " + quote(name.string) + ", which isoshade does not read");
  }
  return check_indices(document, document.root, false, refusal);
}

}  // namespace isoshade::scene
