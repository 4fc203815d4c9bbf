// SPDX-License-Identifier: Apache-2.0
// JPEG through libjpeg-turbo. The integer transform of 8x8 blocks, "fancy" upsampling and the conversion to RGB give the
// same bytes with and without SIMD; the fast and the float transform, and the smoothing of blocks, do not.
#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <jpeglib.h>
#include <new>
// After jpeglib.h.
#include <jerror.h>

#include "runtime/scene/image_file.h"

namespace isoshade::scene {
namespace {

/// Encoders write up to a dozen scans. Each may cover the whole image in as little as a hundred bytes.
constexpr int most_scans = 64;

struct Errors : jpeg_error_mgr {
  std::jmp_buf escape;
  char reason[JMSG_LENGTH_MAX];
};

[[noreturn]] void fail(j_common_ptr info) {
  auto* errors = static_cast<Errors*>(info->err);
  errors->format_message(info, errors->reason);
  std::longjmp(errors->escape, 1);
}

/// libjpeg warns about damaged data and invents the rest. Two of its warnings are harmless: extra bytes between
/// segments, and meaningless parameters of a sequential scan.
void judge(j_common_ptr info, int level) {
  const int code = info->err->msg_code;
  if (level < 0 && code != JWRN_EXTRANEOUS_DATA && code != JWRN_NOT_SEQUENTIAL) fail(info);
}

/// The scans of a file: markers do not occur within their data.
int count_scans(std::string_view bytes) {
  int count = 0;
  size_t at = 0;
  while ((at = bytes.find('\xff', at)) != std::string_view::npos && ++at < bytes.size()) {
    const auto marker = static_cast<unsigned char>(bytes[at]);
    if (marker == 0xff) continue;                                        // fill bytes
    if (marker == 0xd9) break;                                           // the end of the image
    if (marker <= 0x01 || (marker >= 0xd0 && marker <= 0xd8)) continue;  // not segments: 0 is data
    if (marker == 0xda) ++count;
    if (at + 2 >= bytes.size()) break;
    const auto byte = [&](size_t i) { return static_cast<unsigned char>(bytes[at + i]); };
    at += 1 + (size_t{byte(1)} << 8 | byte(2));
  }
  return count;
}

/// Decodes one file. Its methods return the reason why they cannot continue, or an empty string.
class Decoder {
 public:
  explicit Decoder(std::string_view bytes) : bytes_(bytes) {
    info_.err = jpeg_std_error(&errors_);
    errors_.error_exit = fail;
    errors_.emit_message = judge;
  }
  ~Decoder() { jpeg_destroy_decompress(&info_); }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  std::string read_header() {
    const int scans = count_scans(bytes_);
    if (scans > most_scans)
      return "it has " + std::to_string(scans) + " scans; at most " + std::to_string(most_scans) +
             " are read";
    if (!run(&Decoder::start)) return failure();
    if (std::string reason = refuse_size(info_.image_width, info_.image_height); !reason.empty())
      return reason;
    if (info_.num_components == 4) return "it is CMYK: convert it to RGB";
    if (info_.num_components != 1 && info_.num_components != 3)
      return "it has " + std::to_string(info_.num_components) + " channels, not 1 or 3";
    if (info_.arith_code != 0) return "it uses arithmetic coding: save it with Huffman coding";
    return {};
  }

  std::string read_pixels(std::vector<uint32_t>& pixels) {
    // Each 8x8 block takes at least one bit: shorter files are refused before memory is allocated.
    size_t blocks = 0;
    for (int c = 0; c < info_.num_components; ++c)
      blocks += size_t{info_.comp_info[c].width_in_blocks} * info_.comp_info[c].height_in_blocks;
    if (blocks / 8 > bytes_.size())
      return "its " + std::to_string(bytes_.size()) + " bytes are too few for its size";
    row_.resize(size_t{4} * info_.image_width);
    pixels_ = &pixels;
    if (!run(&Decoder::decode)) return failure();
    return reason_;
  }

