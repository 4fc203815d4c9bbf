// SPDX-License-Identifier: Apache-2.0
// APNG, whose chunks surround the data of PNG files, and GIF through giflib.
#include "runtime/scene/animation_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <gif_lib.h>
#include <new>

#include "compiler/support/assert.h"
#include "runtime/scene/image_file.h"

namespace isoshade::scene {
namespace {

/// For how many steps of time each picture is shown, so that all together last as long as they should. Two bytes hold a
/// number of steps.
class Steps {
 public:
  /// `least`: what players heed.
  Steps(double seconds, double per_second, double least) : each_(seconds * per_second), least_(least) {}
  int next() {
    const double due = std::round(++count_ * each_) - shown_;
    const double steps = std::clamp(due, least_, 65535.0);
    shown_ += steps;
    return static_cast<int>(steps);
  }

 private:
  double each_, least_, shown_ = 0, count_ = 0;
};

void append(std::string& bytes, uint32_t value, int count) {
  for (int i = count - 1; i >= 0; --i) bytes += static_cast<char>(value >> (8 * i) & 255);
}

/// PNG, third edition, W3C 2025: acTL before the data; fcTL before that of each picture; the data of all but the first in
/// fdAT, with numbers that count fcTL and fdAT together.
std::string apng(std::span<const std::vector<std::string>> pictures, int width, int height, double seconds) {
  Steps steps(seconds, 1000, 1);
  std::string file = png_head(width, height, true);
  std::string control;
  append(control, static_cast<uint32_t>(pictures.size()), 4);
  append(control, 0, 4);  // forever
  file += png_chunk("acTL", control);
  uint32_t number = 0;
  for (size_t i = 0; i < pictures.size(); ++i) {
    control.clear();
    for (const uint32_t word : {number++, static_cast<uint32_t>(width), static_cast<uint32_t>(height), 0u, 0u})
      append(control, word, 4);
    append(control, static_cast<uint32_t>(steps.next()), 2);
    append(control, 1000, 2);
    append(control, 0, 2);  // it stays, and replaces what was there
    file += png_chunk("fcTL", control);
    for (const std::string& data : pictures[i]) {
      std::string numbered;
      if (i > 0) append(numbered, number++, 4);
      file += png_chunk(i == 0 ? "IDAT" : "fdAT", numbered.append(data));
    }
  }
  return file + png_chunk("IEND", "");
}

// The palette: 6 x 7 x 6 levels of red, green and blue, and nothing.
constexpr int red_levels = 6, green_levels = 7, blue_levels = 6;
constexpr int transparent = red_levels * green_levels * blue_levels, palette_size = 256;

/// 0 to 63, the ordered dither of Bayer, 1973.
int threshold(int x, int y) {
  int value = 0;
  for (int bit = 0; bit < 3; ++bit) value |= (((x ^ y) >> bit & 1) << (5 - 2 * bit)) | ((y >> bit & 1) << (4 - 2 * bit));
  return value;
}

/// The level below or above a value, in proportion.
int level_of(uint8_t value, int levels, int limit) { return (value * (levels - 1) * 64 + (2 * limit + 1) * 255 / 2) / (255 * 64); }

void must(int result) {
  // What can fail is allocating memory: the bytes go to a string.
  if (result == GIF_ERROR) throw std::bad_alloc();
}

}  // namespace

class AnimationFile::Gif {
 public:
  Gif(int width, int height, double seconds)
      : width_(width), height_(height), steps_(seconds, 100, 2), row_(static_cast<size_t>(width)) {
    int error = 0;
    file_ = EGifOpen(&bytes_, write, &error);
    map_ = GifMakeMapObject(palette_size, nullptr);
    if (file_ == nullptr || map_ == nullptr) throw std::bad_alloc();
    for (int i = 0; i < transparent; ++i) {
      const auto part = [](int level, int levels) { return static_cast<GifByteType>(level * 255 / (levels - 1)); };
      map_->Colors[i] = {part(i / (green_levels * blue_levels), red_levels),
                         part(i / blue_levels % green_levels, green_levels), part(i % blue_levels, blue_levels)};
    }
    EGifSetGifVersion(file_, true);
    must(EGifPutScreenDesc(file_, width, height, 8, transparent, map_));
    const GifByteType forever[] = {1, 0, 0};
    must(EGifPutExtensionLeader(file_, APPLICATION_EXT_FUNC_CODE));
    must(EGifPutExtensionBlock(file_, 11, "NETSCAPE2.0"));
    must(EGifPutExtensionBlock(file_, sizeof forever, forever));
    must(EGifPutExtensionTrailer(file_));
  }
  ~Gif() {
    int error = 0;
    if (file_ != nullptr) EGifCloseFile(file_, &error);
    GifFreeMapObject(map_);
  }
  Gif(const Gif&) = delete;
  Gif& operator=(const Gif&) = delete;

  void add(std::span<const uint8_t> rgba) {
    const GraphicsControlBlock control{DISPOSE_BACKGROUND, false, steps_.next(), transparent};
    GifByteType block[4];
    const size_t size = EGifGCBToExtension(&control, block);
    must(EGifPutExtension(file_, GRAPHICS_EXT_FUNC_CODE, static_cast<int>(size), block));
    must(EGifPutImageDesc(file_, 0, 0, width_, height_, false, nullptr));
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        const uint8_t* const pixel = &rgba[4 * (static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x))];
        const int limit = threshold(x, y);
        const int color = (level_of(pixel[0], red_levels, limit) * green_levels + level_of(pixel[1], green_levels, limit)) * blue_levels +
                          level_of(pixel[2], blue_levels, limit);
        row_[static_cast<size_t>(x)] = static_cast<GifPixelType>(pixel[3] < 128 ? transparent : color);
      }
      must(EGifPutLine(file_, row_.data(), width_));
    }
  }

  std::string finish() {
    int error = 0;
    GifFileType* const file = file_;
    file_ = nullptr;
    must(EGifCloseFile(file, &error));
    return std::move(bytes_);
  }

 private:
  static int write(GifFileType* file, const GifByteType* bytes, int count) {
    static_cast<std::string*>(file->UserData)->append(reinterpret_cast<const char*>(bytes), static_cast<size_t>(count));
    return count;
  }

  int width_, height_;
  Steps steps_;
  std::vector<GifPixelType> row_;
  std::string bytes_;
  GifFileType* file_ = nullptr;
  ColorMapObject* map_ = nullptr;
};

std::optional<AnimationFormat> animation_format_of(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".apng" || extension == ".APNG") return AnimationFormat::apng;
  if (extension == ".gif" || extension == ".GIF") return AnimationFormat::gif;
  return std::nullopt;
}

AnimationFile::AnimationFile(AnimationFormat format, int width, int height, double seconds, int threads)
    : format_(format), width_(width), height_(height), seconds_(seconds), threads_(threads) {
  if (format == AnimationFormat::gif) gif_ = std::make_unique<Gif>(width, height, seconds);
}

AnimationFile::~AnimationFile() = default;

void AnimationFile::add(std::span<const uint8_t> rgba) {
  switch (format_) {
    case AnimationFormat::apng: pictures_.push_back(png_data(width_, height_, rgba, true, threads_)); return;
    case AnimationFormat::gif: gif_->add(rgba); return;
  }
}

std::string AnimationFile::finish() {
  switch (format_) {
    case AnimationFormat::apng: return apng(pictures_, width_, height_, seconds_);
    case AnimationFormat::gif: return gif_->finish();
  }
  support::bug("no such format");
}

}  // namespace isoshade::scene
