// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numeric>
#include <utility>

#include "compiler/ir/call_graph.h"
#include "compiler/ir/expansion.h"
#include "compiler/ir/uniformity.h"
#include "compiler/passes/passes.h"

namespace isoshade::passes {

namespace {

using namespace ir;

constexpr uint64_t operations_of_division = 4;
/// Instructions looked at in a function: the time grows with the cube of its selects. Then it stays as it is.
constexpr uint64_t max_work = 4'000'000;

/// Which side of a branch uses a value.
enum class Side : uint8_t { neither, then, other, dead };

/// One block of a function at a time.
class Sinker {
 public:
  Sinker(Function& f, const std::vector<uint64_t>& of_functions, const SinkLimits& limits)
      : f_(f), of_functions_(of_functions), limits_(limits), uniform_(uniform_values(f)) {}

  size_t run() {
    visit(0, 1);
    return made_;
  }

 private:
  /// A use of an instruction of the block by another one, or by the block's yields.
  struct Use {
    uint32_t by;  ///< place in the block; that behind the last one is the yields'
    Side side;    ///< of a select or branch; neither: all of it needs the value
  };
  /// Selects on one condition, or one branch: what becomes one branch.
  struct Choice {
    ValueId condition = none;
    std::vector<uint32_t> members;  ///< places, from the last to the first
    std::vector<Side> sides;        ///< by place: which side alone needs the instruction
    std::array<uint64_t, 2> operations{};
  };

  void visit(BlockId block, int depth) {
    tried_.assign(f_.instructions.size(), false);
    if (depth < max_block_depth / 2)
      while (sink_one(block)) {
      }
    for (size_t i = 0; i < f_.blocks[block].instructions.size(); ++i) {
      const Instruction made = f_.instructions[f_.blocks[block].instructions[i]];
      for (const BlockId inner : made.blocks)
        if (inner != none) visit(inner, depth + 1);
    }
  }

  const Instruction& at(BlockId block, uint32_t place) const {
    return f_.instructions[f_.blocks[block].instructions[place]];
  }

  /// Makes one branch, the last that is worth it, or moves into one what only a side of it needs.
  bool sink_one(BlockId block) {
    if (work_ > max_work) return false;
    analyse(block);
    const auto size = static_cast<uint32_t>(f_.blocks[block].instructions.size());
    work_ += size;
    for (uint32_t place = size; place-- > 0;) {
      const Instruction& made = at(block, place);
      if ((made.op != Opcode::select && made.op != Opcode::branch) || uses_[place].empty()) continue;
      const InstructionId id = f_.blocks[block].instructions[place];
      if (tried_[id]) continue;
      tried_[id] = true;
      const Choice choice = choice_of(block, place);
      const bool is_branch = made.op == Opcode::branch;
      const uint64_t most = std::max(choice.operations[0], choice.operations[1]);
      if (most < (is_branch ? 1 : least(choice.condition))) continue;
      is_branch ? move_into_branch(block, choice) : make_branch(block, choice);
      return true;
    }
    return false;
  }

  uint64_t least(ValueId condition) const {
    return condition < uniform_.size() && uniform_[condition] ? limits_.uniform : limits_.varying;
  }

  void analyse(BlockId block) {
    const std::vector<InstructionId>& list = f_.blocks[block].instructions;
    place_of_.assign(f_.values.size(), none);
    uses_.assign(list.size(), {});
    for (uint32_t place = 0; place < list.size(); ++place) {
      const Instruction& made = f_.instructions[list[place]];
      for (uint32_t k = 0; k < made.result_count; ++k) place_of_[made.first_result + k] = place;
    }
    for (uint32_t place = 0; place < list.size(); ++place) add_uses(list[place], place);
    for (const ValueId yield : f_.blocks[block].yields) add_use(yield, static_cast<uint32_t>(list.size()), Side::neither);
  }

  void add_use(ValueId value, uint32_t by, Side side) {
    if (place_of_[value] != none) uses_[place_of_[value]].push_back({by, side});
  }

