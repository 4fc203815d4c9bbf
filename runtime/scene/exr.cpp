// SPDX-License-Identifier: Apache-2.0
// OpenEXR. The library compresses and decompresses pixels. It reads a file of one part and one level, which we write
// around the chunks of the real file, so it never sees a header that was not checked, or an incomplete chunk
// (exr_file.h). It writes files of one chunk, several at the same time, whose chunks we put together; but ZIP is
// compressed here, several times as fast.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfTiledInputFile.h>
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <stdexcept>

#include "compiler/support/assert.h"
#include "runtime/lanes/float_rules.h"
#include "runtime/scene/deflate.h"
#include "runtime/scene/exr_file.h"
#include "runtime/scene/image_file.h"
#include "runtime/threads/workers.h"

namespace isoshade::scene {
namespace {

using exr_file::Chunk;
using exr_file::Part;
using exr_file::Window;

/// An output file in memory.
class Writer : public Imf::OStream {
 public:
  Writer() : OStream("") {}
  void write(const char* data, int size) override {
    const auto count = static_cast<size_t>(size);
    bytes_.resize(std::max(bytes_.size(), at_ + count));
    std::memcpy(bytes_.data() + at_, data, count);
    at_ += count;
  }
  uint64_t tellp() override { return at_; }
  void seekp(uint64_t at) override { at_ = at; }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
  size_t at_ = 0;
};

/// An input file that consists of pieces of memory.
class Pieces : public Imf::IStream {
 public:
  Pieces() : IStream("") {}
  void add(std::string_view piece) {
    pieces_.push_back(piece);
    starts_.push_back(size_);
    size_ += piece.size();
  }
  bool read(char* to, int size) override {
    auto count = static_cast<size_t>(size);
    if (size < 0 || count > size_ - at_) throw std::runtime_error("the data ends too early");
    while (count > 0) {
      const auto after = std::ranges::upper_bound(starts_, at_);
      const auto piece = static_cast<size_t>(after - starts_.begin()) - 1;
      const std::string_view rest = pieces_[piece].substr(at_ - starts_[piece]);
      const size_t part = std::min(rest.size(), count);
      std::memcpy(to, rest.data(), part);
      to += part;
      at_ += part;
      count -= part;
    }
    return at_ < size_;
  }
  uint64_t tellg() override { return at_; }
  void seekg(uint64_t at) override { at_ = std::min<uint64_t>(at, size_); }

