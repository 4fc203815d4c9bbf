// SPDX-License-Identifier: Apache-2.0
// The interpreter backend runs the IR itself, on all threads. It needs neither a compiler nor a device, and shares neither
// generated text nor the fast rasteriser with the other backends: tests compare both with it.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "backends/backend.h"
#include "backends/interpreter/code.h"

namespace isoshade::interpreter {

/// `threads`: 0: as many as there are cores. `lanes`: see Code.
std::unique_ptr<backends::Backend> create(int threads = 0, int lanes = Code::widest_lanes());

/// Runs the kernel of a program, with a number type of its own.
class Machine {
 public:
  virtual ~Machine() = default;
  /// See Code::run; of each call's result words the first stored_words() are stored. All runs of a machine are given the
  /// same buffers.
  virtual void run(const BufferView* buffers, std::span<const Argument> arguments, int count, void* results) = 0;
};
using MakeMachine = std::function<std::unique_ptr<Machine>(const driver::Program&)>;

/// The machine of this backend: batched.
std::unique_ptr<Machine> make_machine(const driver::Program& program, int lanes = Code::widest_lanes());

/// The same backend on other machines, which run one at a time on one thread.
std::unique_ptr<backends::Backend> create(std::string name, std::string description, MakeMachine make);

}  // namespace isoshade::interpreter
