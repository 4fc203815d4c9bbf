// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/hoist.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "compiler/passes/draw_rate.h"
#include "compiler/passes/hoist_slice.h"
#include "compiler/passes/passes.h"
#include "compiler/support/name_table.h"

namespace isoshade::passes {

namespace {

using namespace ir;

/// A function is split once for each set of parameters that are the same: n nested functions could make 2^n.
constexpr size_t max_cloned_instructions = 50'000;
/// That a function gets as parameters: those of its callees are its own. What has more stays as it is.
constexpr size_t max_items = 500;
/// Of a record; there may be a million records. Shipped effects have at most a third of it.
constexpr uint32_t max_words = 256;

class Hoister {
 public:
  Hoister(Module& module, uint32_t kernel, const DrawRate& rate)
      : module_(module), kernel_(kernel), rate_(rate), original_(module), rates_(original_, rate) {
    for (const Function& function : module.functions) names_.add(function.name);
  }

  std::optional<DrawValues> run() {
    Function pixels = original_.functions[kernel_], draw;
    const std::vector<Item> items = split(kernel_, same_of_kernel(), pixels, draw);
    if (items.empty()) return std::nullopt;
    draw.name = free_name(names_, "draw");
    DrawValues made{original_, 0, rate_.first};
    made.module.functions = module_.functions;
    made.entry = static_cast<uint32_t>(made.module.functions.size());
    made.module.functions.push_back(std::move(draw));
    const std::vector<size_t> place = shorten(made);
    uint32_t words = 0;
    for (const Result& result : made.module.functions[made.entry].results) words += result.type.width;
    if (words > max_words) return std::nullopt;
    read_values(pixels, made.module.functions[made.entry].results, items, place, made);
    module_.functions[kernel_] = std::move(pixels);
    return made;
  }

  /// Drops what is no longer used, and gives functions the names of those that they replaced.
  uint32_t tidy() {
    std::vector<uint32_t> entries{kernel_};
    renumber(module_);
    drop_unread(module_, entries);
    for (const auto& [name, wanted] : wanted_names_) {
      const uint32_t function = module_.find(name);
      if (function != none && module_.find(wanted) == none) module_.functions[function].name = wanted;
    }
    return entries[0];
  }

  /// The operations that pixels compute and that are the same.
  size_t count() {
    Function pixels = original_.functions[kernel_], draw;
    split(kernel_, same_of_kernel(), pixels, draw);
    return items_;
  }

 private:
  std::vector<bool> same_of_kernel() const {
    std::vector<bool> same(original_.functions[kernel_].parameters.size());
    if (rate_.parameter) same[*rate_.parameter] = true;
    return same;
  }

  static std::string free_name(support::NameTable& names, const std::string& wanted) {
    const support::NameTable::Added first = names.add(wanted);
    std::string name = wanted;
    for (bool is_new = first.is_new; !is_new; is_new = names.add(name).is_new)
      name = wanted + "_" + std::to_string(++names.number(first.index));
    return name;
  }

  /// "sum" of "sum_2": a name that was given a number gets another one elsewhere.
  static std::string without_number(const std::string& name) {
    const size_t end = name.find_last_not_of("0123456789");
    const bool has_number = end != std::string::npos && end != 0 && end + 1 < name.size() && name[end] == '_';
    return has_number ? name.substr(0, end) : name;
  }

  /// Makes the two parts of a function; `pixels` is a copy of it, and has no parameters for the items yet.
  std::vector<Item> split(uint32_t function, const std::vector<bool>& parameters, Function& pixels, Function& draw) {
    const Function& f = original_.functions[function];
    const RatesOfFunction& rates = rates_.of(function, parameters);
    std::map<InstructionId, const Split*> splits;
    const std::vector<Item> items = find_items(f, rates, function == kernel_, splits);
    items_ += items.size();
    if (items.empty() || items.size() > max_items) return {};
    Slice slice(f, rates, splits, module_, draw);
    support::NameTable taken;
    for (const Parameter& parameter : f.parameters) taken.add(parameter.name);
    for (const Item& item : items) {
      const std::string name = free_name(taken, without_number(name_of(f, item, splits)));
      slice.yield(slice.copy(item), name);
    }
    needs_ = std::move(slice.needs);
    for (const auto& [call, of_callee] : splits) pixels.instructions[call].imm = of_callee->pixels;
    return items;
  }

