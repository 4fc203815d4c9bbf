// SPDX-License-Identifier: Apache-2.0
#include "runtime/scene/exr_file.h"

#include <algorithm>
#include <bit>
#include <map>

#include "compiler/support/visible.h"
#include "runtime/scene/image_file.h"

namespace isoshade::scene::exr_file {
namespace {

constexpr uint32_t tiled_flag = 0x200, long_names_flag = 0x400, deep_flag = 0x800, multipart_flag = 0x1000;

/// Reads little-endian numbers. Beyond the end it returns zeros and is no longer ok.
class Cursor {
 public:
  explicit Cursor(std::string_view bytes) : bytes_(bytes) {}

  uint32_t u8() { return number(1); }
  uint32_t u32() { return number(4); }
  int32_t i32() { return static_cast<int32_t>(number(4)); }
  float f32() { return std::bit_cast<float>(number(4)); }
  std::string_view take(size_t count) {
    if (count > bytes_.size() - at_) {
      ok_ = false;
      at_ = bytes_.size();
      return {};
    }
    at_ += count;
    return bytes_.substr(at_ - count, count);
  }
  /// Reads up to and including a zero.
  std::string_view text() {
    const std::string_view rest = bytes_.substr(at_);
    const size_t end = rest.substr(0, 256).find('\0');
    if (end == std::string_view::npos) {
      ok_ = false;
      return {};
    }
    at_ += end + 1;
    return rest.substr(0, end);
  }
  bool ok() const { return ok_; }
  bool done() const { return ok_ && at_ == bytes_.size(); }
  size_t at() const { return at_; }

 private:
  uint32_t number(size_t size) {
    uint32_t value = 0;
    const std::string_view taken = take(size);
    for (size_t i = 0; i < taken.size(); ++i)
      value |= uint32_t{static_cast<unsigned char>(taken[i])} << (8 * i);
    return value;
  }

