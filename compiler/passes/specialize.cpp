// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/passes.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "compiler/functions/library.h"
#include "compiler/ir/laws.h"
#include "compiler/passes/bind.h"
#include "compiler/support/assert.h"
#include "compiler/support/name_table.h"

namespace isoshade::passes {

namespace {

/// Clones multiply with the depth of calls: two calls with constants in each of 30 nested functions would make 2^30.
/// The limit is far more than any device compiles in a shader.
constexpr size_t max_cloned_instructions = 200'000;

using Words = KnownWords;

class Specializer {
 public:
  explicit Specializer(ir::Module& module) : module_(module) {
    for (const ir::Function& function : module.functions) names_.add(function.name);
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
      if (module_.functions[call.imm].is_declaration()) continue;  // the host's
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
    clone.name = free_name(name_of(clone, arguments));
    clone.library.clear();
    bind_parameters(clone, arguments);
    cloned_instructions_ += clone.instructions.size();
    module_.functions.push_back(std::move(clone));
    arithmetic_.push_back(arithmetic_[callee]);  // until it is folded
    return entry->second = static_cast<uint32_t>(module_.functions.size() - 1);
  }

  /// A float in letters: 0.04 is "0_04".
  static std::string in_letters(uint32_t bits) {
    char buffer[32];
    const char* end = std::to_chars(buffer, buffer + sizeof buffer, std::bit_cast<float>(bits)).ptr;
    std::string text;
    for (const char* c = buffer; c != end; ++c) {
      if (*c == '-') text += "minus_";
      if (*c == '.') text += '_';
      if (*c != '-' && *c != '.' && *c != '+') text += *c;
    }
    return text;
  }

  /// The function and what is constant in it: "iso_pow_2_4", "sky_roughness_1". The library's parameters say nothing.
  static std::string name_of(const ir::Function& function, const std::vector<Words>& arguments) {
    constexpr size_t most_written = 2;
    const auto is_constant = [](const Words& words) { return words.has_value(); };
    const auto written = static_cast<size_t>(std::ranges::count_if(arguments, is_constant));
    const std::string whole = own_name(function);
    std::string name = whole;
    for (size_t i = 0; i < arguments.size() && written <= most_written; ++i) {
      if (!arguments[i]) continue;
      const ir::Parameter& parameter = function.parameters[i];
      if (function.library.empty()) name += "_" + parameter.name;
      const auto differs = [&](uint32_t word) { return word != arguments[i]->front(); };
      if (parameter.type.is_float() && std::ranges::none_of(*arguments[i], differs))
        name += "_" + in_letters(arguments[i]->front());
      if (parameter.type == ir::int_type && static_cast<int32_t>(arguments[i]->front()) >= 0)
        name += "_" + std::to_string(arguments[i]->front());
    }
    return name == whole ? name + "_of_constants" : name;
  }

  /// Without the types that tell apart variants of a row: "iso_mix", not "iso_mix_v3v3f".
  static std::string own_name(const ir::Function& function) {
    const auto variant =
        std::ranges::find(functions::variants(), function.library, &functions::Variant::name);
    if (variant == functions::variants().end()) return function.name;
    return function.name.substr(0, function.name.size() - variant->name.size()) + std::string(variant->row);
  }

  std::string free_name(const std::string& name) {
    std::string free = name;
    while (!names_.add(free).is_new) free = name + "_" + std::to_string(++numbers_[name]);
    return free;
  }

  ir::Module& module_;
  std::vector<std::optional<bool>> arithmetic_;
  std::map<std::pair<uint32_t, std::vector<Words>>, uint32_t> clones_;
  support::NameTable names_;  ///< of all functions
  std::map<std::string, int> numbers_;
  size_t cloned_instructions_ = 0;
};

/// Puts the bodies of short clones of library functions where they are called: `0.04 * (1.0 - c) + b * c`.
class Inliner {
 public:
  Inliner(ir::Module& module, uint32_t first_clone) : module_(module), first_clone_(first_clone) {}

  void run() {
    if (first_clone_ == module_.functions.size()) return;
    short_.assign(module_.functions.size(), false);
    // What has nothing but calls of short clones may be short itself then.
    while (find_short())
      for (ir::Function& function : module_.functions)
        if (!function.is_declaration()) inline_calls(function);
  }

 private:
  static constexpr int most_operations = 5;

  /// Whether there are more than were known.
  bool find_short() {
    bool found = false;
    for (size_t f = first_clone_; f < module_.functions.size(); ++f) {
      if (short_[f] || !is_short(module_.functions[f])) continue;
      short_[f] = found = true;
    }
    return found;
  }

  static bool is_short(const ir::Function& f) {
    if (!f.document.empty() || f.blocks.size() != 1 || f.results.size() != 1) return false;
    int operations = 0;
    for (const ir::InstructionId id : f.blocks[0].instructions) {
      const ir::Opcode op = f.instructions[id].op;
      if (ir::is_primitive(op)) ++operations;
      if (!ir::is_primitive(op) && op != ir::Opcode::constant) return false;
    }
    // What the last instruction makes is returned, so it can make what the call made.
    return operations <= most_operations && operations > 0 &&
           f.instructions[f.blocks[0].instructions.back()].first_result == f.blocks[0].yields[0];
  }

  void inline_calls(ir::Function& f) const {
    for (ir::Block& block : f.blocks) {
      const auto is_inlined = [&](ir::InstructionId id) {
        return f.instructions[id].op == ir::Opcode::call && short_[f.instructions[id].imm];
      };
      if (std::ranges::none_of(block.instructions, is_inlined)) continue;
      std::vector<ir::InstructionId> list;
      for (const ir::InstructionId id : block.instructions)
        is_inlined(id) ? append_body(f, id, list) : list.push_back(id);
      block.instructions = std::move(list);
    }
  }

  void append_body(ir::Function& f, ir::InstructionId call_id, std::vector<ir::InstructionId>& list) const {
    const ir::Instruction call = f.instructions[call_id];
    const ir::Function& body = module_.functions[call.imm];
    std::vector<ir::ValueId> values(body.values.size(), ir::none);
    for (size_t i = 0; i < body.parameters.size(); ++i)
      values[body.blocks[0].parameters[i]] = f.operands[call.first_operand + i];
    for (const ir::InstructionId id : body.blocks[0].instructions) {
      ir::Instruction made = body.instructions[id];
      const auto operands = body.operands_of(made);
      made.first_operand = static_cast<uint32_t>(f.operands.size());
      for (const ir::ValueId operand : operands) f.operands.push_back(values[operand]);
      made.origin = call.origin;
      ir::ValueId& result = values[made.first_result];
      if (made.first_result == body.blocks[0].yields[0]) {
        result = call.first_result;
      } else {
        result = static_cast<ir::ValueId>(f.values.size());
        f.values.push_back({body.type(made.first_result), 0});
      }
      made.first_result = result;
      f.instructions.push_back(made);
      list.push_back(static_cast<ir::InstructionId>(f.instructions.size() - 1));
    }
  }

  ir::Module& module_;
  uint32_t first_clone_;
  std::vector<bool> short_;  ///< by function
};

}  // namespace

void specialize(ir::Module& module) {
  const auto before = static_cast<uint32_t>(module.functions.size());
  Specializer specializer(module);
  // Folding a clone makes further arguments constant, one level of calls deeper each time.
  for (size_t first = 0, count = module.functions.size(); specializer.step(first);) {
    fold(module, {}, count);
    first = std::exchange(count, module.functions.size());
  }
  Inliner(module, before).run();
}

}  // namespace isoshade::passes