  ImageHeader header() const {
    return {static_cast<int>(info_.image_width), static_cast<int>(info_.image_height), true, true};
  }

 private:
  /// Whether the step succeeded. On errors libjpeg longjmps out of the step to here, so no step may hold an object with
  /// a destructor while it calls libjpeg.
  bool run(void (Decoder::*step)()) {
    if (setjmp(errors_.escape) != 0) return false;
    (this->*step)();
    return true;
  }

  std::string failure() const {
    if (errors_.msg_code == JERR_OUT_OF_MEMORY) return "there is not enough memory for it";
    return errors_.reason;
  }

  void start() {
    jpeg_create_decompress(&info_);
    jpeg_mem_src(&info_, reinterpret_cast<const unsigned char*>(bytes_.data()), bytes_.size());
    jpeg_read_header(&info_, TRUE);
  }

  void decode() {
    info_.dct_method = JDCT_ISLOW;
    info_.do_fancy_upsampling = TRUE;
    info_.do_block_smoothing = FALSE;
    info_.out_color_space = JCS_EXT_RGBA;
    const bool several = jpeg_has_multiple_scans(&info_) != 0;
    info_.buffered_image = several ? TRUE : FALSE;
    if (!note_scan(true)) return;
    forget_missing_tables();
    if (several && !read_scans()) return;
    pixels_->reserve(size_t{info_.image_width} * info_.image_height);
    while (info_.output_scanline < info_.output_height) {
      JSAMPROW row = row_.data();
      jpeg_read_scanlines(&info_, &row, 1);
      append_row();
    }
    if (several) jpeg_finish_output(&info_);
    jpeg_finish_decompress(&info_);
  }

  /// Starts, and removes the Huffman tables that libjpeg supplies for files without any, which are for Motion JPEG.
  void forget_missing_tables() {
    std::array<bool, NUM_HUFF_TBLS> dc{}, ac{};
    for (size_t i = 0; i < NUM_HUFF_TBLS; ++i) {
      dc[i] = info_.dc_huff_tbl_ptrs[i] != nullptr;
      ac[i] = info_.ac_huff_tbl_ptrs[i] != nullptr;
    }
    jpeg_start_decompress(&info_);
    for (size_t i = 0; i < NUM_HUFF_TBLS; ++i) {
      if (!dc[i]) info_.dc_huff_tbl_ptrs[i] = nullptr;
      if (!ac[i]) info_.ac_huff_tbl_ptrs[i] = nullptr;
    }
  }

  /// Reads the coefficients of all scans before any pixel is computed.
  bool read_scans() {
    for (int event = 0; event != JPEG_REACHED_EOI;) {
      event = jpeg_consume_input(&info_);
      if (event == JPEG_REACHED_SOS && !note_scan(false)) return false;
    }
    for (int c = 0; c < info_.num_components; ++c) {
      // The lowest known bit of each coefficient; -1: none.
      const int* bits = info_.coef_bits == nullptr ? nullptr : info_.coef_bits[c];
      const bool whole = bits == nullptr
                             ? seen_[static_cast<size_t>(c)]
                             : std::all_of(bits, bits + DCTSIZE2, [](int bit) { return bit == 0; });
      if (!whole) return refuse("scans are missing");
    }
    jpeg_start_output(&info_, info_.input_scan_number);
    return true;
  }

  /// Reads the next scan. Returns whether it is supported.
  bool note_scan(bool first) {
    for (int i = 0; i < info_.comps_in_scan; ++i) {
      const jpeg_component_info& component = *info_.cur_comp_info[i];
      if (info_.progressive_mode != 0) continue;
      bool& seen = seen_[static_cast<size_t>(component.component_index)];
      if (seen) return refuse("a channel has two scans");
      seen = true;
      // Later scans use only the tables of the file.
      const int dc = component.dc_tbl_no, ac = component.ac_tbl_no;  // up to 15, from the file
      if (first && (dc >= NUM_HUFF_TBLS || ac >= NUM_HUFF_TBLS || info_.dc_huff_tbl_ptrs[dc] == nullptr ||
                    info_.ac_huff_tbl_ptrs[ac] == nullptr))
        return refuse("it has no Huffman tables");
    }
    return true;
  }

