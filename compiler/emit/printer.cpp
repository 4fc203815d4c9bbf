// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/printer.h"

#include <array>

#include "compiler/emit/function_printer.h"
#include "compiler/ir/call_graph.h"
#include "compiler/support/check.h"

namespace isoshade::emit {

std::string record_name(std::string_view group) {
  std::string name(group);
  if (!name.empty() && name[0] >= 'a' && name[0] <= 'z') name[0] = static_cast<char>(name[0] - 'a' + 'A');
  return name;
}

namespace {

bool loads_directly(const ir::Function& function) {
  for (const ir::Instruction& instruction : function.instructions)
    if (instruction.op == ir::Opcode::load) return true;
  return false;
}

/// The structs of a function: one for its results if there are several, one for each parameter group.
void print_records(std::string& out, const ir::Function& function, const FunctionText& text,
                   const Language& language) {
  if (!text.result_type.empty()) {
    std::vector<std::pair<ir::Type, std::string>> fields;
    for (size_t i = 0; i < function.results.size(); ++i)
      fields.emplace_back(function.results[i].type, text.result_fields[i]);
    language.record(out, text.result_type, fields, false);
    out += "\n";
  }
  for (size_t i = 0; i < function.parameters.size();) {
    const ir::Parameter& first = function.parameters[i];
    if (first.group.empty()) {
      ++i;
      continue;
    }
    Names names;
    std::vector<std::pair<ir::Type, std::string>> fields;
    for (; i < function.parameters.size() && function.parameters[i].group == first.group; ++i)
      fields.emplace_back(function.parameters[i].type, names.take(function.parameters[i].name));
    language.record(out, record_name(first.group), fields, first.uniform);
    out += "\n";
  }
}

}  // namespace

std::string print_functions(const ir::Module& module, uint32_t entry, const Language& language,
                            std::vector<FunctionText>& texts) {
  const std::array entries{entry};
  const auto order = ir::callees_first(module, entries);
  support::check(order.has_value(), "calls are cyclic");
  texts.assign(module.functions.size(), {});
  Names globals;
  for (const ir::Buffer& buffer : module.buffers) globals.hold(buffer.name);
  // Library functions and stages are named by us; lowering keeps authors' names off `shade`.
  const auto is_ours = [](const ir::Function& function) {
    return function.document.empty() || function.name == "shade";
  };
  for (uint32_t index : *order)
    if (is_ours(module.functions[index])) globals.hold(module.functions[index].name);
  for (uint32_t index : *order) {
    const ir::Function& function = module.functions[index];
    FunctionText& text = texts[index];
    text.name = is_ours(function) ? function.name : globals.take_function(function.name);
    text.loads = loads_directly(function);
    for (const ir::Instruction& instruction : function.instructions)
      if (instruction.op == ir::Opcode::call) text.loads |= texts[instruction.imm].loads;
    if (function.results.size() <= 1) continue;
    text.result_type = globals.take(record_name(text.name) + "Result");
    Names fields;
    for (const ir::Result& result : function.results) text.result_fields.push_back(fields.take(result.name));
  }
  std::string out;
  for (uint32_t index : *order) {
    const ir::Function& function = module.functions[index];
    if (!out.empty()) out += "\n";
    if (!function.document.empty()) out += "// " + comment_text(function.document) + "\n";
    print_records(out, function, texts[index], language);
    print_function(out, module, function, texts[index], language, texts, globals);
  }
  return out;
}

}  // namespace isoshade::emit
