// SPDX-License-Identifier: Apache-2.0
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <memory>
#include <utility>

#include "compiler/graph/document.h"
#include "compiler/graph/files.h"
#include "compiler/support/visible.h"
#include "runtime/lanes/float_rules.h"
#include "runtime/scene/gltf_parts.h"

namespace isoshade::scene {

using graph::Json;
using support::Diagnostics;
using support::Id;
using support::quote;

namespace {

namespace fs = std::filesystem;

/// All of a regular file, if it has no more than `limit` bytes; else the reason why not.
std::optional<std::string> read_bytes(const std::string& path, size_t limit, Id& id, std::string& reason) {
  id = Id::unreadable_file;
  if (path.find('\0') != std::string::npos) return reason = "the name has a NUL byte", std::nullopt;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::exists(status) && !fs::is_regular_file(status))
    return reason = "it is no regular file", std::nullopt;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             [](std::FILE* f) { return std::fclose(f); });
  if (file == nullptr) {
    if (errno == ENOENT || errno == ENOTDIR || errno == ENAMETOOLONG) id = Id::missing_file;
    return reason = std::strerror(errno), std::nullopt;
  }
  std::string bytes;
  char buffer[1 << 16];
  while (bytes.size() <= limit) {
    const size_t count = std::fread(buffer, 1, sizeof buffer, file.get());
    bytes.append(buffer, count);
    if (count < sizeof buffer) break;
  }
  if (std::ferror(file.get()) != 0) return reason = std::strerror(errno), std::nullopt;
  if (bytes.size() > limit) {
    id = Id::too_large;
    return reason = "it has more than " + std::to_string(limit >> 20) + " MiB", std::nullopt;
  }
  return bytes;
}

/// What tinygltf may read: regular files in or below one folder, and of them so many bytes in all.
struct Files {
  std::string folder;  ///< canonical
  size_t bytes_left = max_gltf_bytes;
  std::string outside;  ///< a path that leads out of the folder

  static bool exists(const std::string& path, void* self) {
    Files& files = *static_cast<Files*>(self);
    std::error_code error;
    if (path.find('\0') != std::string::npos || !fs::is_regular_file(path, error)) return false;
    if (graph::is_within(graph::canonical_path(path), files.folder)) return true;
    if (files.outside.empty()) files.outside = path;
    return false;
  }
  static std::string expand(const std::string& path, void*) { return path; }
  static bool read(std::vector<unsigned char>* out, std::string* why, const std::string& path, void* self) {
    Files& files = *static_cast<Files*>(self);
    if (!exists(path, self)) return false;
    Id id;
    std::string reason;
    const auto bytes = read_bytes(path, files.bytes_left, id, reason);
    if (!bytes) {
      if (why != nullptr) *why = reason;
      return false;
    }
    files.bytes_left -= bytes->size();
    out->assign(bytes->begin(), bytes->end());
    return true;
  }
  static bool write(std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
    return false;
  }
};

/// Keeps an image as it is: only what a material needs is decoded. Of one in a buffer nothing was checked yet, so it is
/// left for read_material.
bool keep_image(tinygltf::Image* image, int index, std::string*, std::string*, int, int,
                const unsigned char* bytes, int size, void* kept) {
  if (image->bufferView < 0 && size > 0)
    static_cast<ImageBytes*>(kept)->by_index[index] =
        std::make_shared<const std::string>(reinterpret_cast<const char*>(bytes), static_cast<size_t>(size));
  return true;
}

uint32_t word_at(const std::string& bytes, size_t at) {
  uint32_t word = 0;
  for (size_t i = 4; i > 0; --i) word = word << 8 | static_cast<unsigned char>(bytes[at + i - 1]);
  return word;
}

bool is_binary(const std::string& bytes) { return bytes.starts_with("glTF"); }

/// The text of a .gltf file, or of the first chunk of a .glb.
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

/// What is asked of the text before tinygltf may read it: that it is JSON and not nested too deep, which would
/// crash it; that its buffers are not too large together; and that it needs no extension that we lack.
bool check_json(const graph::Document& document, Refusal& refusal) {
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
    for (const Json& extension : required->items) {
      const std::string& name = extension.string;
      if (name.starts_with("KHR_materials_") || name.starts_with("KHR_texture_") ||
          name.starts_with("EXT_texture_") || name == "KHR_lights_punctual") {
        continue;
      }
      return refusal.refuse("it needs the extension " + quote(name));
    }
  }
  return true;
}

/// tinygltf may throw: it looks into vectors with at().
bool load_model(const std::string& bytes, Files& files, ImageBytes& images, tinygltf::Model& model,
                Refusal& refusal) {
  std::string errors, warnings;
  bool good = false;
  try {
    tinygltf::TinyGLTF loader;
    loader.SetFsCallbacks({Files::exists, Files::expand, Files::read, Files::write, &files});
    loader.SetImageLoader(keep_image, &images);
    const auto size = static_cast<unsigned int>(bytes.size());
    good = is_binary(bytes)
               ? loader.LoadBinaryFromMemory(&model, &errors, &warnings,
                                             reinterpret_cast<const unsigned char*>(bytes.data()), size,
                                             files.folder)
               : loader.LoadASCIIFromString(&model, &errors, &warnings, bytes.data(), size, files.folder);
  } catch (const std::exception& exception) {
    errors = exception.what();
    good = false;
  }
  while (!errors.empty() && (errors.back() == '\n' || errors.back() == ' ')) errors.pop_back();
  if (!good) refusal.refuse(errors.empty() ? "it is no glTF" : errors);
  return good;
}

}  // namespace

std::optional<GltfModel> load_gltf(const std::string& path, const support::Span& where,
                                   Diagnostics& diagnostics) {
  Id id;
  std::string reason;
  const auto bytes = read_bytes(path, max_gltf_bytes, id, reason);
  if (!bytes) {
    diagnostics.report(id, where, "cannot read " + quote(path) + ": " + reason);
    return std::nullopt;
  }
  Refusal refusal;
  Files files;
  files.folder = fs::path(graph::canonical_path(path)).parent_path().string();
  std::optional<GltfModel> result;
  if (auto json = json_of(*bytes, refusal)) {
    // A chunk is filled up with blanks; some writers fill it with zeros.
    while (!json->empty() && json->back() == '\0') json->pop_back();
    const auto document =
        graph::parse_document(std::make_shared<support::SourceFile>(path, *std::move(json)), diagnostics);
    if (!document) return std::nullopt;
    const lanes::FpGuard guard;
    tinygltf::Model model;
    ImageBytes images;
    if (check_json(*document, refusal) && load_model(*bytes, files, images, model, refusal))
      result = build_gltf(model, refusal);
    if (result) {
      for (GltfPart& part : result->parts) {
        if (part.material_index < 0) continue;
        part.material =
            read_material(model, part.material_index, graph::canonical_path(path), images, refusal);
      }
    }
  }
  if (!refusal.refused()) return result;
  if (!files.outside.empty()) {
    diagnostics.report(Id::outside_reference, where,
                       quote(path) + " refers to " + quote(files.outside) + ", outside of its folder");
  } else {
    diagnostics.report(Id::bad_mesh, where,
                       quote(path) + " is no mesh: " + support::visible(refusal.reason()));
  }
  return std::nullopt;
}

}  // namespace isoshade::scene
