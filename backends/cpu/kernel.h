// SPDX-License-Identifier: Apache-2.0
// Compiled programs: from generated text to callable functions.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "backends/cache.h"
#include "backends/cpu/builds.h"
#include "backends/cpu/compiler.h"
#include "backends/interpreter/stages.h"
#include "compiler/driver/program.h"

namespace isoshade::cpu {

using interpreter::BufferView;

// The exports of generated code, see targets/cpp/stages.h. Callers hold an FpGuard.
extern "C" {
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

/// How the cpu backend runs programs.
enum class Execution : uint8_t {
  compiled,     ///< waits until they are compiled
  at_once,      ///< interprets them until they are compiled, which happens in the background
  interpreted,  ///< without a compiler
};

/// A program of one stage; only the function of its stage may be called. Thread-safe.
class Kernel {
 public:
  explicit Kernel(driver::Stage stage) : stage_(stage) {}
  ~Kernel();
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;

  /// Calls are interpreted as long as there is no compiled code.
  void interpret(const driver::Program& program) { interpreted_.emplace(program); }
  /// From now on calls run the compiled code of a shared object. Reports errors of the dynamic linker.
  bool load(const std::string& path, support::Diagnostics& diagnostics);
  bool is_compiled() const { return function_.load(std::memory_order_acquire) != nullptr; }

  void vertex(const BufferView* buffers, int object, int projected, int first, int count, float* clip) const {
    run(&interpreter::Stages::vertex, static_cast<VertexFunction*>(nullptr), count, buffers, object, projected, first,
        count, clip);
  }
  void cutout(const BufferView* buffers, int object, int count, const int* x, const int* y, const int* triangle,
              int* drawn) const {
    run(&interpreter::Stages::cutout, static_cast<CutoutFunction*>(nullptr), count, buffers, object, count, x, y,
        triangle, drawn);
  }
  void pixel(const BufferView* buffers, int object, int light_count, int count, const int* x, const int* y,
             const int* triangle, float* rgba) const {
    run(&interpreter::Stages::pixel, static_cast<PixelFunction*>(nullptr), count, buffers, object, light_count, count,
        x, y, triangle, rgba);
  }
  void blend(const BufferView* buffers, int object, int light_count, int count, const int* x, const int* y,
             const int* triangle, float* rgba) const {
    run(&interpreter::Stages::blend, static_cast<BlendFunction*>(nullptr), count, buffers, object, light_count, count,
        x, y, triangle, rgba);
  }
  void eval(const BufferView* buffers, int first, int count, int* results) const {
    run(&interpreter::Stages::eval, static_cast<EvalFunction*>(nullptr), count, buffers, first, count, results);
  }
  void post(const BufferView* buffers, int first, int y, int count, float* rgba) const {
    run(&interpreter::Stages::post, static_cast<PostFunction*>(nullptr), count, buffers, first, y, count, rgba);
  }

  /// How often the program was run so far: for how many vertices, pixels or rows.
  uint64_t runs_compiled() const { return compiled_runs_.load(std::memory_order_relaxed); }
  uint64_t runs_interpreted() const { return interpreted_runs_.load(std::memory_order_relaxed); }

 private:
  template <class Interpreted, class Compiled, class... Arguments>
  void run(Interpreted interpreted, Compiled* /* its type */, int count, Arguments... arguments) const {
    void* const function = function_.load(std::memory_order_acquire);
    if (function != nullptr)
      reinterpret_cast<Compiled*>(function)(arguments...);
    else
      ((*interpreted_).*interpreted)(arguments...);
    (function != nullptr ? compiled_runs_ : interpreted_runs_)
        .fetch_add(static_cast<uint64_t>(count), std::memory_order_relaxed);
  }

  driver::Stage stage_;
  std::atomic<void*> function_ = nullptr;  ///< compiled code
  std::optional<interpreter::Stages> interpreted_;
  void* library_ = nullptr;
  mutable std::atomic<uint64_t> compiled_runs_ = 0, interpreted_runs_ = 0;
};

/// The text of a program; see targets/cpp/stages.h for what it must export.
using CppText = std::function<std::string(const driver::Program&)>;

/// Makes kernels of programs, and keeps them.
class KernelStore {
 public:
  /// `toolchain`: nothing if programs are only interpreted. `keep`: a folder that receives the text of every program that
  /// is used, named after its document; empty: none.
  KernelStore(std::optional<Toolchain> toolchain, Execution execution, CppText cpp, std::string keep);

  /// The kernel of each program, which the store owns. With Execution::compiled, missing ones are compiled in parallel;
  /// nothing if one fails. With Execution::at_once, failures are reported later, as warnings; programs that are too large
  /// to be interpreted are waited for.
  std::optional<std::vector<const Kernel*>> kernels(std::span<const driver::Program* const> programs,
                                                    support::Diagnostics& diagnostics);

  /// The total duration of all calls of kernels().
  double seconds() const { return seconds_; }
  /// Who runs programs: "c++ (Debian 12.2.0-14) 12.2.0, lanes 8x2". If the interpreter has run some of them, also how much.
  std::string description() const;

 private:
  bool find(const driver::Program& program, const std::string& text, bool interprets, Kernel& kernel,
            support::Diagnostics& diagnostics) const;
  bool compile(const driver::Program& program, const std::string& text, support::Diagnostics& diagnostics) const;
  std::string key_of(const std::string& text) const;
  std::string entry_of(const std::string& text) const;

  std::unique_ptr<const Toolchain> toolchain_;
  Execution execution_;
  CppText cpp_;
  std::string keep_;
  std::string surroundings_;  ///< a hash of everything but the text that decides the machine code
  std::map<std::string, std::unique_ptr<Kernel>> kernels_;  ///< by key
  std::map<uint64_t, const Kernel*> kernel_of_program_;     ///< by Program::number, of those that have one
  std::unique_ptr<Builds> builds_;  ///< which refers to kernels: the first to end
  double seconds_ = 0;
};

}  // namespace isoshade::cpu
