// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <memory>
#include <utility>

#include "compiler/graph/files.h"
#include "compiler/support/visible.h"
#include "runtime/lanes/float_rules.h"
#include "runtime/scene/gltf_parts.h"

namespace isoshade::scene {

using support::Diagnostics;
using support::Id;
using support::quote;

namespace {

namespace fs = std::filesystem;

/// The files that tinygltf may read: those of buffers, in or below one folder, up to a total size. Image files are
/// read when a material needs them.
struct Files {
  std::string folder;  ///< canonical
  size_t bytes_left = max_gltf_bytes;
  std::string outside;  ///< a path outside of the folder

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
    const auto [bytes, id, reason] = support::read_file(path, files.bytes_left);
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

/// Keeps an image encoded: only images that a material needs are decoded. An image in a buffer is not checked yet;
/// read_gltf_image does it.
bool keep_image(tinygltf::Image* image, int index, std::string*, std::string*, int, int,
                const unsigned char* bytes, int size, void* kept) {
  if (image->bufferView < 0 && size > 0)
    static_cast<ImageBytes*>(kept)->by_index[index] =
        std::make_shared<const std::string>(reinterpret_cast<const char*>(bytes), static_cast<size_t>(size));
  return true;
}

/// tinygltf may throw: it accesses vectors with at().
bool load_model(const std::string& bytes, const graph::Document& document, Files& files, ImageBytes& images,
                tinygltf::Model& model, Refusal& refusal) {
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
  if (!good && check_buffers(document, refusal)) refusal.refuse(errors.empty() ? "it is not a glTF" : errors);
  return good;
}

}  // namespace

void Refusal::report(const std::string& file, const support::Span& where, Diagnostics& diagnostics) const {
  diagnostics.report(id_, where,
                     (part_.empty() ? "cannot read the mesh " : "cannot read " + part_ + " of ") +
                         quote(file) + ": " + support::visible(reason_));
}

std::optional<Model> load_gltf(const std::string& path, const support::Span& where,
                               Diagnostics& diagnostics) {
  const auto [bytes, id, reason] = support::read_file(path, max_gltf_bytes);
  if (!bytes) {
    diagnostics.report(id, where, "cannot read " + quote(path) + ": " + reason);
    return std::nullopt;
  }
  Refusal refusal;
  Files files;
  files.folder = fs::path(graph::canonical_path(path)).parent_path().string();
  std::optional<Model> result;
  if (auto json = json_of(*bytes, refusal)) {
    // Chunks are padded with blanks, by some writers with zeros.
    while (!json->empty() && json->back() == '\0') json->pop_back();
    const auto document =
        graph::parse_document(std::make_shared<support::SourceFile>(path, *std::move(json)), diagnostics);
    if (!document) return std::nullopt;
    const lanes::FpGuard guard;
    tinygltf::Model model;
    ImageBytes images{path, files.folder, {}, 0};
    if (check_json(*document, refusal) && load_model(*bytes, *document, files, images, model, refusal))
      result = build_gltf(model, refusal);
    if (result) {
      warn_ignored(*document, path, where, diagnostics);
      for (ModelPart& part : result->parts)
        if (part.material_index >= 0)
          part.material = read_material(model, part.material_index, images, refusal);
    }
  }
  if (!refusal.refused()) return result;
  if (!files.outside.empty()) {
    diagnostics.report(Id::outside_reference, where,
                       quote(path) + " refers to " + quote(files.outside) + ", outside of its folder");
  } else {
    refusal.report(path, where, diagnostics);
  }
  return std::nullopt;
}

}  // namespace isoshade::scene