  std::string_view bytes_;
  size_t at_ = 0;
  bool ok_ = true;
};

struct Attribute {
  std::string_view type, value;
};
using Attributes = std::map<std::string_view, Attribute>;

const std::string damaged = "its header is damaged";

/// Whether the attribute exists and has this type.
const std::string_view* find(const Attributes& attributes, std::string_view name, std::string_view type) {
  const auto found = attributes.find(name);
  return found != attributes.end() && found->second.type == type ? &found->second.value : nullptr;
}

std::string read_attributes(Cursor& cursor, Attributes& attributes) {
  while (true) {
    const std::string_view name = cursor.text();
    if (!cursor.ok()) return damaged;
    if (name.empty()) return {};
    const std::string_view type = cursor.text();
    const uint32_t size = cursor.u32();
    const std::string_view value = cursor.take(size);
    if (!cursor.ok()) return damaged;
    if (attributes.size() == max_attributes)
      return "a header has more than " + std::to_string(max_attributes) + " attributes";
    if (!attributes.emplace(name, Attribute{type, value}).second)
      return "its header has " + support::quote(name) + " twice";
  }
}

std::optional<Window> read_window(const Attributes& attributes, std::string_view name) {
  const std::string_view* value = find(attributes, name, "box2i");
  if (value == nullptr) return std::nullopt;
  Cursor cursor(*value);
  Window window;
  for (int32_t* number : {&window.min_x, &window.min_y, &window.max_x, &window.max_y}) {
    *number = cursor.i32();
    if (*number < -max_coordinate || *number > max_coordinate) return std::nullopt;
  }
  if (!cursor.done() || window.width() < 1 || window.height() < 1) return std::nullopt;
  return window;
}

std::string read_channels(const Attributes& attributes, Part& part) {
  const std::string_view* value = find(attributes, "channels", "chlist");
  if (value == nullptr) return "its header has no channels";
  Cursor cursor(*value);
  while (true) {
    const std::string_view name = cursor.text();
    if (name.empty()) break;
    Channel channel{std::string(name)};
    const uint32_t type = cursor.u32();
    channel.linear = static_cast<uint8_t>(cursor.u8());
    cursor.take(3);
    channel.x_sampling = cursor.i32();
    channel.y_sampling = cursor.i32();
    if (!cursor.ok() || type > 2) return damaged;
    channel.type = static_cast<PixelType>(type);
    const auto fits = [&](int64_t sampling, int64_t first, int64_t count) {
      return sampling >= 1 && sampling <= max_data_side && first % sampling == 0 && count % sampling == 0 &&
             (sampling == 1 || !part.tiles);
    };
    if (!fits(channel.x_sampling, part.data.min_x, part.data.width()) ||
        !fits(channel.y_sampling, part.data.min_y, part.data.height()))
      return "the samples of its channel " + support::quote(name) + " do not fit its data window";
    part.channels.push_back(std::move(channel));
    if (part.channels.size() > max_channels)
      return "it has more than " + std::to_string(max_channels) + " channels";
  }
  if (!cursor.done() || part.channels.empty()) return damaged;
  // The pixels are in sorted order even if the writer did not sort the list.
  std::ranges::sort(part.channels, {}, &Channel::name);
  if (std::ranges::adjacent_find(part.channels, {}, &Channel::name) != part.channels.end())
    return "it has two channels of one name";
  return {};
}

std::string read_tiles(const Attributes& attributes, Part& part) {
  const std::string_view* value = find(attributes, "tiles", "tiledesc");
  if (value == nullptr) return "it is tiled, but its header does not state the size of the tiles";
  Cursor cursor(*value);
  Tiles tiles;
  tiles.width = cursor.u32();
  tiles.height = cursor.u32();
  const uint32_t mode = cursor.u8();
  tiles.level_mode = static_cast<uint8_t>(mode & 15);
  tiles.round_up = mode >> 4 == 1;
  constexpr uint32_t most = uint32_t{1} << 20;
  if (!cursor.done() || tiles.level_mode > 2 || mode >> 4 > 1) return damaged;
  if (tiles.width < 1 || tiles.height < 1 || tiles.width > most || tiles.height > most)
    return "the size of its tiles is out of range";
  part.tiles = tiles;
  return {};
}

/// The number of tiles along a side, for each level.
std::vector<int64_t> tiles_of_levels(int64_t side, int64_t tile, bool round_up, int levels) {
  std::vector<int64_t> counts;
  for (int level = 0; level < levels; ++level) {
    const int64_t rounding = round_up ? (int64_t{1} << level) - 1 : 0;
    const int64_t size = std::max<int64_t>(1, (side + rounding) >> level);
    counts.push_back((size + tile - 1) / tile);
  }
  return counts;
}

int level_count(int64_t side, bool round_up) {
  const auto whole = static_cast<uint64_t>(round_up ? side - 1 : side);
  return round_up ? std::bit_width(whole) + 1 : std::bit_width(whole);
}

int64_t count_chunks(const Part& part) {
  const int64_t width = part.data.width(), height = part.data.height();
  if (!part.tiles) {
    const int64_t rows = rows_per_chunk(part.compression);
    return (height + rows - 1) / rows;
  }
  const Tiles& tiles = *part.tiles;
  const bool up = tiles.round_up;
  int across_levels = 1, down_levels = 1;
  if (tiles.level_mode == 1) across_levels = down_levels = level_count(std::max(width, height), up);
  if (tiles.level_mode == 2) across_levels = level_count(width, up), down_levels = level_count(height, up);
  const auto across = tiles_of_levels(width, tiles.width, up, across_levels);
  const auto down = tiles_of_levels(height, tiles.height, up, down_levels);
  int64_t count = 0;
  for (size_t y = 0; y < down.size(); ++y)
    for (size_t x = 0; x < across.size(); ++x)
      if (tiles.level_mode != 1 || x == y) count += across[x] * down[y];
  return count;
}

std::string read_color(const Attributes& attributes, Part& part) {
  const auto found = attributes.find("chromaticities");
  if (found == attributes.end()) return {};
  if (found->second.type != "chromaticities") return damaged;
  Cursor cursor(found->second.value);
  Chromaticities all;
  for (auto* pair : {&all.red, &all.green, &all.blue, &all.white})
    for (float& number : *pair) number = cursor.f32();
  if (!cursor.done()) return damaged;
  part.chromaticities = all;
  return {};
}

/// Empty if the attributes describe a part; of a deep part only the number of chunks is read.
std::string describe(const Attributes& attributes, uint32_t flags, Part& part) {
  const std::string_view* type = find(attributes, "type", "string");
  const bool multipart = (flags & multipart_flag) != 0;
  if (multipart && type == nullptr) return "a part does not state its type";
  bool tiled = (flags & tiled_flag) != 0;
  if (type != nullptr && multipart) tiled = *type == "tiledimage";
  part.deep = multipart ? *type != "tiledimage" && *type != "scanlineimage" : (flags & deep_flag) != 0;
  if (const std::string_view* count = find(attributes, "chunkCount", "int"); count != nullptr) {
    Cursor cursor(*count);
    part.chunk_count = cursor.i32();
    if (!cursor.done() || part.chunk_count < 1) return damaged;
  } else if (multipart) {
    return "a part does not state the number of its chunks";
  }
  if (part.deep) return {};
  if (!multipart && type != nullptr && *type != (tiled ? "tiledimage" : "scanlineimage"))
    return "its header says that it is of the type " + support::quote(*type) +
           ", and its first bytes that it is not";
  const auto data = read_window(attributes, "dataWindow"), display = read_window(attributes, "displayWindow");
  if (!data || !display) return "its data window or its display window is missing or out of range";
  part.data = *data;
  part.display = *display;
  if (tiled)
    if (std::string reason = read_tiles(attributes, part); !reason.empty()) return reason;
  const std::string_view* compression = find(attributes, "compression", "compression");
  if (compression == nullptr || compression->size() != 1) return "its header does not state its compression";
  const auto code = static_cast<unsigned char>(compression->front());
  if (code > static_cast<unsigned char>(Compression::dwab)) return "its compression is unknown";
  part.compression = static_cast<Compression>(code);
  if (std::string reason = read_channels(attributes, part); !reason.empty()) return reason;
  if (std::string reason = read_color(attributes, part); !reason.empty()) return reason;
  if (part.data.width() <= max_data_side && part.data.height() <= max_data_side) {
    const int64_t chunks = count_chunks(part);
    if (part.chunk_count != 0 && part.chunk_count != chunks) return "the number of its chunks is wrong";
    part.chunk_count = chunks;
  }
  return {};
}

int find_channel(const Part& part, const std::string& name) {
  const auto found = std::ranges::find(part.channels, name, &Channel::name);
  return found == part.channels.end() ? -1 : static_cast<int>(found - part.channels.begin());
}

/// The channels of the image with this prefix: "" or "layer.".
std::optional<Picture> picture_of(const Part& part, const std::string& prefix) {
  Picture picture;
  for (size_t i = 0; i < 3; ++i) picture.colors[i] = find_channel(part, prefix + "RGB"[i]);
  const int grey = find_channel(part, prefix + "Y");
  if (std::ranges::find(picture.colors, -1) != picture.colors.end()) {
    if (grey < 0) return std::nullopt;
    picture.colors.fill(grey);
  }
  picture.alpha = find_channel(part, prefix + "A");
  picture.depth = find_channel(part, prefix + "Z");
  return picture;
}

/// The first layer, by name, that contains an image.
std::optional<Picture> picture_of_layer(const Part& part) {
  for (const Channel& channel : part.channels) {
    const size_t dot = channel.name.rfind('.');
    if (dot == std::string::npos) continue;
    if (auto picture = picture_of(part, channel.name.substr(0, dot + 1))) return picture;
  }
  return std::nullopt;
}

bool choose_part(Contents& contents) {
  for (const bool layers : {false, true}) {
    for (size_t i = 0; i < contents.parts.size(); ++i) {
      Part& part = contents.parts[i];
      if (part.deep) continue;
      const auto picture = layers ? picture_of_layer(part) : picture_of(part, "");
      if (!picture) continue;
      contents.part = i;
      part.picture = *picture;
      return true;
    }
  }
  return false;
}

int64_t bytes_per_pixel(const Part& part) {
  int64_t bytes = 0;
  for (const Channel& channel : part.channels) bytes += channel.type == PixelType::half ? 2 : 4;
  return bytes;
}

/// Empty if the chosen part can be read.
std::string refuse(const Part& part) {
  if (std::string reason = refuse_size(part.display.width(), part.display.height()); !reason.empty())
    return reason;
  if (part.data.width() > max_data_side || part.data.height() > max_data_side)
    return "a side of its data window has more than " + std::to_string(max_data_side) + " pixels";
  int64_t width = part.data.width(), height = rows_per_chunk(part.compression), chunks = part.chunk_count;
  if (part.tiles) {
    width = part.tiles->width;
    height = part.tiles->height;
    chunks = ((part.data.width() + width - 1) / width) * ((part.data.height() + height - 1) / height);
  }
  width = std::min(width, part.data.width());
  height = std::min(height, part.data.height());
  if (chunks > max_chunks) return "it has more than " + std::to_string(max_chunks) + " tiles";
  if (width * height * bytes_per_pixel(part) > max_chunk_bytes)
    return "a tile or block of rows has more than " + std::to_string(max_chunk_bytes >> 20) + " MiB";
  const Picture& picture = part.picture;
  for (const int i : {picture.colors[0], picture.colors[1], picture.colors[2], picture.alpha}) {
    if (i < 0) continue;
    const Channel& channel = part.channels[static_cast<size_t>(i)];
    if (channel.x_sampling != 1 || channel.y_sampling != 1)
      return "its channel " + support::quote(channel.name) + " has fewer samples than pixels";
  }
  const std::string& first = part.channels[static_cast<size_t>(picture.colors[0])].name;
  const std::string prefix = first.substr(0, first.size() - 1);
  if (first.ends_with('Y') &&
      (find_channel(part, prefix + "RY") >= 0 || find_channel(part, prefix + "BY") >= 0))
    return "it holds luminance and chroma (Y, RY and BY); write it with R, G and B";
  if (part.chromaticities && !to_rec709(*part.chromaticities).valid)
    return "its chromaticities are degenerate";
  return {};
}

}  // namespace

int rows_per_chunk(Compression compression) {
  switch (compression) {
    case Compression::none:
    case Compression::rle:
    case Compression::zips: return 1;
    case Compression::zip:
    case Compression::pxr24: return 16;
    case Compression::piz:
    case Compression::b44:
    case Compression::b44a:
    case Compression::dwaa: return 32;
    case Compression::dwab: return 256;
  }
  return 1;
}

Read<Contents> read_contents(std::string_view bytes) {
  Cursor cursor(bytes);
  cursor.take(4);  // checked by is_exr
  const uint32_t version = cursor.u32();
  constexpr uint32_t known = tiled_flag | long_names_flag | deep_flag | multipart_flag;
  if (!cursor.ok()) return {{}, damaged};
  if ((version & 255) != 2 || (version & ~known & ~255u) != 0)
    return {{}, "its version of OpenEXR is not supported"};
  Contents contents;
  contents.multipart = (version & multipart_flag) != 0;
  do {
    Attributes attributes;
    if (std::string reason = read_attributes(cursor, attributes); !reason.empty())
      return {{}, std::move(reason)};
    if (contents.multipart && attributes.empty()) break;
    if (contents.parts.size() == max_parts)
      return {{}, "it has more than " + std::to_string(max_parts) + " parts"};
    Part& part = contents.parts.emplace_back();
    if (std::string reason = describe(attributes, version, part); !reason.empty())
      return {{}, std::move(reason)};
  } while (contents.multipart);
  contents.tables = cursor.at();
  if (contents.parts.empty()) return {{}, damaged};
  if (std::ranges::all_of(contents.parts, &Part::deep)) return {{}, "it is deep: its pixels are lists"};
  if (!choose_part(contents)) return {{}, "it has neither channels R, G and B nor Y, nor a layer with them"};
  if (std::string reason = refuse(contents.read_part()); !reason.empty()) return {{}, std::move(reason)};
  return {std::move(contents), {}};
}

}  // namespace isoshade::scene::exr_file
