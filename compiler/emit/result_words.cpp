// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/result_words.h"

#include <array>

#include "compiler/emit/names.h"
#include "compiler/ir/call_graph.h"

namespace isoshade::emit {

std::vector<ResultWord> result_words(const ir::Function& kernel, const std::string& value) {
  std::vector<ResultWord> words;
  Names fields;
  for (const ir::Result& result : kernel.results) {
    // A kernel with several results returns a struct.
    const std::string text = kernel.results.size() == 1 ? value : value + "." + fields.take(result.name);
    for (int i = 0; i < result.type.width; ++i)
      words.push_back({result.type.width == 1 ? text : text + "." + "xyzw"[i], result.type.scalar});
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
