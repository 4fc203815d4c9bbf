// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/passes.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "compiler/functions/library.h"
#include "compiler/ir/call_graph.h"
#include "compiler/passes/tangents.h"
#include "compiler/support/assert.h"

namespace isoshade::passes {

using namespace ir;

namespace {

using Values = std::vector<ValueId>;

/// More derivatives than that, each taken of the other, are a mistake.
constexpr size_t most_rounds = 64;

bool any(const Marks& marks) { return std::ranges::find(marks, true) != marks.end(); }

class Differentiation {
 public:
  explicit Differentiation(Module& module) : module_(module) {}

  /// Callees first: the derivatives that a function needs are settled before its callers are rewritten.
  void run() {
    std::vector<uint32_t> all(module_.functions.size());
    std::iota(all.begin(), all.end(), 0);
    const auto order = callees_first(module_, all);
    support::assert_that(order.has_value(), "a function calls itself");
    for (const uint32_t f : *order)
      // Derivatives of values that depend on no other derivative, then those that depended on these alone, and so on.
      for (size_t round = 0; asks(f); ++round) {
        support::assert_that(round < most_rounds, "a derivative depends on itself");
        rewrite(f);
      }
  }

 private:
  /// A parameter that holds another parameter's derivative.
  struct Gradient {
    uint32_t of;  ///< a parameter
    size_t way;
    uint32_t parameter;
  };

  /// The gradients that a call does not pass yet.
  std::span<const Gradient> missing_gradients(const Function& caller, const Instruction& made) const {
    if (made.op != Opcode::call || caller.operands_of(made).size() == module_.functions[made.imm].parameters.size())
      return {};
    return gradients_.at(made.imm);
  }

  bool asks(uint32_t f) const {
    const Function& function = module_.functions[f];
    return std::ranges::any_of(function.blocks, [&](const Block& block) {
      return std::ranges::any_of(block.instructions, [&](InstructionId id) {
        const Instruction& made = function.instructions[id];
        return is_derivative(made.op) || !missing_gradients(function, made).empty();
      });
    });
  }

  /// The values that depend on a derivative, so that their own comes later.
  Marks find_derived(const Function& function) const {
    Marks derivatives(function.values.size());
    for (const Block& block : function.blocks) {
      for (const InstructionId id : block.instructions) {
        const Instruction& made = function.instructions[id];
        if (!is_derivative(made.op) && missing_gradients(function, made).empty()) continue;
        for (uint32_t k = 0; k < made.result_count; ++k) derivatives[made.first_result + k] = true;
      }
    }
    return depending(function, std::move(derivatives));
  }

  /// The function that gives the derivatives of another's results where these start, or none.
  uint32_t source_of(uint32_t function, const std::string& suffix) const {
    const Function& f = module_.functions[function];
    return f.document.empty() && f.library.empty() ? module_.find(f.name + suffix) : none;
  }

  /// Whether the program that links the module defines the function; then it defines the function's change, too.
  bool is_hosts(uint32_t function) const {
    const Function& f = module_.functions[function];
    return f.is_declaration() && f.library.empty();
  }
  bool is_source(uint32_t function) const { return source_of(function, std::string(ddx_suffix)) != none; }

  CallChanges call_changes() {
    return [this](const Instruction& made, const Marks& arguments) {
      return results_changing(made.imm, arguments);
    };
  }
  Marks results_changing(uint32_t function, const Marks& parameters);

  void rewrite(uint32_t function);
  std::vector<Way> ways_of(const Function& function, const Marks& derived);
  /// Appends parameters for the derivatives that a function needs and does not have yet.
  void add_gradients(uint32_t function, Function& declared, const Function& from, const std::vector<Way>& ways);
  Values call_with_gradients(Tangents& tangents, Builder& b, const Function& from,
                             const std::vector<Way>& ways, const Marks& derived, const Instruction& made,
                             Values arguments);

