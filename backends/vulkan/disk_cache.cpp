// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/disk_cache.h"

#include <cstring>
#include <initializer_list>

#include "compiler/support/sha256.h"

namespace isoshade::vulkan {

namespace {

using backends::Cache;
using backends::EntryKind;

/// Unambiguous: the length of each part is hashed before it.
std::string entry(EntryKind kind, std::initializer_list<std::string_view> parts) {
  support::Sha256 hash;
  for (const std::string_view part : parts) hash.add(std::to_string(part.size())).add(":").add(part);
  return Cache::entry_name(hash.hex(), kind);
}

std::string probe_entry(std::string_view device) {
  return entry(EntryKind::probe, {device, hash_of_probe_sources(), glsl::spirv_compiler()});
}

std::optional<Cache> open_lasting(const std::string& folder) {
  // A folder that is unsafe or cannot be written is reported by whoever keeps code in it.
  support::Diagnostics unheard;
  std::optional<Cache> cache = Cache::open(folder, unheard);
  if (cache && !cache->is_lasting()) return std::nullopt;
  return cache;
}

}  // namespace

DiskCache::DiskCache(const std::string& folder) : cache_(open_lasting(folder)) {}

std::optional<std::vector<uint32_t>> DiskCache::spirv(const std::string& glsl, glsl::ShaderKind kind,
                                                      support::Diagnostics& diagnostics,
                                                      const std::string& what) const {
  constexpr uint32_t magic = 0x07230203;
  if (!cache_) return glsl::compile_spirv(glsl, kind, diagnostics, what);
  const std::string name = entry(EntryKind::spirv, {glsl::spirv_compiler(), glsl::name(kind), glsl});
  if (const auto bytes = cache_->read(name); bytes && bytes->size() % sizeof(uint32_t) == 0) {
    std::vector<uint32_t> words(bytes->size() / sizeof(uint32_t));
    std::memcpy(words.data(), bytes->data(), bytes->size());
    if (words[0] == magic) return words;
  }
  auto words = glsl::compile_spirv(glsl, kind, diagnostics, what);
  if (words) cache_->keep(name, {reinterpret_cast<const char*>(words->data()), words->size() * sizeof(uint32_t)});
  return words;
}

std::optional<Probe> DiskCache::probe(std::string_view device) const {
  if (!cache_) return std::nullopt;
  const auto text = cache_->read(probe_entry(device));
  auto probe = text ? probe_from_text(*text) : std::nullopt;
  if (probe) probe->cached = true;
  return probe;
}

void DiskCache::keep(const Probe& probe, std::string_view device) const {
  if (cache_ && probe.passed()) cache_->keep(probe_entry(device), to_text(probe));
}

std::string DiskCache::pipelines(std::string_view device) const {
  if (!cache_) return {};
  return cache_->read(entry(EntryKind::pipelines, {device})).value_or("");
}

void DiskCache::keep_pipelines(std::string_view bytes, std::string_view device) const {
  if (cache_ && bytes.size() <= max_pipeline_bytes) cache_->keep(entry(EntryKind::pipelines, {device}), bytes);
}

}  // namespace isoshade::vulkan
