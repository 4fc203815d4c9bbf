// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "compiler/emit/printer.h"
#include "compiler/ir/module.h"

namespace isoshade::emit {

/// One 32-bit word of a kernel's results: how it is reached from the value called `value`, and its type.
struct ResultWord {
  std::string text;
  ir::Scalar scalar;
};

std::vector<ResultWord> result_words(const ir::Function& kernel, const FunctionText& text,
                                     const std::string& value);

/// The buffers that a function and those it calls load from.
std::vector<bool> used_buffers(const ir::Module& module, uint32_t entry);

}  // namespace isoshade::emit