 private:
  std::vector<std::string_view> pieces_;  ///< none is empty
  std::vector<uint64_t> starts_;
  uint64_t size_ = 0, at_ = 0;
};

Imf::PixelType imf_type(exr_file::PixelType type) {
  switch (type) {
    case exr_file::PixelType::uint: return Imf::UINT;
    case exr_file::PixelType::half: return Imf::HALF;
    case exr_file::PixelType::single: return Imf::FLOAT;
  }
  support::bug("exr: no such pixel type");
}

Imath::Box2i imf_box(const Window& window) {
  return {{window.min_x, window.min_y}, {window.max_x, window.max_y}};
}

/// The header of a file of one part and one level that has these pixels of a part.
Imf::Header imf_header(const Part& part, const Window& window) {
  Imf::Header header(imf_box(window), imf_box(window));
  header.compression() = static_cast<Imf::Compression>(part.compression);
  for (const exr_file::Channel& channel : part.channels)
    header.channels().insert(channel.name, Imf::Channel(imf_type(channel.type), channel.x_sampling,
                                                        channel.y_sampling, channel.linear != 0));
  if (part.tiles) header.setTileDescription({part.tiles->width, part.tiles->height});
  return header;
}

/// The bytes before the chunks: the header of a file of one part and one level, and the offset of each chunk.
std::string head_of(const Part& part, const std::vector<Chunk>& chunks) {
  const Imf::Header header = imf_header(part, part.data);
  Writer writer;
  constexpr int tiled = 2, long_names = 4;
  constexpr size_t longest_short_name = 31;
  const bool has_long_names = std::ranges::any_of(
      part.channels, [](const exr_file::Channel& channel) { return channel.name.size() > longest_short_name; });
  writer.write("\x76\x2f\x31\x01\x02", 5);
  const char flags[3] = {static_cast<char>((has_long_names ? long_names : 0) | (part.tiles ? tiled : 0)), 0, 0};
  writer.write(flags, 3);
  header.writeTo(writer, part.tiles.has_value());
  std::string head = writer.take();
  uint64_t offset = head.size() + 8 * chunks.size();
  for (const Chunk& chunk : chunks) {
    for (int shift = 0; shift < 64; shift += 8) head += static_cast<char>(offset >> shift & 255);
    offset += chunk.bytes.size();
  }
  return head;
}

/// The values that are read of a pixel: r g b a z.
constexpr size_t read_count = 5;

/// A buffer for the pixels of a window, row by row.
Imf::FrameBuffer frame_buffer(const Part& part, const Window& window, float* to) {
  Imf::FrameBuffer buffer;
  constexpr size_t pixel = read_count * sizeof(float);
  const auto insert = [&](int channel, size_t place) {
    if (channel < 0) return;
    buffer.insert(part.channels[static_cast<size_t>(channel)].name,
                  Imf::Slice::Make(Imf::FLOAT, to + place, imf_box(window), pixel,
                                   pixel * static_cast<size_t>(window.width())));
  };
  const exr_file::Picture& picture = part.picture;
  insert(picture.colors[0], 0);
  if (picture.colors[1] != picture.colors[0]) insert(picture.colors[1], 1), insert(picture.colors[2], 2);
  insert(picture.alpha, 3);
  insert(picture.depth, 4);
  return buffer;
}

/// Copies those pixels of a window that lie in the display window.
void place(const Part& part, const Window& from, const std::vector<float>& pixels, FileImage& image) {
  const Window& display = part.display;
  const int32_t left = std::max(from.min_x, display.min_x), right = std::min(from.max_x, display.max_x);
  const int32_t top = std::max(from.min_y, display.min_y), bottom = std::min(from.max_y, display.max_y);
  const exr_file::Picture& picture = part.picture;
  const bool grey = picture.colors[0] == picture.colors[1];
  for (int32_t y = top; y <= bottom; ++y) {
    const int64_t row = (int64_t{y} - from.min_y) * from.width(),
                  row_to = (int64_t{y} - display.min_y) * image.width;
    for (int32_t x = left; x <= right; ++x) {
      const float* source = &pixels[read_count * static_cast<size_t>(row + x - from.min_x)];
      const auto to = static_cast<size_t>(row_to + x - display.min_x);
      for (size_t c = 0; c < 3; ++c) image.rgba[4 * to + c] = source[grey ? 0 : c];
      image.rgba[4 * to + 3] = picture.alpha < 0 ? 1.0f : source[3];
      if (picture.depth >= 0) image.depth[to] = source[4];
    }
  }
}

/// Channel Z is not read if it is subsampled.
Part without_sparse_depth(Part part) {
  if (part.picture.depth < 0) return part;
  const exr_file::Channel& depth = part.channels[static_cast<size_t>(part.picture.depth)];
  if (depth.x_sampling != 1 || depth.y_sampling != 1) part.picture.depth = -1;
  return part;
}

void unpack(const Part& part, const std::vector<Chunk>& chunks, FileImage& image) {
  const std::string head = head_of(part, chunks);
  Pieces file;
  file.add(head);
  for (const Chunk& chunk : chunks) file.add(chunk.bytes);
  std::optional<Imf::TiledInputFile> tiles;
  std::optional<Imf::InputFile> rows;
  if (part.tiles)
    tiles.emplace(file, 0);
  else
    rows.emplace(file, 0);
  std::vector<float> pixels;
  for (const Chunk& chunk : chunks) {
    const Window& window = chunk.pixels;
    pixels.assign(read_count * static_cast<size_t>(window.width() * window.height()), 0.0f);
    const Imf::FrameBuffer buffer = frame_buffer(part, window, pixels.data());
    if (tiles) {
      tiles->setFrameBuffer(buffer);
      tiles->readTile(chunk.column, chunk.row);
    } else {
      rows->setFrameBuffer(buffer);
      rows->readPixels(window.min_y, window.max_y);
    }
    place(part, window, pixels, image);
  }
}

/// The library decompresses DWAA and DWAB with float sums whose order depends on whether the processor has AVX.
/// Nearly all have it.
bool unpacks_alike(exr_file::Compression compression) {
  const bool cosines =
      compression == exr_file::Compression::dwaa || compression == exr_file::Compression::dwab;
  return !cosines || __builtin_cpu_supports("avx") != 0;
}

/// The message of an exception of the library, without the file name, which is not the user's.
std::string reason_of(const std::exception& exception) {
  std::string text = exception.what();
  if (const size_t name = text.find("\"\". "); name != std::string::npos) text.erase(0, name + 4);
  return "the file is damaged: " + text;
}

/// The channels that are written, in the order of their names, and where their values are.
struct Plane {
  const char* name;
  const float* first;
  size_t step;  ///< from a pixel to the next
};
using Planes = std::array<Plane, 5>;

Planes planes_of(const ImageView& image) {
  const float* const rgba = image.rgba.data();
  return {{{"A", rgba + 3, 4}, {"B", rgba + 2, 4}, {"G", rgba + 1, 4}, {"R", rgba, 4}, {"Z", image.depth.data(), 1}}};
}

/// A chunk of these rows: the first of them, its size, and its data as the library compresses them.
std::string packed_by_library(const Part& part, const Planes& planes, const Window& rows) {
  Imf::FrameBuffer buffer;
  for (const Plane& plane : planes) {
    // The library only reads from it, although its pointer is not const.
    char* base = const_cast<char*>(reinterpret_cast<const char*>(plane.first));
    const size_t stride = plane.step * sizeof(float);
    buffer.insert(plane.name, Imf::Slice(Imf::FLOAT, base, stride, stride * static_cast<size_t>(rows.width())));
  }
  Writer writer;
  {
    Imf::OutputFile file(writer, imf_header(part, rows), 0);
    file.setFrameBuffer(buffer);
    file.writePixels(static_cast<int>(rows.height()));
  }  // writes the offset of the chunk
  const std::string file = writer.take();
  const Read<exr_file::Contents> contents = exr_file::read_contents(file);
  support::assert_that(contents.found.has_value(), "exr: the library wrote an odd file");
  return file.substr(contents.found->tables + 8);
}

/// The same for ZIP and ZIPS. "OpenEXR File Layout" and ImfZip.cpp of OpenEXR 3.1: the bytes at even places, then those at
/// odd places, each less the one before it, as a zlib stream; as they are if that is not smaller.
std::string packed_as_zip(const Planes& planes, const Window& rows) {
  const auto width = static_cast<size_t>(rows.width()), height = static_cast<size_t>(rows.height());
  const size_t size = sizeof(float) * planes.size() * width * height;
  std::vector<uint16_t> halves(size / 2);  // the even bytes, two of each number, then the odd ones
  uint16_t* even = halves.data();
  uint16_t* odd = even + size / 4;
  const auto top = static_cast<size_t>(rows.min_y);
  for (size_t y = top; y < top + height; ++y) {
    for (const Plane& plane : planes) {
      const float* const from = plane.first + y * width * plane.step;
      for (size_t x = 0; x < width; ++x) {
        const auto bits = std::bit_cast<uint32_t>(from[x * plane.step]);
        even[x] = static_cast<uint16_t>((bits & 0xff) | (bits >> 8 & 0xff00));
        odd[x] = static_cast<uint16_t>((bits >> 8 & 0xff) | (bits >> 16 & 0xff00));
      }
      even += width;
      odd += width;
    }
  }
  const auto* const bytes = reinterpret_cast<const uint8_t*>(halves.data());
  std::string changes(size, static_cast<char>(bytes[0]));
  for (size_t i = 1; i < size; ++i) changes[i] = static_cast<char>(bytes[i] - bytes[i - 1] + 128);
  std::string data = zlib_stream(changes);
  if (data.size() >= size) {
    data.clear();
    for (size_t i = 0; i < size / 2; ++i) {
      data += static_cast<char>(bytes[i]);
      data += static_cast<char>(bytes[size / 2 + i]);
    }
  }
  std::string chunk;
  for (const auto number : {static_cast<uint32_t>(rows.min_y), static_cast<uint32_t>(data.size())})
    for (int shift = 0; shift < 32; shift += 8) chunk += static_cast<char>(number >> shift & 255);
  return chunk += data;
}

}  // namespace

std::string exr(const ImageView& image, ExrCompression compression, int threads) {
  static_assert(std::endian::native == std::endian::little, "numbers in files begin with the lowest byte");
  const size_t pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  support::assert_that(image.rgba.size() == 4 * pixels && image.depth.size() == pixels,
                       "exr: image of odd size");
  const Planes planes = planes_of(image);
  Part part;
  part.compression = compression;
  part.data = part.display = {0, 0, image.width - 1, image.height - 1};
  for (const Plane& plane : planes) part.channels.push_back({plane.name, exr_file::PixelType::single});
  const bool is_zip = compression == ExrCompression::zip || compression == ExrCompression::zips;
  const int rows = exr_file::rows_per_chunk(compression);
  std::vector<std::string> packed(static_cast<size_t>((image.height + rows - 1) / rows));
  threads::Workers(threads).for_each(packed.size(), [&](size_t i) {
    Window window = part.data;
    window.min_y = static_cast<int32_t>(i) * rows;
    window.max_y = std::min(window.min_y + rows - 1, window.max_y);
    packed[i] = is_zip ? packed_as_zip(planes, window) : packed_by_library(part, planes, window);
  });
  std::vector<Chunk> chunks(packed.size());
  size_t size = 0;
  for (size_t i = 0; i < packed.size(); ++i) chunks[i].bytes = packed[i], size += packed[i].size();
  std::string file = head_of(part, chunks);
  file.reserve(file.size() + size);
  for (const std::string& chunk : packed) file += chunk;
  return file;
}

bool is_exr(std::string_view bytes) { return bytes.starts_with("\x76\x2f\x31\x01"); }

Read<ImageHeader> read_exr_header(std::string_view bytes) {
  Read<exr_file::Contents> contents = exr_file::read_contents(bytes);
  if (!contents.found) return {{}, std::move(contents.reason)};
  const Window& display = contents.found->read_part().display;
  return {ImageHeader{static_cast<int>(display.width()), static_cast<int>(display.height()), false}, {}};
}

Read<FileImage> decode_exr(std::string_view bytes) {
  const Read<exr_file::Contents> contents = exr_file::read_contents(bytes);
  if (!contents.found) return {{}, contents.reason};
  if (!unpacks_alike(contents.found->read_part().compression))
    return {{},
            "on a processor without AVX, its compression DWAA or DWAB would give other bits than elsewhere"};
  const Read<std::vector<Chunk>> chunks = exr_file::find_chunks(bytes, *contents.found);
  if (!chunks.found) return {{}, chunks.reason};
  const Part part = without_sparse_depth(contents.found->read_part());
  FileImage image;
  image.width = static_cast<int>(part.display.width());
  image.height = static_cast<int>(part.display.height());
  const size_t pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  try {
    image.rgba.assign(4 * pixels, 0.0f);
    if (part.picture.depth >= 0) image.depth.assign(pixels, 0.0f);
    unpack(part, *chunks.found, image);
  } catch (const std::bad_alloc&) {
    return {{}, "there is not enough memory"};
  } catch (const std::exception& exception) { return {{}, reason_of(exception)}; }
  make_finite(image);
  if (part.chromaticities && part.picture.colors[0] != part.picture.colors[1]) {
    const lanes::FpGuard guard;
    if (const auto matrix = to_rec709(*part.chromaticities).matrix) transform(*matrix, image.rgba);
  }
  return {std::move(image), {}};
}

}  // namespace isoshade::scene