  Values changes_of_call(Builder& b, const Instruction& made, const Values& arguments, const Way& way,
                         const Function& from);
  uint32_t change_function(uint32_t function, const Marks& parameters, const Marks& results);
  void build_by_rule(Builder& b, const functions::DerivativeRule& rule, const Marks& parameters);
  void build_by_body(Builder& b, const Function& from, const Marks& parameters, const Marks& results);
  Function with_body(uint32_t function);
  std::string free_name(const std::string& wanted) const;

  Module& module_;
  std::map<uint32_t, std::vector<Gradient>> gradients_;  ///< by function that has some
  std::map<std::tuple<uint32_t, Marks, Marks>, uint32_t> change_functions_;
  std::map<std::pair<uint32_t, Marks>, Marks> results_changing_;
};

std::string Differentiation::free_name(const std::string& wanted) const {
  std::string name = wanted;
  for (int number = 2; module_.find(name) != none; ++number) name = wanted + std::to_string(number);
  return name;
}

/// "max_change", or "max_change_of_a" if only that argument changes, "light_at_change_to_color" if only that result is
/// needed. No numbers, which would depend on the order in which lowering made calls.
std::string change_name(const Function& f, const Marks& parameters, const Marks& results) {
  std::string of, to;
  bool all = true;
  for (size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i]) of += "_" + f.parameters[i].name;
    all &= parameters[i] || !f.parameters[i].type.is_float();
  }
  for (size_t i = 0; i < results.size(); ++i)
    if (results[i]) to += "_" + f.results[i].name;
  const bool all_results = std::ranges::find(results, false) == results.end();
  return f.name + "_change" + (all ? "" : "_of" + of) + (all_results ? "" : "_to" + to);
}

/// The body of a library function is built only for this, and its declaration stays one. It is the default body in
/// every tier, because steps that a cheaper body leaves out may carry the slope; the functions that it calls follow
/// the tier.
Function Differentiation::with_body(uint32_t function) {
  const Function declaration = module_.functions[function];
  if (!declaration.is_declaration()) return declaration;
  {
    Builder builder(module_, function);
    functions::variant_of(declaration).body(functions::Tier::standard)(builder);
  }
  return std::exchange(module_.functions[function], declaration);
}

Marks Differentiation::results_changing(uint32_t function, const Marks& parameters) {
  const Function& f = module_.functions[function];
  if (is_source(function)) return Marks(f.results.size(), true);
  if (!f.library.empty()) {
    const auto* rule = functions::find_derivative(functions::variant_of(f));
    bool changes = any(parameters);
    if (rule != nullptr) {
      changes = false;
      for (size_t i = 0; i < parameters.size() && i < rule->size(); ++i)
        changes |= parameters[i] && (*rule)[i] != nullptr;
    }
    return Marks(f.results.size(), changes);
  }
  const auto key = std::pair(function, parameters);
  if (const auto known = results_changing_.find(key); known != results_changing_.end()) return known->second;
  Marks results;
  if (f.is_declaration()) {
    results.assign(f.results.size(), any(parameters));
  } else {
    const Marks values = changing(f, parameters, call_changes());
    for (const ValueId yield : f.blocks[0].yields) results.push_back(values[yield]);
  }
  return results_changing_[key] = results;
}

std::vector<Way> Differentiation::ways_of(const Function& function, const Marks& derived) {
  Marks parameters;
  for (const Parameter& parameter : function.parameters)
    parameters.push_back(parameter.type.is_float() && !parameter.uniform);
  const Marks changes = changing(function, parameters, call_changes());
  std::vector<Way> ways{{std::string(ddx_suffix), Opcode::ddx, {}},
                        {std::string(ddy_suffix), Opcode::ddy, {}}};
  for (size_t w = 0; w < ways.size(); ++w) {
    Marks wanted(function.values.size());
    const auto want = [&](ValueId value) { wanted[value] = wanted[value] || !derived[value]; };
    for (const Block& block : function.blocks) {
      for (const InstructionId id : block.instructions) {
        const Instruction& made = function.instructions[id];
        if (made.op == ways[w].op) want(function.operands_of(made)[0]);
        for (const Gradient& gradient : missing_gradients(function, made))
          if (gradient.way == w && gradient.of < function.operands_of(made).size())
            want(function.operands_of(made)[gradient.of]);
      }
    }
    ways[w].needed = needed(function, changes, wanted);
  }
  return ways;
}

