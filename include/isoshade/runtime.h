// SPDX-License-Identifier: Apache-2.0
// The runtime as a library: scenes to images, functions over tables, images compared bit for bit.
//
//     isoshade::Backend cpu;
//     if (const isoshade::Outcome opened = cpu.open(); !opened) return report(opened.text);
//     const isoshade::Rendering a = cpu.render_file("scenes/balls.json", {.settings = {"balls.roughness=0.3"}});
//     if (!a) return report(a.text);
//     isoshade::write_image("balls.png", a.image);
//
// In CMake: find_package(isoshade REQUIRED) and target_link_libraries(program PRIVATE isoshade::runtime).
//
// Any number of threads may call any function at the same time, and const functions of the same object; the calls of one
// Backend wait for each other. A program must not ignore SIGCHLD, or collect children that it did not start, while generated C++ is
// compiled.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <isoshade/outcome.h>

namespace isoshade {

/// Linear and scene-referred, rows from top to bottom.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<float> rgba;   ///< 4 * width * height
  std::vector<float> depth;  ///< width * height; 1 at the near plane, 0 where nothing was drawn
  bool srgb = true;          ///< how a PNG of it is encoded; otherwise linearly
  float exposure = 1;        ///< by which a PNG's colors are multiplied
};

/// SHA-256 over the size, colors and depth: 64 hex digits, the same on every machine. Empty if `rgba` and `depth` do not
/// have the size of the image, or if memory runs out.
ISOSHADE_API std::string hash_of(const Image& image) noexcept;

/// Writes PNG, JPEG or PPM (8 bits, encoded), OpenEXR (floats as they are, with depth) or PFM (floats of the colors), by the
/// ending of the path: .png, .jpg, .ppm, .exr, .pfm. Warns if a format without alpha loses it. Writes the file whole or not
/// at all.
ISOSHADE_API Outcome write_image(const std::string& path, const Image& image) noexcept;

struct Comparison {
  struct Pixel {
    int x = 0, y = 0;               ///< from the upper left
    std::array<float, 5> a{}, b{};  ///< r g b a depth
  };

  bool same_size = false;  ///< if not, the pixels were not compared
  std::int64_t pixels = 0;
  std::int64_t differing = 0;
  std::uint32_t largest_ulp = 0;  ///< steps between floats, of the component that differs most
  std::optional<Pixel> first;     ///< that differs, in row order

  bool identical() const { return same_size && differing == 0; }
};

/// Compares all bits of colors and depth.
ISOSHADE_API Comparison compare_images(const Image& a, const Image& b) noexcept;

struct BackendOptions {
  /// "cpu": generated C++, compiled by the machine's compiler, on all cores. "vulkan": any device that passes the probe.
  /// "interpreter": neither, and slower. "reference": 57 decimal digits, not the same bits.
  std::string name = "cpu";
  std::string lanes = {};     ///< cpu: "1" "4" "8" "16" "8x2" "16x2"; empty: the widest that the machine has
  int threads = 0;       ///< cpu: 0: one for each core
  std::string compiler = {};  ///< cpu: path or name; empty: $ISOSHADE_CXX, c++, g++, clang++
  double compiler_seconds = 120;  ///< cpu: how long it may take for one program
  std::string cache = {};     ///< folder of compiled code and of maps of environments; empty: isoshade in $XDG_CACHE_HOME or $HOME/.cache
  std::string device = {};    ///< vulkan: part of its name, or its number; empty: a software device if there is one
};

struct RenderOptions {
  Sources sources = {};
  std::vector<std::string> settings = {};  ///< "object.parameter=value", as --set of the command
  int width = 0, height = 0;          ///< 0: the scene's
  int samples = 0;                    ///< a pixel: 1, 4 or 16; 0: the scene's
  std::optional<float> time = {};          ///< in seconds; nothing: the scene's
  Precision precision = Precision::standard;
};

struct Rendering : Outcome {
  Image image;
};

struct FunctionOptions {
  Sources sources = {};
  Precision precision = Precision::standard;
};

/// An input or output of a function, and its place in a row.
struct Column {
  std::string name;
  std::string type;  ///< as in documents: "float", "vector3", "integer", "matrix44"
  int words = 1;     ///< how many follow each other in a row
};

/// Words of 32 bits, row by row: floats by their bits (std::bit_cast), integers, booleans as 0 or 1.
struct Evaluation : Outcome {
  std::vector<std::int32_t> words;
};

/// A function document, compiled; evaluate it with Backend::evaluate(). Copies share it.
class ISOSHADE_API Function {
 public:
  Outcome load_file(const std::string& path, const FunctionOptions& options = {}) noexcept;
  Outcome load(const Document& document, const FunctionOptions& options = {}) noexcept;

  const std::vector<Column>& inputs() const noexcept { return inputs_; }    ///< empty until it is loaded
  const std::vector<Column>& outputs() const noexcept { return outputs_; }

 private:
  friend class Backend;
  struct Loaded;
  std::vector<Column> inputs_, outputs_;
  std::shared_ptr<const Loaded> loaded_;
};

/// What runs programs. It keeps those that it has compiled, so that the next frame starts at once. Copies share it.
class ISOSHADE_API Backend {
 public:
  /// Finds the compiler, or the device and probes it. Replaces what was open.
  Outcome open(const BackendOptions& options = {}) noexcept;
  bool is_open() const noexcept { return opened_ != nullptr; }

  /// One line: the compiler and its lanes, or the device and its driver. Empty if nothing is open.
  std::string description() const noexcept;

  Rendering render_file(const std::string& path, const RenderOptions& options = {}) const noexcept;
  Rendering render(const Document& scene, const RenderOptions& options = {}) const noexcept;

  /// `inputs`: whole rows of all input columns, in their order.
  Evaluation evaluate(const Function& function, std::span<const std::int32_t> inputs) const noexcept;

 private:
  struct Opened;
  std::shared_ptr<Opened> opened_;
};

}  // namespace isoshade
