// SPDX-License-Identifier: Apache-2.0
// A program for the batched interpreter, with the functions that compiled code has (targets/cpp/stages.h). The caller
// holds an FpGuard.
#pragma once

#include "backends/interpreter/code.h"
#include "compiler/driver/program.h"

namespace isoshade::interpreter {

class Stages {
 public:
  explicit Stages(const driver::Program& program, int lanes = Code::widest_lanes());

  void vertex(const BufferView* buffers, int object, int projected, int first, int count, float* clip) const;
  void pixel(const BufferView* buffers, int object, int light_count, int count, const int* x, const int* y,
             const int* triangle, float* rgba) const;
  void blend(const BufferView* buffers, int object, int light_count, int count, const int* x, const int* y,
             const int* triangle, float* rgba) const;
  void cutout(const BufferView* buffers, int object, int count, const int* x, const int* y, const int* triangle,
              int* drawn) const;
  void post(const BufferView* buffers, int first, int y, int count, float* rgba) const;
  void eval(const BufferView* buffers, int first, int count, int* results) const;

  const Code& code() const { return code_; }

 private:
  Code code_;
};

/// The words that a stage stores for each call, of those that its kernel returns.
size_t stored_words(const driver::Program& program);

}  // namespace isoshade::interpreter