  /// The function that is called with these arguments, split. Nothing is the same where there are no items.
  const Split& split_of(uint32_t function, const std::vector<bool>& parameters) {
    const auto key = std::pair(function, parameters);
    if (const auto found = splits_.find(key); found != splits_.end()) return found->second;
    Split made;
    cloned_instructions_ += original_.functions[function].instructions.size();
    if (cloned_instructions_ > max_cloned_instructions) return splits_.emplace(key, std::move(made)).first->second;
    Function pixels = original_.functions[function], draw;
    const std::vector<Item> items = split(function, parameters, pixels, draw);
    if (!items.empty()) {
      made.needs = needs_;
      std::vector<ValueId> values;
      for (const Result& result : draw.results) {
        made.items.push_back({result.name, result.type, pixels.document.empty() ? "" : "draw", true});
        pixels.parameters.push_back(made.items.back());
        pixels.values.push_back({result.type, 0});
        values.push_back(static_cast<ValueId>(pixels.values.size() - 1));
        pixels.blocks[0].parameters.push_back(values.back());
      }
      use(pixels, rates_.of(function, parameters), items, values);
      made.reads = parameters_needed(pixels);
      const std::string name = pixels.name;
      pixels.name = free_name(names_, name + "_in_draw");
      wanted_names_.emplace_back(pixels.name, name);
      pixels.library.clear();
      draw.name = free_name(names_, name + "_of_draw");
      made.pixels = static_cast<uint32_t>(module_.functions.size());
      made.draw = made.pixels + 1;
      module_.functions.push_back(std::move(pixels));
      module_.functions.push_back(std::move(draw));
    }
    return splits_.emplace(key, std::move(made)).first->second;
  }

  /// Lets pixels read the items from these values: nothing but the draw reads the operations that made them.
  static void use(Function& pixels, const RatesOfFunction& rates, const std::vector<Item>& items,
                  const std::vector<ValueId>& values) {
    std::map<ValueId, ValueId> with;
    std::map<InstructionId, std::vector<ValueId>> further;  // operands of calls
    for (size_t i = 0; i < items.size(); ++i)
      if (items[i].value != none)
        with[items[i].value] = values[i];
      else
        further[items[i].call].push_back(values[i]);
    const auto replace = [&](std::span<ValueId> list) {
      for (ValueId& value : list)
        if (const auto found = with.find(value); found != with.end()) value = found->second;
    };
    const auto visit = [&](const auto& self, BlockId block) -> void {
      for (const InstructionId id : pixels.blocks[block].instructions) {
        Instruction& made = pixels.instructions[id];
        if (made.result_count != 0 && rates.same[made.first_result]) continue;
        replace(pixels.operands_of(made));
        if (const auto found = further.find(id); found != further.end()) {
          const auto first = static_cast<uint32_t>(pixels.operands.size());
          for (uint32_t i = 0; i < made.operand_count; ++i)
            pixels.operands.push_back(pixels.operands[made.first_operand + i]);
          pixels.operands.insert(pixels.operands.end(), found->second.begin(), found->second.end());
          made.first_operand = first;
          made.operand_count += static_cast<uint32_t>(found->second.size());
        }
        for (const BlockId inner : made.blocks)
          if (inner != none) self(self, inner);
      }
      replace(pixels.blocks[block].yields);
    };
    visit(visit, 0);
  }

