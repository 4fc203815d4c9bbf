// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/passes.h"

#include <bit>
#include <functional>
#include <string_view>
#include <utility>

namespace isoshade::passes {

namespace {

using namespace ir;

// Where a value is defined.
struct ValuePosition {
  BlockId block = none;
  InstructionId instruction = none;  ///< whose result it is, or whose block's parameter; none: the function's
  uint32_t position = 0;             ///< among the results or parameters
  bool is_parameter = false;
};

void find_places(const Function& f, std::vector<ValuePosition>& places) {
  places.assign(f.values.size(), {});
  const auto enter = [&](const auto& self, BlockId block, InstructionId owner) -> void {
    const std::vector<ValueId>& parameters = f.blocks[block].parameters;
    for (uint32_t k = 0; k < parameters.size(); ++k) places[parameters[k]] = {block, owner, k, true};
    for (InstructionId id : f.blocks[block].instructions) {
      const Instruction& made = f.instructions[id];
      for (uint32_t k = 0; k < made.result_count; ++k) places[made.first_result + k] = {block, id, k, false};
      for (BlockId inner : made.blocks)
        if (inner != none) self(self, inner, id);
    }
  };
  enter(enter, 0, none);
}

// Which values are needed, each by itself: an unused result of a branch or loop does not keep its yields
// alive.
class Liveness {
 public:
  void find(const Function& f, const std::vector<ValuePosition>& places) {
    f_ = &f;
    live_.assign(f.values.size(), false);
    for (ValueId value : f.blocks[0].yields) mark(value);
    while (!work_.empty()) {
      const ValuePosition& place = places[work_.back()];
      work_.pop_back();
      if (place.instruction != none) follow(place);
    }
  }

  /// Whether a branch or loop keeps its k-th result.
  bool keeps(const Instruction& made, uint32_t k) const {
    return live_[made.first_result + k] ||
           (made.op == Opcode::loop && live_[f_->blocks[made.blocks[0]].parameters[k + 1]]);
  }

 private:
  void mark(ValueId value) {
    if (live_[value]) return;
    live_[value] = true;
    work_.push_back(value);
  }

  void follow(const ValuePosition& place) {
    const Instruction& made = f_->instructions[place.instruction];
    const auto operands = f_->operands_of(made);
    if (made.op == Opcode::branch) {
      mark(operands[0]);
      for (BlockId side : made.blocks) mark(f_->blocks[side].yields[place.position]);
    } else if (made.op == Opcode::loop) {
      const Block& body = f_->blocks[made.blocks[0]];
      mark(operands[0]);
      if (place.is_parameter && place.position == 0) return;
      const uint32_t k = place.is_parameter ? place.position - 1 : place.position;
      mark(operands[k + 1]);
      mark(body.yields[k]);
      mark(body.parameters[k + 1]);
    } else {
      for (ValueId operand : operands) mark(operand);
    }
  }

  const Function* f_ = nullptr;
  std::vector<char> live_;  ///< by value
  std::vector<ValueId> work_;
};

// Its buffers are reused for the next function: most functions are small.
class Renumberer {
 public:
  void run(Function& f) {
    f_ = &f;
    find_places(f, places_);
    if (f.blocks.size() > 1) live_.find(f, places_);  // only branches and loops ask
    reached_.assign(f.instructions.size(), false);
    new_origins_.assign(f.origins.size(), none);
    origin_heads_.assign(std::bit_ceil(f.origins.size()), none);
    chain_.assign(1, {});
    if (order_.size() < f.blocks.size()) order_.resize(f.blocks.size());
    for (std::vector<InstructionId>& block : order_) block.clear();
    seen_in_.assign(f.values.size(), none);
    values_.assign(f.values.size(), none);
    arrange(0, none);
    out_.values.clear();
    out_.instructions.clear();
    out_.operands.clear();
    out_.origins.resize(1);
    out_.blocks.clear();
    out_.values.reserve(f.values.size());
    out_.instructions.reserve(f.instructions.size());
    out_.operands.reserve(f.operands.size());
    out_.origins.reserve(f.origins.size());
    out_.blocks.reserve(f.blocks.size());
    out_.blocks.emplace_back();
    for (ValueId parameter : f.blocks[0].parameters)
      out_.blocks[0].parameters.push_back(add_value(parameter));
    emit(0, 0, none);
    f.values.swap(out_.values);
    f.instructions.swap(out_.instructions);
    f.operands.swap(out_.operands);
    f.origins.swap(out_.origins);
    f.blocks.swap(out_.blocks);
  }