void Differentiation::add_gradients(uint32_t function, Function& declared, const Function& from,
                                    const std::vector<Way>& ways) {
  std::vector<Gradient>& known = gradients_[function];
  for (uint32_t i = 0; i < from.parameters.size(); ++i) {
    for (size_t w = 0; w < ways.size(); ++w) {
      if (!ways[w].needed[from.blocks[0].parameters[i]]) continue;
      if (std::ranges::any_of(known, [&](const Gradient& gradient) { return gradient.of == i && gradient.way == w; }))
        continue;
      std::string name = from.parameters[i].name + ways[w].suffix;
      const auto taken = [&] {
        return std::ranges::any_of(declared.parameters, [&](const Parameter& parameter) {
          return parameter.group == "gradients" && parameter.name == name;
        });
      };
      while (taken()) name += "_";
      const auto parameter = static_cast<uint32_t>(declared.parameters.size());
      declared.parameters.push_back({name, from.parameters[i].type, "gradients", false});
      known.push_back({i, w, parameter});
    }
  }
}

void Differentiation::rewrite(uint32_t function) {
  const Function from = module_.functions[function];
  const Marks derived = find_derived(from);
  std::vector<Way> ways = ways_of(from, derived);
  Function declared;
  declared.name = from.name;
  declared.document = from.document;
  declared.parameters = from.parameters;
  declared.results = from.results;
  add_gradients(function, declared, from, ways);
  module_.functions[function] = std::move(declared);

  Builder b(module_, function);
  Tangents* self = nullptr;
  Tangents tangents(
      b, from, ways, [&](const Instruction& made) { return derived[from.operands_of(made)[0]]; },
      [&](const Instruction& made, const Values& arguments) {
        return call_with_gradients(*self, b, from, ways, derived, made, arguments);
      },
      [&](const Instruction& made, const Values& arguments, const Way& way) {
        return changes_of_call(b, made, arguments, way, from);
      });
  self = &tangents;
  for (const Gradient& gradient : gradients_[function])
    if (ways[gradient.way].needed[from.blocks[0].parameters[gradient.of]])
      ways[gradient.way].change[from.blocks[0].parameters[gradient.of]] = b.parameter(gradient.parameter);
  tangents.run();
  b.set_origin(0);
  Values results;
  for (const ValueId yield : from.blocks[0].yields) results.push_back(tangents.value(yield));
  b.finish(results);
}

Values Differentiation::call_with_gradients(Tangents& tangents, Builder& b, const Function& from,
                                            const std::vector<Way>& ways, const Marks& derived,
                                            const Instruction& made, Values arguments) {
  for (const Gradient& gradient : missing_gradients(from, made)) {
    const Way& way = ways[gradient.way];
    // A derivative of an argument that is a derivative itself is left for the next round.
    const bool is_argument = gradient.of < from.operands_of(made).size();
    const bool waits = !is_argument || derived[from.operands_of(made)[gradient.of]];
    arguments.push_back(waits ? b.op(way.op, {arguments[gradient.of]})
                              : tangents.change(way, from.operands_of(made)[gradient.of]));
  }
  return b.call(made.imm, arguments);
}

Values Differentiation::changes_of_call(Builder& b, const Instruction& made, const Values& arguments,
                                        const Way& way, const Function& from) {
  Marks results;
  for (uint32_t k = 0; k < made.result_count; ++k) results.push_back(way.needed[made.first_result + k]);
  Values changes(made.result_count, none);
  if (!any(results)) return changes;
  if (is_source(made.imm)) {
    support::assert_that(is_derivative(way.op),
                   "what changes of itself lies below a function that is differentiated");
    return b.call(source_of(made.imm, way.suffix), arguments);
  }
  Marks parameters;
  Values all = arguments;
  for (const ValueId operand : from.operands_of(made)) {
    parameters.push_back(way.change[operand] != none);
    if (parameters.back()) all.push_back(way.change[operand]);
  }
  if (!any(parameters)) return changes;
  // A host's function gives the changes of all its results.
  if (is_hosts(made.imm)) results.assign(results.size(), true);
  const Values made_changes = b.call(change_function(made.imm, parameters, results), all);
  size_t next = 0;
  for (uint32_t k = 0; k < made.result_count; ++k)
    if (results[k]) changes[k] = made_changes[next++];
  return changes;
}

