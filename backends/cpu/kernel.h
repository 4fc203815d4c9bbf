// SPDX-License-Identifier: Apache-2.0
// Compiled programs: from generated text to callable functions.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "backends/cache.h"
#include "backends/cpu/compiler.h"
#include "compiler/driver/program.h"

namespace isoshade::cpu {

// The exports of generated code, see targets/cpp/stages.h. Callers hold an FpGuard.
extern "C" {
/// An array; its index is its number in lower::FrameBuffer. It has at least one element.
struct BufferView {
  const void* data;
  int size;
};
using VertexFunction = void(const BufferView* buffers, int object, int projected, int first, int count,
                            float* clip);
using PixelFunction = void(const BufferView* buffers, int object, int light_count, int count, const int* x,
                           const int* y, const int* triangle, float* rgba);
using BlendFunction = void(const BufferView* buffers, int object, int light_count, int count, const int* x,
                           const int* y, const int* triangle, float* rgba);
using CutoutFunction = void(const BufferView* buffers, int object, int count, const int* x, const int* y,
                            const int* triangle, int* drawn);
using PostFunction = void(const BufferView* buffers, int first, int y, int count, float* rgba);
using EvalFunction = void(const BufferView* buffers, int first, int count, int* results);
}

/// A loaded shared object. Only the function of the program's stage is not null.
class Kernel {
 public:
  /// Reports errors of the dynamic linker.
  static std::unique_ptr<Kernel> load(const std::string& path, driver::Stage stage,
                                      support::Diagnostics& diagnostics);
  ~Kernel();
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;

  VertexFunction* vertex = nullptr;
  CutoutFunction* cutout = nullptr;
  PixelFunction* pixel = nullptr;
  BlendFunction* blend = nullptr;
  EvalFunction* eval = nullptr;
  PostFunction* post = nullptr;

 private:
  explicit Kernel(void* library) : library_(library) {}
  void* library_;
};

/// The text of a program; see targets/cpp/stages.h for what it must export.
using CppText = std::function<std::string(const driver::Program&)>;

/// Compiles programs, or finds them in the cache, and keeps them loaded.
class KernelStore {
 public:
  /// `keep`: a folder that receives the text of every program that is used, named after its document; empty: none.
  KernelStore(Compiler compiler, backends::Cache cache, LaneCount lanes, CppText cpp, std::string keep);

  /// The kernel of each program; missing ones are compiled in parallel. Nothing if one fails. The store owns them.
  std::optional<std::vector<const Kernel*>> kernels(std::span<const driver::Program* const> programs,
                                                    support::Diagnostics& diagnostics);

  /// The total duration of all calls of kernels().
  double seconds() const { return seconds_; }
  const Compiler& compiler() const { return compiler_; }
  LaneCount lanes() const { return lanes_; }

 private:
  std::unique_ptr<Kernel> make(const driver::Program& program, const std::string& text,
                               const std::string& key, support::Diagnostics& diagnostics) const;
  bool compile(const driver::Program& program, const std::string& text, const std::string& entry,
               support::Diagnostics& diagnostics) const;
  std::string key_of(const std::string& text) const;

  Compiler compiler_;
  backends::Cache cache_;
  LaneCount lanes_;
  CppText cpp_;
  std::string keep_;
  std::string surroundings_;  ///< a hash of everything but the text that decides the machine code
  std::map<std::string, std::unique_ptr<Kernel>> loaded_;
  double seconds_ = 0;
};

}  // namespace isoshade::cpu
