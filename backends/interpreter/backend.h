// SPDX-License-Identifier: Apache-2.0
// The interpreter backend runs the IR itself, one pixel at a time on one thread. It needs neither a compiler nor a
// device, and shares neither generated text nor the fast rasteriser with the other backends: tests compare both with
// it.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "backends/backend.h"

namespace isoshade::interpreter {

std::unique_ptr<backends::Backend> create();

/// Runs one kernel of a module, with a number type of its own. See ir::Interpreter for the interface.
class Machine {
 public:
  virtual ~Machine() = default;
  virtual void bind(uint32_t buffer, std::span<const uint32_t> words) = 0;
  virtual void run(uint32_t function, std::span<const uint32_t> arguments, std::span<uint32_t> results) = 0;
};
using MakeMachine = std::function<std::unique_ptr<Machine>(const driver::Program&)>;

/// The machine of this backend: ir::Interpreter.
std::unique_ptr<Machine> make_machine(const driver::Program& program);

/// The same backend on other machines.
std::unique_ptr<backends::Backend> create(std::string name, std::string description, MakeMachine make);

}  // namespace isoshade::interpreter
