// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/target_limits.h"

#include <algorithm>
#include <fmt/format.h>

#include "compiler/ir/expansion.h"
#include "compiler/support/visible.h"
#include "compiler/targets/cpp/cpp.h"

namespace isoshade::driver {

namespace {

constexpr uint64_t operations_of_exact_division = 40;

struct Limit {
  std::string_view name;
  uint64_t most;
  std::string_view fix;
};

Limit limit_of(Target target) {
  switch (target) {
    case Target::vulkan:
      return {"a Vulkan driver, which expands all calls,", most_operations_on_vulkan,
              "make functions that are called several times smaller; or use --backend cpu (compile: --target cpp), "
              "which keeps large functions as calls"};
    case Target::cpu:
      return {"the cpu backend", most_operations_on_cpu, "make functions that are called several times smaller"};
    case Target::interpreter: break;
  }
  return {"the interpreter", most_operations_on_interpreter,
          "make functions that are called several times smaller; or use --backend cpu"};
}

/// A node, and the number of operations that it lowers to.
struct Heaviest {
  const ir::Origin* node = nullptr;
  uint64_t operations = 0;
};

/// The node of the function with the most operations.
Heaviest heaviest_node(const ir::Function& function, const std::vector<uint64_t>& of_functions) {
  std::vector<uint64_t> sums(function.origins.size());
  for (const ir::Block& block : function.blocks)
    for (const ir::InstructionId id : block.instructions) {
      const ir::Instruction& made = function.instructions[id];
      // The instructions of nested blocks are visited separately.
      if (made.blocks[0] == ir::none)
        sums[made.origin] += ir::expanded_operations(function, made, of_functions);
    }
  if (sums.size() < 2) return {};
  const auto most = std::max_element(sums.begin() + 1, sums.end());
  return {&function.origins[static_cast<size_t>(most - sums.begin())], *most};
}

/// The call with the most operations in a function; null if there are no calls.
const ir::Instruction* heaviest_call(const ir::Function& function,
                                     const std::vector<uint64_t>& of_functions) {
  const ir::Instruction* most = nullptr;
  for (const ir::Block& block : function.blocks)
    for (const ir::InstructionId id : block.instructions) {
      const ir::Instruction& made = function.instructions[id];
      if (made.op != ir::Opcode::call) continue;
      if (most == nullptr || of_functions[made.imm] > of_functions[most->imm]) most = &made;
    }
  return most;
}

/// What is measured.
struct Measured {
  const ir::Module& module;
  uint32_t entry;
  std::string what;  ///< "pixel program of \"fur\""
  const support::Source& source;
};

/// The document's own function, below the stages around it; null if there is none.
const ir::Function* authored(const Measured& program, const std::vector<uint64_t>& of_functions) {
  const ir::Function* function = &program.module.functions[program.entry];
  while (function->document.empty()) {
    const ir::Instruction* call = heaviest_call(*function, of_functions);
    if (call == nullptr) return nullptr;
    function = &program.module.functions[call->imm];
  }
  return function;
}

/// The span of the node's name in the document.
support::Span place_of(const support::Source& source, const ir::Origin& node) {
  if (source == nullptr || node.line == 0) return {};
  const std::string_view line = source->line(node.line);
  const std::string name = "\"" + node.node + "\"";
  size_t at = line.find(name + ":");
  if (at == std::string_view::npos) at = line.find(name);
  const bool found = at != std::string_view::npos;
  const auto begin =
      static_cast<uint32_t>(line.data() - source->text().data()) + static_cast<uint32_t>(found ? at : 0);
  return {source, begin, begin + static_cast<uint32_t>(found ? name.size() : line.size())};
}

bool within_limits(const Measured& program, Target target, Division division, support::Diagnostics& diagnostics) {
  if (program.module.functions.empty()) return true;  // only text, no module to count
  const uint64_t of_division = division == Division::exact ? operations_of_exact_division : 1;
  const std::vector<uint64_t> of_functions =
      ir::expanded_operations(program.module, program.entry, of_division);
  const uint64_t operations = of_functions[program.entry];
  const Limit limit = limit_of(target);
  const uint64_t in_text = target == Target::cpu ? cpp::operations(program.module, program.entry) : 0;
  if (operations <= limit.most && in_text <= most_operations_in_cpp) return true;

  const ir::Function* function = authored(program, of_functions);
  const Heaviest heaviest = function != nullptr ? heaviest_node(*function, of_functions) : Heaviest{};
  const bool known = heaviest.node != nullptr && heaviest.operations != 0;
  support::Diagnostic& report =
      diagnostics
          .report(
              support::Id::too_large, known ? place_of(program.source, *heaviest.node) : support::Span{},
              operations <= limit.most
                  ? fmt::format(
                        "the C++ of the {} has {} operations; the limit for a compiler is {}", program.what,
                        in_text, most_operations_in_cpp)
                  : fmt::format("with all calls expanded, the {} has {} operations; the limit for {} is {}",
                                program.what, operations, limit.name, limit.most))
          .suggest(operations <= limit.most ? "use --backend interpreter" : std::string(limit.fix));
  if (known)
    report.note(
        fmt::format("{} of them belong to node {}", heaviest.operations, support::quote(heaviest.node->node)));
  return false;
}

}  // namespace

bool within_limits(const Program& program, Target target, Division division, support::Diagnostics& diagnostics) {
  const std::string what = std::string(name(program.stage)) + " program of " + support::quote(program.name);
  return within_limits(Measured{program.module, program.entry, what, program.source}, target, division, diagnostics);
}

bool within_limits(const Shader& shader, const emit::Target& target, Division division,
                   support::Diagnostics& diagnostics) {
  return std::ranges::all_of(shader.pure.functions, [&](const emit::PureFunction& function) {
    const std::string what = "function " + emit::function_name(shader.pure, function, true);
    return within_limits(Measured{shader.pure.module, function.entry, what, shader.typed->graph.source},
                         target.keeps_calls ? Target::cpu : Target::vulkan, division, diagnostics);
  });
}

}  // namespace isoshade::driver