 private:
  struct Visit {
    InstructionId instruction;
    uint32_t next, end;  ///< what it uses, in Function::operands
  };

  // What of a branch's or loop's yields remains; every other list remains whole.
  template <class Use>
  void for_live(InstructionId owner, std::span<const ValueId> list, uint32_t skip, Use use) const {
    if (owner == none) {
      for (ValueId value : list) use(value);
      return;
    }
    for (uint32_t i = 0; i < list.size(); ++i)
      if (i < skip || live_.keeps(f_->instructions[owner], i - skip)) use(list[i]);
  }

  // Puts the needed instructions of a block in order; returns what it uses from outside, in order of first
  // use.
  std::vector<ValueId> arrange(BlockId block, InstructionId owner) {
    std::vector<ValueId> outer;
    const size_t bottom = path_.size();
    for_live(owner, f_->blocks[block].yields, 0, [&](ValueId yield) {
      reach(yield, block, outer);
      while (path_.size() > bottom) {
        Visit& visit = path_.back();
        if (visit.next != visit.end) {
          reach(f_->operands[visit.next++], block, outer);
        } else {
          order_[block].push_back(visit.instruction);
          path_.pop_back();
        }
      }
    });
    return outer.empty() ? outer : unique(outer, block);
  }

  void reach(ValueId value, BlockId block, std::vector<ValueId>& outer) {
    const ValuePosition& place = places_[value];
    if (place.block != block) return outer.push_back(value);
    if (place.is_parameter || reached_[place.instruction]) return;
    reached_[place.instruction] = true;
    const Instruction& made = f_->instructions[place.instruction];
    path_.push_back(made.blocks[0] == none ? Visit{place.instruction, made.first_operand,
                                                   made.first_operand + made.operand_count}
                                           : visit_blocks(place.instruction));
  }

  // Lists what a branch or loop uses: its operands, then what its blocks use from outside.
  Visit visit_blocks(InstructionId id) {
    const Instruction& made = f_->instructions[id];
    std::vector<ValueId> uses;
    for_live(made.op == Opcode::loop ? id : none, f_->operands_of(made), 1,
             [&](ValueId value) { uses.push_back(value); });
    for (BlockId inner : made.blocks) {
      if (inner == none) continue;
      const std::vector<ValueId> outer = arrange(inner, id);
      uses.insert(uses.end(), outer.begin(), outer.end());
    }
    // Behind the operands, which are made anew anyway.
    const auto first = static_cast<uint32_t>(f_->operands.size());
    f_->operands.insert(f_->operands.end(), uses.begin(), uses.end());
    return {id, first, static_cast<uint32_t>(f_->operands.size())};
  }

  std::vector<ValueId> unique(const std::vector<ValueId>& list, BlockId block) {
    std::vector<ValueId> once;
    for (ValueId value : list)
      if (std::exchange(seen_in_[value], block) != block) once.push_back(value);
    return once;
  }

  ValueId add_value(ValueId old) {
    out_.values.push_back(f_->values[old]);
    return values_[old] = static_cast<ValueId>(out_.values.size() - 1);
  }