  std::vector<Item> find_items(const Function& f, const RatesOfFunction& rates, bool is_kernel,
                               std::map<InstructionId, const Split*>& splits) {
    const std::vector<bool> is_free = free_values(f, rates, is_kernel);
    std::vector<Item> items;
    std::map<Item, bool> known;
    const auto add = [&](const Item& item) {
      if (known.emplace(item, true).second) items.push_back(item);
    };
    const auto read = [&](ValueId value) {
      if (rates.same[value] && !is_free[value]) add({value});
    };
    const auto visit = [&](const auto& self, BlockId block) -> void {
      for (const InstructionId id : f.blocks[block].instructions) {
        const Instruction& made = f.instructions[id];
        if (made.result_count != 0 && rates.same[made.first_result]) continue;
        const auto operands = f.operands_of(made);
        const Split* const split = made.op == Opcode::call ? split_of_call(made, operands, rates) : nullptr;
        for (size_t i = 0; i < operands.size(); ++i)
          if (split == nullptr || split->reads[i]) read(operands[i]);
        if (split != nullptr) {
          splits[id] = split;
          for (size_t i = 0; i < split->items.size(); ++i) add({none, id, i});
        }
        for (const BlockId inner : made.blocks)
          if (inner != none) self(self, inner);
      }
      for (const ValueId value : f.blocks[block].yields) read(value);
    };
    visit(visit, 0);
    return items;
  }

  /// Null where there is nothing to split.
  const Split* split_of_call(const Instruction& call, std::span<const ValueId> arguments, const RatesOfFunction& rates) {
    if (original_.functions[call.imm].is_declaration()) return nullptr;
    std::vector<bool> same;
    for (const ValueId value : arguments) same.push_back(rates.same[value]);
    const Split& split = split_of(call.imm, same);
    return split.items.empty() ? nullptr : &split;
  }

  static std::string name_of(const Function& f, const Item& item, const std::map<InstructionId, const Split*>& splits) {
    if (item.value == none) return splits.at(item.call)->items[item.of_call].name;
    const uint32_t origin = f.values[item.value].names;
    return origin != 0 ? f.origins[origin].node : "value";
  }

  /// Drops what is computed twice; returns which of the results each item is.
  static std::vector<size_t> shorten(DrawValues& made) {
    std::vector<uint32_t> entries{made.entry};
    renumber(made.module);
    cse(made.module);
    renumber(made.module);
    dce(made.module, entries);
    made.entry = entries[0];
    Function& draw = made.module.functions[made.entry];
    std::vector<size_t> place;
    std::vector<ValueId> yields;
    std::vector<Result> results;
    for (size_t i = 0; i < draw.results.size(); ++i) {
      const ValueId value = draw.blocks[0].yields[i];
      const auto found = std::ranges::find(yields, value);
      place.push_back(static_cast<size_t>(found - yields.begin()));
      if (found != yields.end()) continue;
      yields.push_back(value);
      results.push_back(draw.results[i]);
    }
    draw.blocks[0].yields = std::move(yields);
    draw.results = std::move(results);
    return place;
  }

