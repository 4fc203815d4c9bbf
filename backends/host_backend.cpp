// SPDX-License-Identifier: Apache-2.0
#include "backends/host_backend.h"

#include <algorithm>
#include <map>

#include "backends/resolve.h"
#include "compiler/support/assert.h"
#include "runtime/lanes/lanes.h"
#include "runtime/raster/bins.h"

namespace isoshade::backends {
namespace {

/// Copies of the images that are read.
struct CopiedLayers {
  std::vector<float> floats;
  std::vector<int32_t> records;

  CopiedLayers(std::span<const float> layers, int width, int height, std::span<const ImageRead> images) {
    std::map<size_t, size_t> places;  // the first float of a copy, by that of the original
    const auto copy = [&](size_t first, size_t size) {
      const auto [place, is_new] = places.try_emplace(first, floats.size());
      if (is_new) {
        const std::span<const float> copied = layers.subspan(first, size);
        floats.insert(floats.end(), copied.begin(), copied.end());
      }
      return place->second;
    };
    std::vector<ImageRead> copies(images.begin(), images.end());
    for (ImageRead& image : copies) {
      image.slot.first = image.slot.exists() ? copy(image.slot.first, image.slot.size()) : 0;
      if (image.camera != ImageRead::no_camera) image.camera = copy(image.camera, lower::view_word::camera_words);
    }
    records = image_records(width, height, copies);
  }
  Layers arrays() const { return {floats, records}; }
};

}  // namespace

bool HostBackend::reserve(size_t floats, support::Diagnostics&) {
  layers_.clear();  // or growing would copy what is lost
  layers_.resize(floats);
  is_finite_ = true;
  return true;
}

void HostBackend::write(size_t first, std::span<const float> floats) {
  std::ranges::copy(floats, layers_.begin() + static_cast<ptrdiff_t>(first));
}

std::span<const float> HostBackend::read(const Slot& slot) {
  return std::span(layers_).subspan(slot.first, slot.size());
}

/// Copies pixels of the image, which begins at this row of the window, to the slots.
void HostBackend::store(const Image& image, const Drawing& drawing, int first_row) {
  const auto copy = [&](const std::vector<float>& from, const Slot& to) {
    const auto place = layers_.begin() + static_cast<ptrdiff_t>(to.first + to.row_floats() * static_cast<size_t>(first_row));
    std::ranges::copy(from, place);
  };
  copy(image.depth, drawing.depth);
  if (drawing.color.exists()) copy(image.rgba, drawing.color);
}

bool HostBackend::process(const ScreenPass& pass, int first_row, Image& samples, support::Diagnostics& diagnostics) {
  // Only the rows that are there are read: the first row of the image would lie in front of the arrays.
  const auto before = static_cast<int64_t>(first_row) * samples.width;
  std::vector<float> floats(samples.rgba);
  floats.insert(floats.end(), samples.depth.begin(), samples.depth.end());
  std::vector<ImageRead> images(pass.images.begin(), pass.images.end());
  for (ImageRead& image : images) image.slot.first = 0;
  std::vector<int32_t> records = image_records(pass.width, pass.height, images);
  const auto first_of = [&](int image) -> int32_t& {
    return records[static_cast<size_t>((1 + image) * lower::image_word::stride + lower::image_word::first)];
  };
  first_of(0) = static_cast<int32_t>(static_cast<int64_t>(samples.rgba.size()) - before);
  first_of(1) = static_cast<int32_t>(-4 * before);
  if (!screen(pass, {floats, records}, first_row, samples.height, samples.rgba, diagnostics)) return false;
  is_finite_ = backends::is_finite(samples.rgba) && is_finite_;
  return true;
}

bool HostBackend::draw(const Drawing& drawing, support::Diagnostics& diagnostics) {
  constexpr int most_samples = 1 << 20;  // of rows that are drawn at a time: 20 MiB
  const Window& window = drawing.window;
  const int side = drawing.side;
  const Target& target = drawing.pass.view.target;
  support::assert_that(drawing.posts.empty() || (window.x == 0 && window.width == target.width),
                       "posts of a window that is narrower than the picture");
  const CopiedLayers layers(layers_, target.width, target.height, drawing.pass.images);
  const bool whole = side == 1;
  const int height = window.height / side;  // in pixels
  const int rows = whole ? height : std::max(1, most_samples / (window.width * side));
  for (int y = 0; y < height; y += rows) {
    const Window part{window.x, window.y + side * y, window.width, side * std::min(rows, height - y)};
    Image samples;
    {
      // Posts use the backend otherwise.
      const auto renderer = begin(drawing.pass, layers.arrays(), drawing.vertices, diagnostics);
      if (renderer == nullptr) return false;
      const bool drawn =
          whole ? renderer->draw(part, drawing.triangles, samples, diagnostics)
                : renderer->draw(part, raster::triangles_within(drawing.triangles, raster::box_at(part.x, part.y, part.width, part.height)), samples, diagnostics);
      if (!drawn) return false;
    }
    is_finite_ = backends::is_finite(samples.rgba) && is_finite_;
    for (const ScreenPass& post : drawing.posts)
      if (!process(post, part.y, samples, diagnostics)) return false;
    const lanes::FpGuard guard;
    resolve(samples.rgba.data(), samples.depth.data(), samples.width, samples.height, side);
    samples.resize(samples.width / side, samples.height / side, drawing.color.exists());
    store(samples, drawing, y);
  }
  return true;
}

bool HostBackend::post(std::span<const ScreenPass> passes, const Slot& made, support::Diagnostics& diagnostics) {
  for (const ScreenPass& pass : passes) {
    const CopiedLayers layers(layers_, pass.width, pass.height, pass.images);
    std::vector<float> rgba;
    if (!screen(pass, layers.arrays(), 0, pass.height, rgba, diagnostics)) return false;
    is_finite_ = backends::is_finite(rgba) && is_finite_;
    std::ranges::copy(rgba, layers_.begin() + static_cast<ptrdiff_t>(made.first));
  }
  return true;
}

}  // namespace isoshade::backends