  uint32_t origin(uint32_t old) {
    if (old == 0) return 0;
    if (new_origins_[old] != none) return new_origins_[old];
    Origin& from = f_->origins[old];
    const auto hash = static_cast<uint32_t>(std::hash<std::string_view>{}(from.node) + from.line);
    uint32_t& head = origin_heads_[hash & (origin_heads_.size() - 1)];
    for (uint32_t known = head; known != none; known = chain_[known].next)
      if (chain_[known].hash == hash && out_.origins[known] == from) return new_origins_[old] = known;
    new_origins_[old] = static_cast<uint32_t>(out_.origins.size());
    chain_.push_back({std::exchange(head, new_origins_[old]), hash});
    out_.origins.push_back(std::move(from));
    return new_origins_[old];
  }
  void rename(ValueId value) { out_.values[value].names = origin(out_.values[value].names); }

  void emit(BlockId from, BlockId to, InstructionId owner) {
    out_.blocks[to].instructions.reserve(order_[from].size());
    for (InstructionId id : order_[from]) {
      const Instruction& made = f_->instructions[id];
      const auto copied = static_cast<InstructionId>(out_.instructions.size());
      out_.blocks[to].instructions.push_back(copied);
      Instruction& copy = out_.instructions.emplace_back(made);
      copy.origin = origin(made.origin);
      copy.first_operand = static_cast<uint32_t>(out_.operands.size());
      copy.first_result = static_cast<ValueId>(out_.values.size());
      if (made.blocks[0] == none) {
        for (const ValueId operand : f_->operands_of(made)) out_.operands.push_back(values_[operand]);
        for (uint32_t k = 0; k < made.result_count; ++k) rename(add_value(made.first_result + k));
      } else {
        emit_parts(copy, made, id, copied);
      }
    }
    for_live(owner, f_->blocks[from].yields, 0,
             [&](ValueId v) { out_.blocks[to].yields.push_back(values_[v]); });
  }

  /// What remains of a branch or loop.
  void emit_parts(Instruction& copy, const Instruction& made, InstructionId id, InstructionId copied) {
    for_live(made.op == Opcode::loop ? id : none, f_->operands_of(made), 1,
             [&](ValueId v) { out_.operands.push_back(values_[v]); });
    copy.operand_count = static_cast<uint32_t>(out_.operands.size()) - copy.first_operand;
    for (uint32_t k = 0; k < made.result_count; ++k)
      if (live_.keeps(made, k)) rename(add_value(made.first_result + k));
    copy.result_count = static_cast<uint32_t>(out_.values.size()) - copy.first_result;
    emit_blocks(id, copied);
  }

  void emit_blocks(InstructionId id, InstructionId copied) {
    const Instruction& made = f_->instructions[id];
    for (size_t side = 0; side < made.blocks.size() && made.blocks[side] != none; ++side) {
      const auto inner = static_cast<BlockId>(out_.blocks.size());
      out_.blocks.emplace_back();
      out_.instructions[copied].blocks[side] = inner;
      for_live(id, f_->blocks[made.blocks[side]].parameters, 1, [&](ValueId parameter) {
        out_.blocks[inner].parameters.push_back(add_value(parameter));
        rename(values_[parameter]);
      });
      emit(made.blocks[side], inner, id);
    }
  }

  Function* f_ = nullptr;
  std::vector<ValuePosition> places_;  ///< by value
  Liveness live_;
  std::vector<Visit> path_;
  std::vector<char> reached_;                      ///< by instruction
  std::vector<uint32_t> new_origins_;              ///< by old origin
  std::vector<std::vector<InstructionId>> order_;  ///< by block
  std::vector<BlockId> seen_in_;                   ///< by value: the last block found to use it from outside
  std::vector<ValueId> values_;                    ///< by old value: the new one
  /// The new origin before this one that has the same place in origin_heads_.
  struct Link {
    uint32_t next = none, hash = 0;
  };
  std::vector<uint32_t> origin_heads_;  ///< by hash: the newest new origin, then along chain_
  std::vector<Link> chain_;             ///< by new origin
  Function out_;
};

}  // namespace

void renumber(ir::Module& module) {
  Renumberer renumberer;
  for (Function& function : module.functions)
    if (!function.is_declaration()) renumberer.run(function);
}

}  // namespace isoshade::passes
