// SPDX-License-Identifier: Apache-2.0
// The interpreter backend: the IR itself, a pixel at a time on one thread. It needs no compiler and no
// device, shares no generated text and no fast rasteriser with the others, and so bears witness to both.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "backends/backend.h"

namespace isoshade::interpreter {

std::unique_ptr<backends::Backend> create();

/// Runs one kernel of a module; what a float is, is its own affair. ir::Interpreter tells the rest.
class Machine {
 public:
  virtual ~Machine() = default;
  virtual void bind(uint32_t buffer, std::span<const uint32_t> words) = 0;
  virtual void run(uint32_t function, std::span<const uint32_t> arguments, std::span<uint32_t> results) = 0;
};
using MakeMachine = std::function<std::unique_ptr<Machine>(const driver::Program&)>;

/// The machine of this backend: ir::Interpreter.
std::unique_ptr<Machine> make_machine(const driver::Program& program);

/// The same steps on other machines.
std::unique_ptr<backends::Backend> create(std::string name, std::string description, MakeMachine make);

}  // namespace isoshade::interpreter
