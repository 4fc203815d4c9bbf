// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/passes.h"

#include <algorithm>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

#include "compiler/ir/uniformity.h"

namespace isoshade::passes {

namespace {

using namespace ir;

/// Whether an instruction costs nothing in emitted text, so that each part may have its own copy.
bool is_constant(Opcode op) { return op == Opcode::constant || op == Opcode::hidden_zero; }

/// By a number of one function: what it became in another, or none.
class Copies {
 public:
  uint32_t operator[](uint32_t of) const { return of < copies_.size() ? copies_[of] : none; }
  void set(uint32_t of, uint32_t copy) {
    if (of >= copies_.size()) copies_.resize(2 * size_t{of} + 1, none);
    copies_[of] = copy;
    set_.push_back(of);
  }
  /// As if none had been set. Takes as long as was set.
  void clear() {
    for (const uint32_t of : set_) copies_[of] = none;
    set_.clear();
  }

 private:
  std::vector<uint32_t> copies_;
  std::vector<uint32_t> set_;
};

/// Copies instructions of one function into another, which gets the values that it lacks as parameters.
class Part {
 public:
  /// `values` and `origins` are used again for each part: they are as large as the function.
  Part(const Function& from, const std::vector<InstructionId>& made_by, const std::vector<bool>& uniform, Copies& values,
       Copies& origins)
      : from_(from), made_by_(made_by), uniform_(uniform), values_(values), origins_(origins) {
    values_.clear();
    origins_.clear();
    part_.document = from.document;
    part_.blocks.emplace_back();
  }

  void add(InstructionId id) {
    const InstructionId copied = copy(id);  // may add blocks
    part_.blocks[0].instructions.push_back(copied);
  }
  void yield(ValueId value) {
    part_.blocks[0].yields.push_back(read(value));
    part_.results.push_back({name_of(value), from_.type(value)});
  }

  Function take() {
    auto& instructions = part_.blocks[0].instructions;
    instructions.insert(instructions.begin(), constants_.begin(), constants_.end());
    return std::move(part_);
  }
  /// The values of the other function that parameters stand for, in their order.
  const std::vector<ValueId>& arguments() const { return arguments_; }

 private:
  ValueId new_value(ValueId of) {
    part_.values.push_back({from_.type(of), origin(from_.values[of].names)});
    const auto made = static_cast<ValueId>(part_.values.size() - 1);
    values_.set(of, made);
    return made;
  }

  uint32_t origin(uint32_t of) {
    if (of == 0) return 0;
    if (origins_[of] != none) return origins_[of];
    origins_.set(of, static_cast<uint32_t>(part_.origins.size()));
    part_.origins.push_back(from_.origins[of]);
    return origins_[of];
  }

  std::string name_of(ValueId value) {
    const uint32_t origin = from_.values[value].names;
    const std::string wanted = origin != 0 ? from_.origins[origin].node : "t";
    std::string name = wanted;
    for (int i = 1; !names_.insert(name).second; ++i) name = wanted + "_" + std::to_string(i);
    return name;
  }

  ValueId read(ValueId value) {
    if (values_[value] != none) return values_[value];
    if (made_by_[value] != none && is_constant(from_.instructions[made_by_[value]].op)) {
      constants_.push_back(copy(made_by_[value]));
      return values_[value];
    }
    const ValueId made = new_value(value);
    part_.values[made].names = 0;  // a parameter has a name of its own
    part_.blocks[0].parameters.push_back(made);
    part_.parameters.push_back({name_of(value), from_.type(value), "", uniform_[value]});
    arguments_.push_back(value);
    return made;
  }

  BlockId copy_block(BlockId id) {
    const Block& block = from_.blocks[id];
    const auto made = static_cast<BlockId>(part_.blocks.size());
    part_.blocks.emplace_back();
    Block copied;
    for (ValueId parameter : block.parameters) copied.parameters.push_back(new_value(parameter));
    for (InstructionId instruction : block.instructions) copied.instructions.push_back(copy(instruction));
    for (ValueId value : block.yields) copied.yields.push_back(read(value));
    part_.blocks[made] = std::move(copied);
    return made;
  }

  InstructionId copy(InstructionId id) {
    Instruction made = from_.instructions[id];
    // Reading an operand may copy a constant, which has none.
    const size_t first_operand = part_.operands.size();
    for (ValueId operand : from_.operands_of(made)) part_.operands.push_back(read(operand));
    made.first_operand = static_cast<uint32_t>(first_operand);
    for (BlockId& block : made.blocks)
      if (block != none) block = copy_block(block);
    const ValueId first = made.first_result;
    made.first_result = static_cast<ValueId>(part_.values.size());
    for (uint32_t i = 0; i < made.result_count; ++i) new_value(first + i);
    made.origin = origin(made.origin);
    part_.instructions.push_back(made);
    return static_cast<InstructionId>(part_.instructions.size() - 1);
  }

