// SPDX-License-Identifier: Apache-2.0
#include "runtime/environment/environment.h"

#include <bit>
#include <cstring>
#include <span>

#include "backends/cache.h"
#include "compiler/ir/printer.h"
#include "compiler/support/sha256.h"
#include "compiler/support/visible.h"
#include "runtime/environment/sky.h"
#include "runtime/scene/image_file.h"

namespace isoshade::environment {
namespace {

using backends::Cache;
using support::Diagnostics;

/// To be raised by whoever changes the maps of an environment.
constexpr std::string_view version = "isoshade environment 1";

static_assert(std::endian::native == std::endian::little, "entries of the cache hold floats as they are in memory");

/// The sides of the maps, with their borders, in order.
std::vector<int> widths(bool sharp_only) {
  std::vector<int> widths;
  for (int level = 0; level < functions::environment_levels; ++level)
    widths.push_back(level > 0 && sharp_only ? 1 : functions::environment_sides[level]);
  widths.push_back(sharp_only ? 1 : functions::irradiance_side);
  for (int& width : widths) width += 2 * functions::environment_border;
  return widths;
}

std::string to_bytes(const Maps& maps) {
  std::string bytes;
  for (const scene::TextureLevel& map : maps)
    bytes.append(reinterpret_cast<const char*>(map.texels.data()), map.texels.size() * sizeof(float));
  return bytes;
}

std::optional<Maps> from_bytes(const std::string& bytes, bool sharp_only) {
  Maps maps;
  size_t next = 0;
  for (const int width : widths(sharp_only)) {
    std::vector<float> texels(static_cast<size_t>(channels * width * width));
    const size_t size = texels.size() * sizeof(float);
    if (bytes.size() - next < size) return std::nullopt;
    std::memcpy(texels.data(), bytes.data() + next, size);
    next += size;
    maps.push_back({width, width, std::move(texels)});
  }
  return next == bytes.size() ? std::optional(std::move(maps)) : std::nullopt;
}

/// The maps of which only the first is made.
Maps sharp_maps(Pyramid pyramid) {
  fill_border(pyramid.level(0), functions::environment_side);
  Maps maps;
  for (const int width : widths(true))
    maps.push_back({width, width, std::vector<float>(static_cast<size_t>(maps.empty() ? 0 : channels * width * width))});
  pyramid.texels.resize(static_cast<size_t>(channels * maps[0].width * maps[0].width));  // of level 0, which comes first
  maps[0].texels = std::move(pyramid.texels);
  return maps;
}

/// What maps are made of.
class Source {
 public:
  /// Reads what decides the key. False after an error, which is reported.
  bool read(const scene::Environment& environment, const Options& options, Diagnostics& diagnostics) {
    hash_.add(version).add(options.sharp_only ? " sharp" : "");
    for (const float number : {environment.rotate, environment.intensity})
      hash_.add("\n" + std::to_string(std::bit_cast<uint32_t>(number)));
    if (environment.file.empty()) {
      program_ = sky_program(environment.sky, *options.library, diagnostics);
      if (!program_) return false;
      hash_.add("\nsky " + std::to_string(program_->entry) + "\n").add(ir::print(program_->module));
      return true;
    }
    auto bytes = scene::read_image_file(environment.file, diagnostics, environment.file_where);
    if (!bytes) return false;
    bytes_ = *std::move(bytes);
    const auto header = scene::read_header(environment.file, bytes_, diagnostics, environment.file_where);
    if (!header) return false;
    const int64_t size = int64_t{channels} * 4 * header->width * header->height;
    if (size > max_image_bytes) {
      diagnostics
          .report(support::Id::too_large, environment.file_where,
                  "the image " + support::quote(environment.file) + " of the environment has " +
                      std::to_string(header->width) + " x " + std::to_string(header->height) + " pixels; it takes " +
                      std::to_string(size) + " bytes, and at most " + std::to_string(max_image_bytes) + " are allowed")
          .suggest("use a smaller image: 2048 x 1024 pixels have all detail that the maps keep");
      return false;
    }
    hash_.add("\nfile\n").add(bytes_);
    return true;
  }

  std::string key() const { return hash_.hex(); }
  bool is_sky() const { return program_.has_value(); }

  std::optional<Pyramid> paint(const scene::Environment& environment, const PrefilterOptions& options,
                               Diagnostics& diagnostics) const {
    std::optional<Pyramid> made;
    if (program_) {
      made = paint_sky(environment.sky, *program_, environment.rotate, environment.intensity, options);
    } else {
      auto image = scene::read_image(environment.file, bytes_, diagnostics, environment.file_where);
      if (!image) return std::nullopt;
      const bool srgb = image->has_bytes();
      made = project(scene::linear_level(*std::move(image), srgb), environment.rotate, environment.intensity, options);
    }
    return made;
  }

 private:
  mutable support::Sha256 hash_;
  std::optional<driver::Program> program_;
  std::string bytes_;
};

}  // namespace

std::optional<Made> make_environment(const scene::Environment& environment, const Options& options,
                                     Diagnostics& diagnostics) {
  Source source;
  if (!source.read(environment, options, diagnostics)) return std::nullopt;
  const std::string entry = Cache::entry_name(source.key(), backends::EntryKind::maps);
  // A folder that is unsafe or cannot be written is reported by whoever keeps code in it.
  Diagnostics unheard;
  // The sharp map of a sky is made sooner than its checksum.
  const bool is_quick = options.sharp_only && source.is_sky();
  const std::optional<Cache> cache = is_quick ? std::nullopt : Cache::open(options.cache, unheard);
  if (cache)
    if (const auto bytes = cache->read(entry))
      if (auto maps = from_bytes(*bytes, options.sharp_only)) return Made{*std::move(maps), true};
  auto pyramid = source.paint(environment, options.prefilter, diagnostics);
  if (!pyramid) return std::nullopt;
  if (!options.sharp_only) fill_levels(*pyramid);
  Made made{options.sharp_only ? sharp_maps(*std::move(pyramid)) : prefilter(*pyramid, options.prefilter), false};
  if (cache) cache->keep(entry, to_bytes(made.maps));
  return made;
}

}  // namespace isoshade::environment