  bool refuse(const char* reason) {
    reason_ = reason;
    return false;
  }

  void append_row() {
    for (size_t i = 0; i < row_.size(); i += 4) {
      pixels_->push_back(uint32_t{row_[i]} | uint32_t{row_[i + 1]} << 8 | uint32_t{row_[i + 2]} << 16 |
                         uint32_t{row_[i + 3]} << 24);
    }
  }

  std::string_view bytes_;
  jpeg_decompress_struct info_{};
  Errors errors_{};
  std::array<bool, MAX_COMPONENTS> seen_{};  ///< channels; for files that are not progressive
  std::vector<JSAMPLE> row_;
  std::vector<uint32_t>* pixels_ = nullptr;
  std::string reason_;
};

/// Encodes one image.
class Encoder {
 public:
  Encoder(const ByteView& image, int quality) : image_(image), quality_(quality) {
    info_.err = jpeg_std_error(&errors_);
    errors_.error_exit = fail;
  }
  ~Encoder() {
    jpeg_destroy_compress(&info_);
    std::free(memory_);
  }
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;

  std::string run() {
    // As in Decoder::run. What can fail is allocating memory.
    if (setjmp(errors_.escape) != 0) throw std::bad_alloc();
    encode();
    return std::string(reinterpret_cast<const char*>(memory_), size_);
  }

 private:
  void encode() {
    jpeg_create_compress(&info_);
    jpeg_mem_dest(&info_, &memory_, &size_);
    info_.image_width = static_cast<JDIMENSION>(image_.width);
    info_.image_height = static_cast<JDIMENSION>(image_.height);
    info_.in_color_space = JCS_EXT_RGBX;
    info_.input_components = 4;
    jpeg_set_defaults(&info_);
    jpeg_set_quality(&info_, quality_, TRUE);
    info_.dct_method = JDCT_ISLOW;
    constexpr int from_which_colors_are_whole = 90;
    const int share = quality_ >= from_which_colors_are_whole ? 1 : 2;
    info_.comp_info[0].h_samp_factor = info_.comp_info[0].v_samp_factor = share;
    jpeg_start_compress(&info_, TRUE);
    const size_t row_bytes = size_t{4} * info_.image_width;
    while (info_.next_scanline < info_.image_height) {
      // libjpeg only reads from it, although its pointer is not const.
      auto* row = const_cast<JSAMPLE*>(&image_.rgba[info_.next_scanline * row_bytes]);
      jpeg_write_scanlines(&info_, &row, 1);
    }
    jpeg_finish_compress(&info_);
  }

  const ByteView& image_;
  int quality_;
  jpeg_compress_struct info_{};
  Errors errors_{};
  unsigned char* memory_ = nullptr;
  unsigned long size_ = 0;
};

}  // namespace

std::string jpeg(const ByteView& image, int quality) { return Encoder(image, quality).run(); }

bool is_jpeg(std::string_view bytes) { return bytes.starts_with("\xff\xd8\xff"); }

Read<ImageHeader> read_jpeg_header(std::string_view bytes) {
  Decoder decoder(bytes);
  if (std::string reason = decoder.read_header(); !reason.empty()) return {{}, std::move(reason)};
  return {decoder.header(), {}};
}

Read<FileImage> decode_jpeg(std::string_view bytes) {
  Decoder decoder(bytes);
  if (std::string reason = decoder.read_header(); !reason.empty()) return {{}, std::move(reason)};
  FileImage image;
  image.width = decoder.header().width;
  image.height = decoder.header().height;
  if (std::string reason = decoder.read_pixels(image.bytes); !reason.empty()) return {{}, std::move(reason)};
  return {std::move(image), {}};
}

}  // namespace isoshade::scene
