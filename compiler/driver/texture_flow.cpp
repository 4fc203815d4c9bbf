// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/texture_flow.h"

#include <algorithm>
#include <iterator>
#include <optional>

#include "compiler/ir/record_words.h"
#include "compiler/lower/frame_layout.h"

namespace isoshade::driver {

using namespace ir;

namespace {

namespace word = lower::texture_word;

/// Graphs of a stranger may call functions for more choices of results than are worth telling apart.
constexpr size_t most_kept = 4096;
/// A value that may be more numbers than these is not followed; all of them count as read.
constexpr size_t most_numbers = 64;

/// Whether that changes `to`.
bool merge(std::vector<uint32_t>& to, const std::vector<uint32_t>& more) {
  std::vector<uint32_t> all;
  std::ranges::set_union(to, more, std::back_inserter(all));
  const bool changed = all.size() != to.size();
  to = std::move(all);
  return changed;
}

/// The values that the results of a function depend on, which are asked for one by one: texture_size returns the number of
/// levels to those, too, who ask for the width alone.
class Needed {
 public:
  Needed(const Function& f, const std::vector<bool>& results) : f_(f), needed_(f.values.size()) {
    for (size_t k = 0; k < results.size(); ++k)
      if (results[k]) need(f.blocks[0].yields[k]);
    // Once more for what loops carry to their beginning.
    do {
      changed_ = false;
      visit(0);
    } while (changed_);
  }
  std::vector<bool> take() { return std::move(needed_); }

 private:
  void need(ValueId value) {
    changed_ |= !needed_[value];
    needed_[value] = true;
  }

  void visit(BlockId block) {
    const std::vector<InstructionId>& instructions = f_.blocks[block].instructions;
    for (auto id = instructions.rbegin(); id != instructions.rend(); ++id) visit(f_.instructions[*id]);
  }

  void visit(const Instruction& made) {
    const auto operands = f_.operands_of(made);
    const auto is_needed = [&](uint32_t k) -> bool { return needed_[made.first_result + k]; };
    bool any = false;
    for (uint32_t k = 0; k < made.result_count; ++k) any |= is_needed(k);
    if (!any) return;
    if (made.op == Opcode::branch) {
      need(operands[0]);
      for (const BlockId side : made.blocks) {
        for (uint32_t k = 0; k < made.result_count; ++k)
          if (is_needed(k)) need(f_.blocks[side].yields[k]);
        visit(side);
      }
    } else if (made.op == Opcode::loop) {
      const Block& body = f_.blocks[made.blocks[0]];
      need(operands[0]);
      for (uint32_t k = 0; k < made.result_count; ++k) {
        if (!is_needed(k) && !needed_[body.parameters[k + 1]]) continue;
        need(body.yields[k]);
        need(operands[k + 1]);
      }
      visit(made.blocks[0]);
    } else {
      for (const ValueId operand : operands) need(operand);
    }
  }

  const Function& f_;
  std::vector<bool> needed_;
  bool changed_ = false;
};

}  // namespace

/// Walks a function in its order until nothing new is found: loops carry numbers to their beginning.
class TextureFlow::Walk {
 public:
  Walk(TextureFlow& flow, const Function& f, const std::vector<bool>& results, size_t count,
       std::span<const Known> known)
      : flow_(flow),
        f_(f),
        needed_(Needed(f, results).take()),
        made_by_(made_by(f)),
        numbers_(f.values.size()),
        is_known_(f.values.size()),
        is_unknown_(f.values.size()) {
    reads_.own.resize(count);
    reads_.levels.resize(count);
    for (const auto& [value, numbers] : known) {
      numbers_[value] = numbers;
      is_known_[value] = true;
    }
    do {
      changed_ = false;
      visit(0);
    } while (changed_);
    for (const ValueId value : f.blocks[0].yields) reads_.results.push_back(numbers_[value]);
  }
  TextureReads take() { return std::move(reads_); }

 private:
  void read_own(const std::vector<uint32_t>& numbers) {
    for (const uint32_t number : numbers) reads_.own[number] = true;
  }
  void read_levels(const std::vector<uint32_t>& numbers) {
    read_own(numbers);
    for (const uint32_t number : numbers) reads_.levels[number] = true;
  }
  void read_all(const TextureNumbers& numbers) {
    read_levels(numbers.of);
    read_levels(numbers.from);
  }

  void add(ValueId value, const TextureNumbers& more) {
    if (is_known_[value] || f_.type(value) == bool_type) return;
    if (is_unknown_[value] || f_.type(value) != int_type) return read_all(more);
    TextureNumbers& numbers = numbers_[value];
    if (merge(numbers.of, more.of)) changed_ = true;
    if (merge(numbers.from, more.from)) changed_ = true;
    if (numbers.of.size() + numbers.from.size() <= most_numbers) return;
    read_all(numbers);
    numbers = {};
    is_unknown_[value] = true;
  }
  void add_computed(ValueId value, const TextureNumbers& from) {
    add(value, {{}, from.of});
    add(value, {{}, from.from});
  }

  void visit(BlockId block) {
    for (const InstructionId id : f_.blocks[block].instructions) {
      const Instruction& made = f_.instructions[id];
      for (uint32_t k = 0; k < made.result_count; ++k) {
        if (!needed_[made.first_result + k]) continue;
        visit(made);
        break;
      }
    }
  }