  void add_uses(InstructionId id, uint32_t by) {
    const Instruction& made = f_.instructions[id];
    const auto operands = f_.operands_of(made);
    for (size_t i = 0; i < operands.size(); ++i) {
      const bool chosen = made.op == Opcode::select && i > 0;
      add_use(operands[i], by, !chosen ? Side::neither : i == 1 ? Side::then : Side::other);
    }
    for (size_t side = 0; side < made.blocks.size(); ++side)
      if (made.blocks[side] != none)
        add_uses_inside(made.blocks[side], by,
                        made.op == Opcode::loop ? Side::neither : side == 0 ? Side::then : Side::other);
  }

  void add_uses_inside(BlockId block, uint32_t by, Side side) {
    for (const InstructionId id : f_.blocks[block].instructions) {
      const Instruction& made = f_.instructions[id];
      for (const ValueId operand : f_.operands_of(made)) add_use(operand, by, side);
      for (const BlockId inner : made.blocks)
        if (inner != none) add_uses_inside(inner, by, side);
    }
    for (const ValueId yield : f_.blocks[block].yields) add_use(yield, by, side);
  }

  /// The select or branch at this place, with the selects before it that can be chosen at the same time.
  Choice choice_of(BlockId block, uint32_t last) {
    Choice choice;
    const Instruction made = at(block, last);
    choice.condition = f_.operands_of(made)[0];
    choice.members.push_back(last);
    if (made.op == Opcode::select) {
      std::vector<bool> needed(last + 1, false);
      mark_needed(last, needed);
      for (uint32_t place = last; place-- > 0 && work_ <= max_work;) {
        const Instruction& other = at(block, place);
        if (other.op != Opcode::select || f_.operands_of(other)[0] != choice.condition || needed[place] ||
            uses_[place].empty())
          continue;
        choice.members.push_back(place);
        mark_needed(place, needed);
      }
    }
    find_sides(block, choice);
    return choice;
  }

  /// Marks what an instruction needs, directly or not.
  void mark_needed(uint32_t of, std::vector<bool>& needed) {
    work_ += of;
    // What needs a marked instruction comes behind it.
    std::vector<bool> own(of + 1, false);
    own[of] = true;
    for (uint32_t place = of; place-- > 0;) {
      own[place] = std::ranges::any_of(uses_[place], [&](const Use& use) { return use.by <= of && own[use.by]; });
      if (own[place]) needed[place] = true;
    }
  }

  void find_sides(BlockId block, Choice& choice) {
    work_ += uses_.size();
    const uint32_t last = choice.members.front();
    const auto size = static_cast<uint32_t>(uses_.size());
    choice.sides.assign(size + 1, Side::neither);
    std::vector<bool> is_member(size + 1, false);
    for (const uint32_t member : choice.members) is_member[member] = true;
    for (uint32_t place = size; place-- > 0;) {
      Side all = Side::dead;
      for (const Use& use : uses_[place]) {
        const Side side = is_member[use.by] ? use.side : choice.sides[use.by];
        if (side == Side::dead || all == side) continue;
        all = all == Side::dead ? side : Side::neither;
        if (all == Side::neither) break;
      }
      // What stands behind the last one cannot be needed by it.
      if (is_member[place] || (place > last && all != Side::dead)) all = Side::neither;
      choice.sides[place] = all;
      if (all == Side::then || all == Side::other) {
        const Instruction& made = at(block, place);
        const bool is_free = made.op == Opcode::constant || made.op == Opcode::extract;
        if (!is_free)
          choice.operations[all == Side::then ? 0 : 1] +=
              expanded_operations(f_, made, of_functions_, operations_of_division);
      }
    }
  }

  std::vector<InstructionId> taken(BlockId block, const Choice& choice, Side side) const {
    std::vector<InstructionId> list;
    for (uint32_t place = 0; place < uses_.size(); ++place)
      if (choice.sides[place] == side) list.push_back(f_.blocks[block].instructions[place]);
    return list;
  }

  void move_into_branch(BlockId block, const Choice& choice) {
    const Instruction branch = at(block, choice.members.front());
    for (const auto& [side, inner] : {std::pair(Side::then, branch.blocks[0]), std::pair(Side::other, branch.blocks[1])}) {
      const std::vector<InstructionId> list = taken(block, choice, side);
      auto& instructions = f_.blocks[inner].instructions;
      instructions.insert(instructions.begin(), list.begin(), list.end());
    }
    f_.blocks[block].instructions = taken(block, choice, Side::neither);
  }

