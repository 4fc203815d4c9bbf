// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/printer.h"

#include <algorithm>
#include <array>
#include <span>

#include "compiler/emit/function_printer.h"
#include "compiler/ir/call_graph.h"
#include "compiler/lower/lower.h"
#include "compiler/support/assert.h"

namespace isoshade::emit {

namespace {

bool loads_directly(const ir::Function& function) {
  for (const ir::Instruction& instruction : function.instructions)
    if (instruction.op == ir::Opcode::load) return true;
  return false;
}

/// The struct that a function's results or a parameter group become: "surface" -> "Surface".
std::string record_name(std::string_view group) {
  std::string name(group);
  if (!name.empty() && name[0] >= 'a' && name[0] <= 'z') name[0] = static_cast<char>(name[0] - 'a' + 'A');
  return name;
}

void print_result_record(std::string& out, const ir::Function& function, const FunctionText& text,
                         const Language& language) {
  if (text.result_type.empty()) return;
  std::vector<std::pair<ir::Type, std::string>> fields;
  for (size_t i = 0; i < function.results.size(); ++i)
    fields.emplace_back(function.results[i].type, text.result_fields[i]);
  language.record(out, text.result_type, fields, false);
  out += "\n";
}

/// The structs that parameter groups become. Groups of one name and the same fields share one.
class GroupRecords {
 public:
  GroupRecords(const Language& language, Names& globals) : language_(language), globals_(globals) {}

  /// Names the structs of a function's groups and their fields, and prints those that are new.
  void print(std::string& out, const ir::Function& function, FunctionText& text) {
    text.groups.resize(function.parameters.size());
    text.fields.resize(function.parameters.size());
    for (size_t i = 0; i < function.parameters.size();) {
      const size_t begin = i;
      const std::string& group = function.parameters[begin].group;
      do ++i;
      while (i < function.parameters.size() && !group.empty() && function.parameters[i].group == group);
      if (group.empty()) continue;
      const Record& record = find(out, std::span(function.parameters).subspan(begin, i - begin));
      for (size_t k = begin; k < i; ++k) {
        text.groups[k] = record.name;
        text.fields[k] = record.names[k - begin];
      }
    }
  }

 private:
  struct Record {
    std::string name;
    std::vector<ir::Parameter> fields;
    std::vector<std::string> names;  ///< of the fields, in the text
  };

  const Record& find(std::string& out, std::span<const ir::Parameter> fields) {
    for (const Record& record : records_)
      if (std::equal(fields.begin(), fields.end(), record.fields.begin(), record.fields.end())) return record;
    Record& made = records_.emplace_back();
    made.name = globals_.take(record_name(fields[0].group));
    made.fields.assign(fields.begin(), fields.end());
    Names names(Scope::field);
    std::vector<std::pair<ir::Type, std::string>> printed;
    for (const ir::Parameter& field : fields) {
      made.names.push_back(names.take(field.name));
      printed.emplace_back(field.type, made.names.back());
    }
    language_.record(out, made.name, printed, fields[0].uniform);
    out += "\n";
    return made;
  }

  const Language& language_;
  Names& globals_;
  std::vector<Record> records_;
};

}  // namespace

bool uses_hidden_zero(const ir::Module& module, uint32_t entry) {
  const std::array entries{entry};
  const auto reached = ir::callees_first(module, entries);
  for (uint32_t index : *reached)
    for (const ir::Instruction& instruction : module.functions[index].instructions)
      if (instruction.op == ir::Opcode::hidden_zero) return true;
  return false;
}

std::string print_functions(const ir::Module& module, uint32_t entry, const Language& language,
                            std::vector<FunctionText>& texts) {
  const std::array entries{entry};
  const auto order = ir::callees_first(module, entries);
  support::assert_that(order.has_value(), "calls are cyclic");
  texts.assign(module.functions.size(), {});
  Names globals(Scope::global);
  for (const ir::Buffer& buffer : module.buffers) globals.hold(buffer.name);
  // Library functions and stages are named by us, and first.
  const auto is_ours = [](const ir::Function& function) {
    return function.document.empty() || interface::is_kernel_function(function.name);
  };
  for (const uint32_t index : *order)
    if (is_ours(module.functions[index])) texts[index].name = globals.take_own(module.functions[index].name);
  for (const uint32_t index : *order)
    if (!is_ours(module.functions[index])) texts[index].name = globals.take(module.functions[index].name);
  for (const uint32_t index : *order) {
    const ir::Function& function = module.functions[index];
    FunctionText& text = texts[index];
    text.loads = loads_directly(function);
    for (const ir::Instruction& instruction : function.instructions)
      if (instruction.op == ir::Opcode::call) text.loads |= texts[instruction.imm].loads;
    if (function.results.size() <= 1) continue;
    text.result_type = globals.take(record_name(text.name) + "Result");
    Names fields(Scope::field);
    for (const ir::Result& result : function.results) text.result_fields.push_back(fields.take(result.name));
  }
  std::string out;
  GroupRecords groups(language, globals);
  for (uint32_t index : *order) {
    const ir::Function& function = module.functions[index];
    if (!out.empty()) out += "\n";
    if (!function.document.empty()) out += "// " + comment_text(function.document) + "\n";
    print_result_record(out, function, texts[index], language);
    groups.print(out, function, texts[index]);
    print_function(out, module, function, texts[index], language, texts, globals);
  }
  return out;
}

}  // namespace isoshade::emit