  void visit(const Instruction& made) {
    const auto operands = f_.operands_of(made);
    switch (made.op) {
      case Opcode::branch:
        for (const BlockId side : made.blocks) {
          visit(side);
          for (uint32_t k = 0; k < made.result_count; ++k)
            add(made.first_result + k, numbers_[f_.blocks[side].yields[k]]);
        }
        break;
      case Opcode::loop: visit_loop(made); break;
      case Opcode::call: visit_call(made); break;
      case Opcode::load:
        if (made.imm == static_cast<uint32_t>(lower::FrameBuffer::textures)) read_record(operands[0]);
        break;
      case Opcode::select:
        for (const ValueId choice : operands.subspan(1)) add(made.first_result, numbers_[choice]);
        break;
      default:
        for (const ValueId operand : operands) add_computed(made.first_result, numbers_[operand]);
    }
  }

  void visit_loop(const Instruction& made) {
    const auto operands = f_.operands_of(made);
    const Block& body = f_.blocks[made.blocks[0]];
    for (uint32_t k = 0; k < made.result_count; ++k) add(body.parameters[k + 1], numbers_[operands[k + 1]]);
    visit(made.blocks[0]);
    for (uint32_t k = 0; k < made.result_count; ++k) {
      add(body.parameters[k + 1], numbers_[body.yields[k]]);
      add(made.first_result + k, numbers_[body.parameters[k + 1]]);
    }
  }

  void visit_call(const Instruction& made) {
    const auto operands = f_.operands_of(made);
    if (flow_.module_.functions[made.imm].is_declaration()) {
      for (const ValueId operand : operands) read_all(numbers_[operand]);
      return;
    }
    std::vector<bool> results;
    for (uint32_t k = 0; k < made.result_count; ++k) results.push_back(needed_[made.first_result + k]);
    const TextureReads& reads = flow_.reads_of(made.imm, std::move(results));
    for (size_t i = 0; i < operands.size(); ++i) {
      const TextureNumbers& argument = numbers_[operands[i]];
      if (reads.own[i]) read_own(argument.of);
      if (reads.levels[i]) read_levels(argument.of);
      if (reads.own[i]) read_levels(argument.from);
    }
    for (uint32_t k = 0; k < made.result_count; ++k) {
      for (const uint32_t parameter : reads.results[k].of)
        add(made.first_result + k, numbers_[operands[parameter]]);
      for (const uint32_t parameter : reads.results[k].from)
        add_computed(made.first_result + k, numbers_[operands[parameter]]);
    }
  }

  std::optional<uint32_t> constant(ValueId value) const {
    const bool is_constant =
        made_by_[value] != none && f_.instructions[made_by_[value]].op == Opcode::constant;
    return is_constant ? std::optional(f_.instructions[made_by_[value]].imm) : std::nullopt;
  }
  /// The two operands, the second a constant.
  std::optional<std::pair<ValueId, uint32_t>> with_constant(ValueId value, Opcode op) const {
    if (made_by_[value] == none || f_.instructions[made_by_[value]].op != op) return std::nullopt;
    const auto operands = f_.operands_of(f_.instructions[made_by_[value]]);
    if (const auto second = constant(operands[1])) return std::pair(operands[0], *second);
    if (const auto first = constant(operands[0])) return std::pair(operands[1], *first);
    return std::nullopt;
  }

  /// A load of a word of a record, whose address is number * stride + word.
  void read_record(ValueId address) {
    const auto sum = with_constant(address, Opcode::iadd);
    const auto product = with_constant(sum ? sum->first : address, Opcode::imul);
    if (!product || product->second != word::stride) return read_all(numbers_[address]);
    const TextureNumbers& numbers = numbers_[product->first];
    if (sum && sum->second == word::smaller)
      read_levels(numbers.of);
    else
      read_own(numbers.of);
    read_levels(numbers.from);
  }

  TextureFlow& flow_;
  const Function& f_;
  std::vector<bool> needed_;
  std::vector<InstructionId> made_by_;
  std::vector<TextureNumbers> numbers_;
  std::vector<bool> is_known_;    ///< nothing is added
  std::vector<bool> is_unknown_;  ///< it may be so many numbers that each that is added counts as read
  TextureReads reads_;
  bool changed_ = false;
};

TextureReads TextureFlow::follow(uint32_t function, size_t count, std::span<const Known> known) {
  const Function& f = module_.functions[function];
  return Walk(*this, f, std::vector<bool>(f.results.size(), true), count, known).take();
}

const TextureReads& TextureFlow::reads_of(uint32_t function, std::vector<bool> results) {
  const Function& f = module_.functions[function];
  if (known_.size() >= most_kept) results.assign(results.size(), true);
  auto key = std::pair(function, std::move(results));
  if (const auto found = known_.find(key); found != known_.end()) return found->second;
  std::vector<Known> parameters;
  for (uint32_t i = 0; i < f.parameters.size(); ++i)
    if (f.parameters[i].type == int_type) parameters.push_back({f.blocks[0].parameters[i], {{i}, {}}});
  TextureReads reads = Walk(*this, f, key.second, f.parameters.size(), parameters).take();
  return known_.emplace(std::move(key), std::move(reads)).first->second;
}

}  // namespace isoshade::driver
