// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/passes.h"

#include <algorithm>
#include <map>
#include <optional>
#include <unordered_set>
#include <utility>
#include <vector>

#include "compiler/ir/laws.h"
#include "compiler/support/assert.h"

namespace isoshade::passes {

namespace {

/// Clones multiply with the depth of calls: two calls with constants in each of 30 nested functions would make 2^30.
/// The limit is far more than any device compiles in a shader.
constexpr size_t max_cloned_instructions = 200'000;

/// The words of a constant argument; nothing if it is not constant.
using Words = std::optional<std::vector<uint32_t>>;

class Specializer {
 public:
  explicit Specializer(ir::Module& module) : module_(module) {
    for (const ir::Function& function : module.functions) names_.insert(function.name);
  }

  /// One level of calls, in the functions from index `first` on; whether there was any to specialize.
  bool step(size_t first) {
    arithmetic_.assign(module_.functions.size(), std::nullopt);
    // Clones go to the end of the list; their own calls are the next step's.
    const size_t count = module_.functions.size();
    for (size_t f = first; f < count; ++f) specialize_calls(f);
    return module_.functions.size() > count;
  }

 private:
  static bool is_arithmetic(ir::Opcode op) {
    return ir::is_primitive(op) && ir::info(op).rule == ir::Rule::same && !ir::is_exact(op);
  }

  bool has_arithmetic(size_t f) {
    if (!arithmetic_[f]) arithmetic_[f] = finds_arithmetic(module_.functions[f]);
    return *arithmetic_[f];
  }

  /// Whether a callee computes with its arguments, or may otherwise show a constant to a driver. Of functions
  /// without arithmetic, only those of the library are known to do no more than choose.
  bool finds_arithmetic(const ir::Function& function) {
    if (function.library.empty()) return true;
    // Only instructions in a block count: the others have been replaced.
    for (const ir::Block& block : function.blocks)
      for (ir::InstructionId id : block.instructions) {
        const ir::Instruction& instruction = function.instructions[id];
        if (is_arithmetic(instruction.op)) return true;
        if (instruction.op == ir::Opcode::call && has_arithmetic(instruction.imm)) return true;
      }
    return false;
  }

  /// The instruction that makes each value; none for parameters.
  static std::vector<ir::InstructionId> definitions(const ir::Function& function) {
    std::vector<ir::InstructionId> made(function.values.size(), ir::none);
    for (ir::InstructionId id = 0; id < function.instructions.size(); ++id) {
      const ir::Instruction& instruction = function.instructions[id];
      for (uint32_t i = 0; i < instruction.result_count; ++i) made[instruction.first_result + i] = id;
    }
    return made;
  }

  static bool is_constant(const ir::Function& function, const std::vector<ir::InstructionId>& made,
                          ir::ValueId value) {
    if (made[value] == ir::none) return false;
    const ir::Instruction& instruction = function.instructions[made[value]];
    if (instruction.op != ir::Opcode::construct) return instruction.op == ir::Opcode::constant;
    return std::ranges::all_of(function.operands_of(instruction),
                               [&](ir::ValueId component) { return is_constant(function, made, component); });
  }

  static Words constant_words(const ir::Function& function, const std::vector<ir::InstructionId>& made,
                              ir::ValueId value) {
    if (!is_constant(function, made, value)) return std::nullopt;
    const ir::Instruction& instruction = function.instructions[made[value]];
    if (instruction.op == ir::Opcode::constant) return std::vector{instruction.imm};
    std::vector<uint32_t> words;
    for (ir::ValueId component : function.operands_of(instruction))
      words.push_back(function.instructions[made[component]].imm);
    return words;
  }

  static std::vector<ir::InstructionId> calls_in_blocks(const ir::Function& function) {
    std::vector<ir::InstructionId> calls;
    for (const ir::Block& block : function.blocks)
      for (ir::InstructionId id : block.instructions)
        if (function.instructions[id].op == ir::Opcode::call) calls.push_back(id);
    return calls;
  }