  void make_branch(BlockId block, const Choice& choice) {
    const std::vector<InstructionId> list = f_.blocks[block].instructions;
    Instruction branch;
    branch.op = Opcode::branch;
    branch.first_operand = static_cast<uint32_t>(f_.operands.size());
    branch.operand_count = 1;
    f_.operands.push_back(choice.condition);
    branch.first_result = static_cast<ValueId>(f_.values.size());
    branch.result_count = static_cast<uint32_t>(choice.members.size());
    branch.origin = f_.instructions[list[choice.members.front()]].origin;
    std::vector<ValueId> replaced(f_.values.size());
    std::iota(replaced.begin(), replaced.end(), 0);
    for (size_t side = 0; side < 2; ++side) {
      branch.blocks[side] = static_cast<BlockId>(f_.blocks.size());
      Block& inner = f_.blocks.emplace_back();
      inner.instructions = taken(block, choice, side == 0 ? Side::then : Side::other);
      for (auto member = choice.members.rbegin(); member != choice.members.rend(); ++member)
        inner.yields.push_back(f_.operands_of(f_.instructions[list[*member]])[side + 1]);
    }
    for (auto member = choice.members.rbegin(); member != choice.members.rend(); ++member) {
      const ValueId old = f_.instructions[list[*member]].first_result;
      replaced[old] = static_cast<ValueId>(f_.values.size());
      f_.values.push_back(f_.values[old]);
    }
    replace_uses(replaced);
    const auto id = static_cast<InstructionId>(f_.instructions.size());
    f_.instructions.push_back(branch);
    tried_.push_back(true);
    f_.blocks[block].instructions = around(choice, list, id);
    ++made_;
  }

  void replace_uses(const std::vector<ValueId>& replaced) {
    const auto replace = [&](ValueId& value) {
      if (value < replaced.size()) value = replaced[value];
    };
    std::ranges::for_each(f_.operands, replace);
    for (Block& block : f_.blocks) std::ranges::for_each(block.yields, replace);
  }

  /// The block: what does not need the choice, the branch, and what does.
  std::vector<InstructionId> around(const Choice& choice, const std::vector<InstructionId>& list,
                                    InstructionId branch) const {
    std::vector<bool> follows(list.size() + 1, false);
    for (const uint32_t member : choice.members) follows[member] = true;
    std::vector<InstructionId> before, after;
    for (uint32_t place = 0; place < list.size(); ++place) {
      if (follows[place])
        for (const Use& use : uses_[place]) follows[use.by] = true;
      if (choice.sides[place] != Side::neither || std::ranges::find(choice.members, place) != choice.members.end())
        continue;
      (follows[place] ? after : before).push_back(list[place]);
    }
    before.push_back(branch);
    before.insert(before.end(), after.begin(), after.end());
    return before;
  }

  Function& f_;
  const std::vector<uint64_t>& of_functions_;
  const SinkLimits limits_;
  std::vector<bool> uniform_;           ///< by value that the function had before
  std::vector<uint32_t> place_of_;      ///< by value: the place in the block of what makes it
  std::vector<std::vector<Use>> uses_;  ///< by place
  std::vector<bool> tried_;             ///< by instruction: a select that is not worth a branch
  uint64_t work_ = 0;
  size_t made_ = 0;
};

}  // namespace

size_t sink(Module& module, const SinkLimits& limits) {
  std::vector<uint32_t> all(module.functions.size());
  std::iota(all.begin(), all.end(), 0);
  std::vector<uint64_t> of_functions(module.functions.size());
  const auto order = callees_first(module, all);
  size_t made = 0;
  for (const uint32_t f : *order) {
    Function& function = module.functions[f];
    if (function.is_declaration()) continue;
    for (const InstructionId id : function.blocks[0].instructions) {
      const Instruction& instruction = function.instructions[id];
      if (instruction.op != Opcode::constant && instruction.op != Opcode::extract)
        of_functions[f] += expanded_operations(function, instruction, of_functions, operations_of_division);
    }
    if (function.library.empty()) made += Sinker(function, of_functions, limits).run();
  }
  return made;
}

}  // namespace isoshade::passes
