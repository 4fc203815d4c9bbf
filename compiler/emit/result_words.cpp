// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/result_words.h"

#include <array>

#include "compiler/ir/call_graph.h"

namespace isoshade::emit {

std::vector<ResultWord> result_words(const ir::Function& kernel, const FunctionText& text,
                                     const std::string& value) {
  std::vector<ResultWord> words;
  for (size_t k = 0; k < kernel.results.size(); ++k) {
    // A kernel with several results returns a struct.
    const std::string result = text.result_fields.empty() ? value : value + "." + text.result_fields[k];
    const ir::Type type = kernel.results[k].type;
    for (int i = 0; i < type.width; ++i)
      words.push_back({type.width == 1 ? result : result + "." + "xyzw"[i], type.scalar});
  }
  return words;
}

std::vector<bool> used_buffers(const ir::Module& module, uint32_t entry) {
  std::vector<bool> used(module.buffers.size());
  const std::array entries{entry};
  const auto order = ir::callees_first(module, entries);
  for (uint32_t index : order.value())
    for (const ir::Instruction& instruction : module.functions[index].instructions)
      if (instruction.op == ir::Opcode::load) used[instruction.imm] = true;
  return used;
}

}  // namespace isoshade::emit