  const Function& from_;
  const std::vector<InstructionId>& made_by_;
  const std::vector<bool>& uniform_;
  Function part_;
  Copies& values_;
  Copies& origins_;
  std::unordered_set<std::string> names_;
  std::vector<InstructionId> constants_;  ///< come first: blocks that are copied first may be read by all
  std::vector<ValueId> arguments_;
};

class Cutter {
 public:
  Cutter(Module& module, uint32_t function, size_t longest, std::unordered_set<std::string>& names)
      : module_(module), function_(function), longest_(longest), names_(names) {}

  void run() {
    uniform_ = uniform_values(f());
    made_by_.assign(f().values.size(), none);
    for (InstructionId id = 0; id < f().instructions.size(); ++id)
      for (uint32_t i = 0; i < f().instructions[id].result_count; ++i)
        made_by_[f().instructions[id].first_result + i] = id;
    cut(0);
  }

 private:
  enum class Kind : uint8_t { constant, uniform, varying, fixed };

  Function& f() { return module_.functions[function_]; }

  size_t weight(InstructionId id) {
    const Instruction& made = f().instructions[id];
    if (is_constant(made.op) || made.op == Opcode::extract) return 0;
    size_t sum = 1;
    if (made.op == Opcode::call) sum += (made.operand_count + made.result_count) / 8;
    for (BlockId block : made.blocks)
      if (block != none) sum += weight_of_block(block);
    return sum;
  }
  size_t weight_of_block(BlockId block) {
    size_t sum = 0;
    for (InstructionId id : f().blocks[block].instructions) sum += weight(id);
    return sum;
  }

  Kind kind(InstructionId id) {
    const Instruction& made = f().instructions[id];
    if (is_constant(made.op)) return Kind::constant;
    uint32_t uniform = 0;
    for (uint32_t i = 0; i < made.result_count; ++i) uniform += uniform_[made.first_result + i] ? 1 : 0;
    // Uniform values read no varying ones, so they come first. Their blocks may read some, in unused results.
    const bool mixed = uniform != 0 && (uniform != made.result_count || made.blocks[0] != none);
    if (mixed || made.operand_count > 2 * longest_ || weight(id) > longest_) return Kind::fixed;
    return uniform != 0 ? Kind::uniform : Kind::varying;
  }

  void cut(BlockId block) {
    // Cutting adds instructions, so hold no reference into the function.
    for (const InstructionId id : std::vector(f().blocks[block].instructions)) {
      const auto inner_blocks = f().instructions[id].blocks;
      for (const BlockId inner : inner_blocks)
        if (inner != none) cut(inner);
    }
    // Calls of parts are instructions, too; each round leaves fewer, if parts pass less than they compute.
    for (size_t before = weight_of_block(block); before > longest_;) {
      cut_once(block);
      const size_t after = weight_of_block(block);
      if (after >= before - before / 4) return;
      before = after;
    }
  }

  /// A run of instructions that becomes a part.
  struct Run {
    std::vector<InstructionId> instructions;
    size_t weight = 0;
    bool fixed = false;  ///< it stays where it is
  };

  void cut_once(BlockId block) {
    const std::vector<InstructionId> before = f().blocks[block].instructions;
    // Which run each instruction goes to; what stays where it is has a run of its own.
    std::vector<Run> runs;
    std::vector<size_t> order;  // of runs
    constexpr size_t closed = ~size_t{0};
    size_t open[2] = {closed, closed};  // uniform, varying
    const auto close = [&](size_t which) {
      if (open[which] != closed) order.push_back(open[which]);
      open[which] = closed;
    };
    std::vector<InstructionId> constants;
    for (const InstructionId id : before) {
      const Kind what = kind(id);
      if (what == Kind::constant) {
        constants.push_back(id);
        continue;
      }
      if (what == Kind::fixed) {
        close(0);
        close(1);
        order.push_back(runs.size());
        runs.push_back({{id}, 0, true});
        continue;
      }
      const size_t which = what == Kind::uniform ? 0 : 1;
      if (open[which] == closed) {
        open[which] = runs.size();
        runs.emplace_back();
      }
      Run& run = runs[open[which]];
      run.instructions.push_back(id);
      run.weight += weight(id);
      if (run.weight < longest_) continue;
      close(0);  // varying values may read uniform ones, never the reverse
      if (which == 1) close(1);
    }
    close(0);
    close(1);
    replace(block, constants, runs, order);
  }