  void specialize_calls(size_t f) {
    std::vector<ir::InstructionId> made;
    // Instructions that fold replaced are in no block any more.
    for (const ir::InstructionId i : calls_in_blocks(module_.functions[f])) {
      const ir::Instruction call = module_.functions[f].instructions[i];
      if (!has_arithmetic(call.imm) || cloned_instructions_ > max_cloned_instructions) continue;
      if (made.empty()) made = definitions(module_.functions[f]);
      const auto operands = module_.functions[f].operands_of(call);
      const auto is_constant_here = [&](ir::ValueId v) { return is_constant(module_.functions[f], made, v); };
      if (std::ranges::none_of(operands, is_constant_here)) continue;
      std::vector<Words> arguments;
      for (ir::ValueId operand : operands)
        arguments.push_back(constant_words(module_.functions[f], made, operand));
      const uint32_t callee = clone_for(call.imm, arguments);
      // The remaining arguments move to the front of the call's operands.
      ir::Function& caller = module_.functions[f];
      ir::Instruction& instruction = caller.instructions[i];
      instruction.imm = callee;
      uint32_t kept = 0;
      for (uint32_t a = 0; a < call.operand_count; ++a)
        if (!arguments[a])
          caller.operands[call.first_operand + kept++] = caller.operands[call.first_operand + a];
      instruction.operand_count = kept;
    }
  }

  uint32_t clone_for(uint32_t callee, const std::vector<Words>& arguments) {
    const auto [entry, is_new] = clones_.try_emplace({callee, arguments}, 0);
    if (!is_new) return entry->second;
    ir::Function clone = module_.functions[callee];
    clone.library.clear();
    clone.name = free_name(clone.name);
    bind(clone, arguments);
    cloned_instructions_ += clone.instructions.size();
    module_.functions.push_back(std::move(clone));
    arithmetic_.push_back(arithmetic_[callee]);  // until it is folded
    return entry->second = static_cast<uint32_t>(module_.functions.size() - 1);
  }

  std::string free_name(const std::string& name) {
    std::string free;
    do { free = name + "_" + std::to_string(++numbers_[name]); } while (!names_.insert(free).second);
    return free;
  }

  /// Makes parameters constants: each keeps its value's id, which an instruction at the head now defines.
  static void bind(ir::Function& function, const std::vector<Words>& arguments) {
    std::vector<ir::Parameter> parameters;
    std::vector<ir::ValueId> values;
    std::vector<ir::InstructionId> head;
    for (size_t i = 0; i < arguments.size(); ++i) {
      const ir::ValueId value = function.blocks[0].parameters[i];
      if (!arguments[i]) {
        parameters.push_back(function.parameters[i]);
        values.push_back(value);
      } else {
        define(function, value, *arguments[i], head);
      }
    }
    function.parameters = std::move(parameters);
    function.blocks[0].parameters = std::move(values);
    auto& instructions = function.blocks[0].instructions;
    instructions.insert(instructions.begin(), head.begin(), head.end());
  }

  static void define(ir::Function& function, ir::ValueId value, const std::vector<uint32_t>& words,
                     std::vector<ir::InstructionId>& head) {
    const auto append = [&](const ir::Instruction& instruction) {
      function.instructions.push_back(instruction);
      head.push_back(static_cast<ir::InstructionId>(function.instructions.size() - 1));
    };
    ir::Instruction constant;
    constant.op = ir::Opcode::constant;
    if (words.size() == 1) {
      constant.imm = words[0];
      constant.first_result = value;
      return append(constant);
    }
    ir::Instruction construct;
    construct.op = ir::Opcode::construct;
    construct.first_operand = static_cast<uint32_t>(function.operands.size());
    construct.operand_count = static_cast<uint32_t>(words.size());
    construct.first_result = value;
    for (uint32_t word : words) {
      function.values.push_back({ir::float_type, 0});
      constant.imm = word;
      constant.first_result = static_cast<ir::ValueId>(function.values.size() - 1);
      append(constant);
    }
    for (size_t i = 0; i < words.size(); ++i)
      function.operands.push_back(static_cast<ir::ValueId>(function.values.size() - words.size() + i));
    append(construct);
  }

  ir::Module& module_;
  std::vector<std::optional<bool>> arithmetic_;
  std::map<std::pair<uint32_t, std::vector<Words>>, uint32_t> clones_;
  std::unordered_set<std::string> names_;  ///< of all functions
  std::map<std::string, int> numbers_;
  size_t cloned_instructions_ = 0;
};

}  // namespace

void specialize(ir::Module& module) {
  Specializer specializer(module);
  // Folding a clone makes further arguments constant, one level of calls deeper each time.
  for (size_t first = 0, count = module.functions.size(); specializer.step(first);) {
    fold(module, {}, count);
    first = std::exchange(count, module.functions.size());
  }
}

}  // namespace isoshade::passes
