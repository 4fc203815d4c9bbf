// SPDX-License-Identifier: Apache-2.0
#include "runtime/compare/golden.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <fcntl.h>
#include <filesystem>
#include <sys/file.h>
#include <thread>
#include <unistd.h>

#include "compiler/graph/files.h"
#include "compiler/graph/reader.h"
#include "compiler/support/visible.h"
#include "runtime/scene/output_file.h"
#include "runtime/scene/scene.h"

namespace isoshade::compare {

using graph::Document;
using graph::Json;
using graph::Member;
using support::Diagnostics;
using support::Id;
using support::quote;

namespace {

std::string read_hash(const Document& document, graph::ObjectReader& reader, std::string_view key,
                      const Json& golden, Diagnostics& diagnostics) {
  std::string hash = reader.string(key);
  const bool fits = hash.size() == 64 && std::all_of(hash.begin(), hash.end(), [](char c) {
                      return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
                    });
  if (!fits && golden.find(key) != nullptr) {
    diagnostics.report(Id::out_of_range, document.span(*golden.find(key)),
                       quote(key) + " is not a hash of 64 lower-case hexadecimal digits");
  }
  return hash;
}

Golden read_golden(const Document& document, const Json& json, Diagnostics& diagnostics) {
  Golden golden;
  graph::ObjectReader reader(document, json, "a golden", diagnostics);
  const auto size = reader.numbers<2>("size", {1, scene::max_size});
  golden.width = static_cast<int>(size[0]);
  golden.height = static_cast<int>(size[1]);
  golden.image = read_hash(document, reader, "image", json, diagnostics);
  golden.encoded = read_hash(document, reader, "encoded", json, diagnostics);
  reader.finish();
  return golden;
}

bool check_object(const Document& document, const Json& json, std::string_view what,
                  Diagnostics& diagnostics) {
  if (json.kind == Json::Kind::object) return true;
  diagnostics.report(Id::wrong_type, document.span(json),
                     std::string(what) + " is an object, not " + std::string(graph::kind_name(json.kind)));
  return false;
}

std::string json_string(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "\"";
}

/// Locks a folder against other processes. Locking the folder itself needs no lock file that could be left behind.
class FolderLock {
 public:
  explicit FolderLock(const std::string& folder)
      : descriptor_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    if (descriptor_ < 0) return;  // the write that follows reports the error
    constexpr int most_attempts = 600;
    for (int attempt = 0; attempt < most_attempts; ++attempt) {
      // Without a lock if the file system does not support them.
      held_by_another_ = flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
      if (!held_by_another_) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }
  ~FolderLock() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  bool is_held_by_another() const { return held_by_another_; }

 private:
  int descriptor_;
  bool held_by_another_ = false;
};

std::string size_text(const Golden& golden) {
  return std::to_string(golden.width) + " x " + std::to_string(golden.height);
}

}  // namespace

std::string golden_key(const std::string& scene_path, const std::string& golden_path) {
  namespace fs = std::filesystem;
  const auto folder_of = [](const std::string& path) {
    return fs::path(graph::canonical_path(fs::path(path).parent_path().string()));
  };
  const fs::path folder = folder_of(scene_path).lexically_relative(folder_of(golden_path));
  return (folder / fs::path(scene_path).filename()).lexically_normal().generic_string();
}

std::optional<Goldens> read_goldens(const std::string& path, Diagnostics& diagnostics) {
  const size_t errors_before = diagnostics.error_count();
  const support::Source source = graph::read_source(path, diagnostics);
  const auto document = source ? graph::parse_document(source, diagnostics) : std::nullopt;
  if (!document || !check_object(*document, document->root, "a golden file", diagnostics))
    return std::nullopt;
  Goldens goldens;
  for (const Member& scene : document->root.members) {
    if (!check_object(*document, scene.value, "the entry of a scene", diagnostics)) continue;
    for (const Member& tier : scene.value.members)
      goldens[scene.key][tier.key] = read_golden(*document, tier.value, diagnostics);
  }
  if (diagnostics.error_count() != errors_before) return std::nullopt;
  return goldens;
}

std::string goldens_text(const Goldens& goldens) {
  std::string text = "{";
  const char* scene_separator = "\n";
  for (const auto& [scene, tiers] : goldens) {
    text += scene_separator + ("  " + json_string(scene)) + ": {";
    const char* tier_separator = "\n";
    for (const auto& [tier, golden] : tiers) {
      text += tier_separator + ("    " + json_string(tier)) + ": {\n";
      text +=
          "      \"size\": [" + std::to_string(golden.width) + ", " + std::to_string(golden.height) + "],\n";
      text += "      \"image\": \"" + golden.image + "\",\n";
      text += "      \"encoded\": \"" + golden.encoded + "\"\n    }";
      tier_separator = ",\n";
    }
    text += "\n  }";
    scene_separator = ",\n";
  }
  return text + "\n}\n";
}

bool update_goldens(const std::string& path, const Goldens& changes, Diagnostics& diagnostics) {
  namespace fs = std::filesystem;
  const std::string target = graph::canonical_path(path);
  const FolderLock lock(fs::path(target).parent_path().string());
  if (lock.is_held_by_another()) {
    diagnostics
        .report(Id::unwritable_file,
                "cannot write " + quote(path) + ": another process holds a lock on its folder")
        .suggest("end that process, or try again");
    return false;
  }
  Goldens goldens;
  if (std::error_code error; fs::exists(target, error)) {
    auto recorded = read_goldens(target, diagnostics);
    if (!recorded) return false;
    goldens = *std::move(recorded);
  }
  for (const auto& [scene, tiers] : changes)
    for (const auto& [tier, golden] : tiers) goldens[scene][tier] = golden;
  return scene::write_file(path, goldens_text(goldens), diagnostics);
}

std::string golden_mismatch(const Goldens& goldens, const std::string& key, const std::string& tier,
                            const Golden& found) {
  const auto scene = goldens.find(key);
  if (scene == goldens.end()) return "no golden is recorded for " + quote(key);
  const auto recorded = scene->second.find(tier);
  if (recorded == scene->second.end())
    return "no golden is recorded for " + quote(key) + " at precision " + quote(tier);
  const Golden& golden = recorded->second;
  if (golden.width != found.width || golden.height != found.height)
    return "the golden was recorded at " + size_text(golden) + ", not at " + size_text(found);
  if (golden.image != found.image) return "the image is " + found.image + ", the golden " + golden.image;
  if (golden.encoded != found.encoded)
    return "the encoded image is " + found.encoded + ", the golden " + golden.encoded;
  return {};
}

}  // namespace isoshade::compare