  void replace(BlockId block, std::vector<InstructionId> list, const std::vector<Run>& runs,
               const std::vector<size_t>& order) {
    // Values of this block that are read by another run than their own, or yielded.
    std::vector<size_t> run_of(f().values.size(), ~size_t{0});
    for (size_t r = 0; r < runs.size(); ++r)
      for (const InstructionId id : runs[r].instructions)
        for (uint32_t i = 0; i < f().instructions[id].result_count; ++i)
          run_of[f().instructions[id].first_result + i] = r;
    std::vector<bool> leaves(f().values.size());
    for (size_t r = 0; r < runs.size(); ++r)
      for (const InstructionId id : runs[r].instructions)
        for_each_read(id, [&](ValueId value) { leaves[value] = leaves[value] || run_of[value] != r; });
    for (const ValueId value : f().blocks[block].yields) leaves[value] = true;

    renamed_.resize(f().values.size());
    for (ValueId value = 0; value < renamed_.size(); ++value) renamed_[value] = value;
    for (const size_t r : order) {
      for (const InstructionId id : runs[r].instructions) rename(id);
      // A call must be shorter than what it stands for.
      if (!runs[r].fixed && runs[r].weight >= longest_ / 4)
        move(runs[r], leaves, list);
      else
        list.insert(list.end(), runs[r].instructions.begin(), runs[r].instructions.end());
    }
    f().blocks[block].instructions = std::move(list);
    for (ValueId& value : f().blocks[block].yields) value = renamed_[value];
  }

  template <class Visit>
  void for_each_read(InstructionId id, Visit visit) {
    for (const ValueId value : f().operands_of(f().instructions[id])) visit(value);
    for (const BlockId block : f().instructions[id].blocks) {
      if (block == none) continue;
      for (const InstructionId inner : f().blocks[block].instructions) for_each_read(inner, visit);
      for (const ValueId value : f().blocks[block].yields) visit(value);
    }
  }

  void rename(InstructionId id) {
    const auto current = [&](ValueId value) { return value < renamed_.size() ? renamed_[value] : value; };
    for (ValueId& value : f().operands_of(f().instructions[id])) value = current(value);
    for (const BlockId block : f().instructions[id].blocks) {
      if (block == none) continue;
      for (const InstructionId inner : f().blocks[block].instructions) rename(inner);
      for (ValueId& value : f().blocks[block].yields) value = current(value);
    }
  }

  /// Makes a part of a run and appends a call of it to the list.
  void move(const Run& run, const std::vector<bool>& leaves, std::vector<InstructionId>& list) {
    Part part(f(), made_by_, uniform_, copied_values_, copied_origins_);
    std::vector<ValueId> results;
    for (const InstructionId id : run.instructions) {
      part.add(id);
      for (uint32_t i = 0; i < f().instructions[id].result_count; ++i)
        if (leaves[f().instructions[id].first_result + i])
          results.push_back(f().instructions[id].first_result + i);
    }
    if (results.empty()) return;  // nothing reads it
    for (const ValueId result : results) part.yield(result);
    Function made = part.take();
    do {
      made.name = f().name + "_part_" + std::to_string(++parts_);
    } while (!names_.insert(made.name).second);

    Instruction call;
    call.op = Opcode::call;
    call.imm = static_cast<uint32_t>(module_.functions.size());
    call.first_operand = static_cast<uint32_t>(f().operands.size());
    call.operand_count = static_cast<uint32_t>(part.arguments().size());
    f().operands.insert(f().operands.end(), part.arguments().begin(), part.arguments().end());
    call.first_result = static_cast<ValueId>(f().values.size());
    call.result_count = static_cast<uint32_t>(results.size());
    const auto id = static_cast<InstructionId>(f().instructions.size());
    for (const ValueId result : results) {
      renamed_[result] = static_cast<ValueId>(f().values.size());
      f().values.push_back(f().values[result]);
      uniform_.push_back(uniform_[result]);
      made_by_.push_back(id);
    }
    f().instructions.push_back(call);
    list.push_back(id);
    module_.functions.push_back(std::move(made));
  }

  Module& module_;
  uint32_t function_;
  size_t longest_;
  std::unordered_set<std::string>& names_;  ///< of all functions
  std::vector<bool> uniform_;               ///< by value
  std::vector<InstructionId> made_by_;      ///< by value; none: a parameter
  std::vector<ValueId> renamed_;            ///< by value that was there before
  Copies copied_values_, copied_origins_;   ///< of the part that is made
  int parts_ = 0;
};

}  // namespace

void cut_long(Module& module, size_t longest) {
  std::unordered_set<std::string> names;
  for (const Function& function : module.functions) names.insert(function.name);
  const size_t count = module.functions.size();  // parts are short already
  for (uint32_t f = 0; f < count; ++f)
    if (!module.functions[f].is_declaration()) Cutter(module, f, longest, names).run();
}

}  // namespace isoshade::passes