uint32_t Differentiation::change_function(uint32_t function, const Marks& parameters, const Marks& results) {
  const auto key = std::tuple(function, parameters, results);
  if (const auto known = change_functions_.find(key); known != change_functions_.end()) return known->second;
  const Function f = module_.functions[function];
  Function declared;
  declared.name = free_name(change_name(f, parameters, results));
  declared.document = f.document;
  declared.parameters = f.parameters;
  for (size_t i = 0; i < parameters.size(); ++i) {
    if (!parameters[i]) continue;
    std::string name = f.parameters[i].name + "_change";
    const auto taken = [&](const Parameter& parameter) { return parameter.name == name; };
    while (std::ranges::any_of(declared.parameters, taken)) name += "_";
    declared.parameters.push_back({name, f.parameters[i].type, "", false});
  }
  for (size_t i = 0; i < results.size(); ++i)
    if (results[i]) declared.results.push_back(f.results[i]);
  const auto index = static_cast<uint32_t>(module_.functions.size());
  module_.functions.push_back(std::move(declared));
  change_functions_[key] = index;

  if (is_hosts(function)) return index;
  const auto* rule = f.library.empty() ? nullptr : functions::find_derivative(functions::variant_of(f));
  if (rule != nullptr) {
    Builder b(module_, index);
    build_by_rule(b, *rule, parameters);
  } else {
    const Function from = with_body(function);
    Builder b(module_, index);
    build_by_body(b, from, parameters, results);
  }
  return index;
}

void Differentiation::build_by_rule(Builder& b, const functions::DerivativeRule& rule,
                                    const Marks& parameters) {
  support::assert_that(parameters.size() <= rule.size(), "a rule of too many arguments");
  Values arguments;
  for (size_t i = 0; i < parameters.size(); ++i) arguments.push_back(b.parameter(i));
  ValueId sum = none;
  size_t next = parameters.size();
  for (size_t i = 0; i < parameters.size(); ++i) {
    if (!parameters[i]) continue;
    const ValueId change = b.parameter(next++);
    if (rule[i] == nullptr) continue;
    const ValueId part = rule[i](b, arguments, change);
    sum = sum == none ? part : b.op(Opcode::fadd, {sum, part});
  }
  support::assert_that(sum != none, "a function changes with no argument");
  b.finish(std::array{sum});
}

void Differentiation::build_by_body(Builder& b, const Function& from, const Marks& parameters,
                                    const Marks& results) {
  const Marks changes = changing(from, parameters, call_changes());
  Marks wanted(from.values.size());
  for (size_t i = 0; i < results.size(); ++i)
    if (results[i]) wanted[from.blocks[0].yields[i]] = true;
  std::vector<Way> ways{{"_change", Opcode::constant, needed(from, changes, wanted)}};
  Tangents tangents(
      b, from, ways, [](const Instruction&) { return false; },
      [&](const Instruction& made, const Values& arguments) { return b.call(made.imm, arguments); },
      [&](const Instruction& made, const Values& arguments, const Way& way) {
        return changes_of_call(b, made, arguments, way, from);
      });
  size_t next = from.parameters.size();
  for (size_t i = 0; i < parameters.size(); ++i)
    if (parameters[i]) ways[0].change[from.blocks[0].parameters[i]] = b.parameter(next++);
  tangents.run();
  b.set_origin(0);
  Values out;
  for (size_t i = 0; i < results.size(); ++i)
    if (results[i]) out.push_back(tangents.change(ways[0], from.blocks[0].yields[i]));
  b.finish(out);
}

}  // namespace

void derivatives(Module& module) {
  if (asks_for_derivatives(module)) Differentiation(module).run();
}

}  // namespace isoshade::passes