  /// Loads the results at the head of the kernel.
  void read_values(Function& pixels, const std::vector<Result>& results, const std::vector<Item>& items,
                   const std::vector<size_t>& place, DrawValues& made) {
    std::vector<InstructionId> head;
    const auto append = [&](Opcode op, uint32_t imm, std::initializer_list<ValueId> operands, Type type,
                            uint32_t origin = 0) {
      Instruction instruction;
      instruction.op = op;
      instruction.imm = imm;
      instruction.first_operand = static_cast<uint32_t>(pixels.operands.size());
      instruction.operand_count = static_cast<uint32_t>(operands.size());
      pixels.operands.insert(pixels.operands.end(), operands.begin(), operands.end());
      instruction.first_result = static_cast<ValueId>(pixels.values.size());
      instruction.origin = origin;
      pixels.values.push_back({type, origin});
      head.push_back(static_cast<InstructionId>(pixels.instructions.size()));
      pixels.instructions.push_back(instruction);
      return instruction.first_result;
    };
    const auto load = [&](uint32_t buffer, uint32_t word, Type type, uint32_t origin) {
      ValueId place_of_word = append(Opcode::constant, word, {}, int_type);
      if (rate_.parameter)
        place_of_word = append(Opcode::iadd, 0, {pixels.blocks[0].parameters[*rate_.parameter], place_of_word}, int_type);
      return append(Opcode::load, buffer, {place_of_word}, type, origin);
    };
    std::vector<ValueId> values;
    for (const Result& result : results) {
      const uint32_t word = made.first + made.words;
      const auto width = static_cast<uint32_t>(result.type.width);
      const uint32_t buffer = result.type.is_float() ? rate_.floats : rate_.integers;
      module_.buffers[buffer].fields.push_back({field_name(buffer, result.name), word, width});
      pixels.origins.push_back({result.name});
      const auto origin = static_cast<uint32_t>(pixels.origins.size() - 1);
      made.words += width;
      if (result.type == bool_type) {
        const ValueId bits = load(buffer, word, int_type, 0);
        values.push_back(append(Opcode::ine, 0, {bits, append(Opcode::constant, 0, {}, int_type)}, bool_type, origin));
      } else if (width == 1) {
        values.push_back(load(buffer, word, result.type, origin));
      } else {
        std::array<ValueId, 4> parts{};
        for (uint32_t c = 0; c < width; ++c) parts[c] = load(buffer, word + c, float_type, 0);
        const ValueId vector = append(Opcode::construct, 0, {}, result.type, origin);
        Instruction& construct = pixels.instructions.back();
        construct.first_operand = static_cast<uint32_t>(pixels.operands.size());
        construct.operand_count = width;
        pixels.operands.insert(pixels.operands.end(), parts.begin(), parts.begin() + width);
        values.push_back(vector);
      }
    }
    std::vector<ValueId> of_items;
    for (const size_t i : place) of_items.push_back(values[i]);
    use(pixels, rates_.of(kernel_, same_of_kernel()), items, of_items);
    auto& instructions = pixels.blocks[0].instructions;
    instructions.insert(instructions.begin(), head.begin(), head.end());
  }

  std::string field_name(uint32_t buffer, const std::string& name) {
    const auto [found, is_new] = field_names_.try_emplace(buffer);
    if (is_new)
      for (const RecordField& field : module_.buffers[buffer].fields) found->second.add(field.name);
    return free_name(found->second, "draw_" + without_number(name));
  }

  Module& module_;
  uint32_t kernel_;
  const DrawRate& rate_;
  const Module original_;  ///< functions are added to the module
  Rates rates_;
  std::map<std::pair<uint32_t, std::vector<bool>>, Split> splits_;
  std::vector<std::pair<std::string, std::string>> wanted_names_;  ///< of functions that replace others, and of these
  std::vector<size_t> needs_;  ///< of the draw function that was made last
  support::NameTable names_;
  std::map<uint32_t, support::NameTable> field_names_;  ///< by buffer
  size_t items_ = 0, cloned_instructions_ = 0;
};

}  // namespace

std::optional<DrawValues> hoist(Module& module, uint32_t& kernel, const DrawRate& rate) {
  std::vector<uint32_t> entries{kernel};
  drop_unread(module, entries);  // a result may not depend on all arguments
  Hoister hoister(module, entries[0], rate);
  std::optional<DrawValues> values = hoister.run();
  kernel = values ? hoister.tidy() : entries[0];
  return values;
}

size_t operations_at_draw_rate(const Module& module, uint32_t kernel, const DrawRate& rate) {
  Module copy = module;
  return Hoister(copy, kernel, rate).count();
}

}  // namespace isoshade::passes
