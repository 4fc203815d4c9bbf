// SPDX-License-Identifier: Apache-2.0
// OpenEXR files that the tests make, by its library.
#pragma once

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfTiledOutputFile.h>
#include <ImfTiledOutputPart.h>
#include <algorithm>
#include <cstring>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace isoshade::testing {

class ExrMemory : public Imf::OStream {
 public:
  ExrMemory() : OStream("") {}
  void write(const char* data, int size) override {
    bytes.resize(std::max(bytes.size(), at_ + static_cast<size_t>(size)));
    std::memcpy(bytes.data() + at_, data, static_cast<size_t>(size));
    at_ += static_cast<size_t>(size);
  }
  uint64_t tellp() override { return at_; }
  void seekp(uint64_t at) override { at_ = at; }
  std::string bytes;

 private:
  size_t at_ = 0;
};

/// Reads what ExrMemory has.
class ExrInput : public Imf::IStream {
 public:
  explicit ExrInput(std::string bytes) : IStream(""), bytes_(std::move(bytes)) {}
  bool read(char* to, int size) override {
    const auto count = static_cast<size_t>(size);
    if (count > bytes_.size() - at_) throw std::runtime_error("the file ends early");
    std::memcpy(to, bytes_.data() + at_, count);
    at_ += count;
    return at_ < bytes_.size();
  }
  uint64_t tellg() override { return at_; }
  void seekg(uint64_t at) override { at_ = at; }

 private:
  std::string bytes_;
  size_t at_ = 0;
};

struct ExrChannel {
  std::string name;
  Imf::PixelType type = Imf::HALF;
  int sampling = 1;
};

struct ExrPart {
  Imath::Box2i display{{0, 0}, {7, 4}};
  std::optional<Imath::Box2i> data;  ///< none: the display window
  Imf::Compression compression = Imf::ZIP_COMPRESSION;
  std::vector<ExrChannel> channels{{"R"}, {"G"}, {"B"}};
  std::optional<Imf::TileDescription> tiles;
  std::optional<Imf::Chromaticities> chromaticities;
  Imf::LineOrder order = Imf::INCREASING_Y;
  std::string name;  ///< only of several parts
  /// Of a channel by its number above, and a pixel.
  std::function<float(size_t, int, int)> value = [](size_t channel, int x, int y) {
    return static_cast<float>(channel) + static_cast<float>(x) / 8 + static_cast<float>(y) / 64;
  };

  Imath::Box2i window() const { return data.value_or(display); }
};

/// The samples of a part, as its channels have them.
class ExrSamples {
 public:
  explicit ExrSamples(const ExrPart& part) {
    const Imath::Box2i window = part.window();
    for (size_t c = 0; c < part.channels.size(); ++c) {
      const ExrChannel& channel = part.channels[c];
      const int step = channel.sampling;
      const size_t bytes = channel.type == Imf::HALF ? 2 : 4;
      std::string& plane = planes_.emplace_back();
      for (int y = window.min.y; y <= window.max.y; y += step)
        for (int x = window.min.x; x <= window.max.x; x += step)
          append(plane, channel.type, part.value(c, x, y));
      const auto width = static_cast<size_t>((window.max.x - window.min.x + step) / step);
      strides_.push_back({bytes, bytes * width});
    }
    for (size_t c = 0; c < part.channels.size(); ++c)
      buffer.insert(
          part.channels[c].name,
          Imf::Slice::Make(part.channels[c].type, planes_[c].data(), window, strides_[c].first,
                           strides_[c].second, part.channels[c].sampling, part.channels[c].sampling));
  }
  Imf::FrameBuffer buffer;

 private:
  static void append(std::string& plane, Imf::PixelType type, float value) {
    const half small(type == Imf::HALF ? value : 0.0f);
    const auto whole = static_cast<uint32_t>(type == Imf::UINT ? value : 0.0f);
    const void* from = type == Imf::HALF ? static_cast<const void*>(&small) : &whole;
    if (type == Imf::FLOAT) from = &value;
    plane.append(static_cast<const char*>(from), type == Imf::HALF ? 2 : 4);
  }
  std::vector<std::string> planes_;
  std::vector<std::pair<size_t, size_t>> strides_;
};

inline Imf::Header exr_header(const ExrPart& part) {
  Imf::Header header(part.display, part.window());
  header.compression() = part.compression;
  header.lineOrder() = part.order;
  for (const ExrChannel& channel : part.channels)
    header.channels().insert(channel.name, Imf::Channel(channel.type, channel.sampling, channel.sampling));
  if (part.tiles) header.setTileDescription(*part.tiles);
  if (part.chromaticities) Imf::addChromaticities(header, *part.chromaticities);
  if (!part.name.empty()) header.setName(part.name);
  return header;
}

/// All levels of a tiled file have the pixels of the largest.
template <class File>
void write_tiles(File& file, const ExrSamples& samples) {
  file.setFrameBuffer(samples.buffer);
  for (int ly = 0; ly < file.numYLevels(); ++ly)
    for (int lx = 0; lx < file.numXLevels(); ++lx)
      if (file.isValidLevel(lx, ly))
        file.writeTiles(0, file.numXTiles(lx) - 1, 0, file.numYTiles(ly) - 1, lx, ly);
}

template <class File>
void write_rows(File& file, const ExrSamples& samples, const ExrPart& part) {
  file.setFrameBuffer(samples.buffer);
  file.writePixels(part.window().max.y - part.window().min.y + 1);
}

inline std::string exr_file(const ExrPart& part) {
  ExrMemory memory;
  const ExrSamples samples(part);
  if (part.tiles) {
    Imf::TiledOutputFile file(memory, exr_header(part), 0);
    write_tiles(file, samples);
  } else {
    Imf::OutputFile file(memory, exr_header(part), 0);
    write_rows(file, samples, part);
  }
  return memory.bytes;
}

inline std::string exr_file(const std::vector<ExrPart>& parts) {
  ExrMemory memory;
  std::vector<Imf::Header> headers;
  for (const ExrPart& part : parts) {
    headers.push_back(exr_header(part));
    headers.back().setType(part.tiles ? Imf::TILEDIMAGE : Imf::SCANLINEIMAGE);
  }
  {
    Imf::MultiPartOutputFile file(memory, headers.data(), static_cast<int>(headers.size()), true, 0);
    for (size_t i = 0; i < parts.size(); ++i) {
      const ExrSamples samples(parts[i]);
      if (parts[i].tiles) {
        Imf::TiledOutputPart output(file, static_cast<int>(i));
        write_tiles(output, samples);
      } else {
        Imf::OutputPart output(file, static_cast<int>(i));
        write_rows(output, samples, parts[i]);
      }
    }
  }
  return memory.bytes;
}

}  // namespace isoshade::testing
