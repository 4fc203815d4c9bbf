// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/printer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <unordered_map>

#include "compiler/emit/function_printer.h"
#include "compiler/emit/known_text.h"
#include "compiler/emit/literal.h"
#include "compiler/ir/call_graph.h"
#include "compiler/lower/lower.h"
#include "compiler/support/assert.h"

namespace isoshade::emit {

namespace {

const ir::Buffer unread_buffer{};

/// The struct that a function's results or a parameter group become: "light_at" -> "LightAt".
std::string record_name(std::string_view group) {
  std::string name;
  bool begins_word = true;
  for (const char c : group) {
    const bool is_small = c >= 'a' && c <= 'z';
    if (c != '_') name += begins_word && is_small ? static_cast<char>(c - 'a' + 'A') : c;
    begins_word = c == '_';
  }
  return name;
}

void print_result_record(std::string& out, const ir::Function& function, const FunctionText& text,
                         const Language& language) {
  if (text.result_type.empty()) return;
  std::vector<RecordField> fields;
  for (size_t i = 0; i < function.results.size(); ++i)
    fields.push_back({function.results[i].type, text.result_fields[i]});
  language.record(out, text.result_type, fields, false);
  if (!fits_on_line(text.result_type, fields)) out += "\n";
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
    std::vector<RecordField> printed;
    for (const ir::Parameter& field : fields) {
      made.names.push_back(names.take(field.name));
      printed.push_back({field.type, made.names.back(), comment_text(comment_of(field))});
    }
    language_.record(out, made.name, printed, fields[0].uniform);
    out += "\n";
    return made;
  }

  const Language& language_;
  Names& globals_;
  std::vector<Record> records_;
};

/// Names of functions of our own. Those of the library that differ in the types of their arguments alone share one:
/// the types select the function, in every language.
class OwnNames {
 public:
  /// `ending`: of the names of library functions.
  explicit OwnNames(Names& globals, std::string ending = "") : globals_(globals), ending_(std::move(ending)) {}

  std::string take(const ir::Function& function) {
    if (function.library.empty()) return globals_.take_own(function.name);
    const auto is_float = [](const ir::Parameter& parameter) { return parameter.type.is_float(); };
    if (!std::ranges::all_of(function.parameters, is_float)) return globals_.take_own(function.name + ending_);
    std::string shared = std::string(without_types(function.name)) + ending_;
    const auto [name, is_new] = names_.try_emplace(shared);
    if (is_new) name->second = globals_.take_own(shared);
    return name->second;
  }

 private:
  /// "iso_mix_v3v3f" -> "iso_mix": variants of one row never have the same types.
  static std::string_view without_types(std::string_view name) {
    const size_t last = name.rfind('_');
    std::string_view types = name.substr(last + 1);
    if (!types.starts_with('v') && !types.starts_with('m')) return name;
    while (!types.empty()) {
      const bool is_wide =
          (types[0] == 'v' || types[0] == 'm') && types.size() > 1 && types[1] >= '2' && types[1] <= '4';
      if (!is_wide && types[0] != 'f') return name;
      types.remove_prefix(is_wide ? 2 : 1);
    }
    return name.substr(0, last);
  }

  Names& globals_;
  std::string ending_;
  std::unordered_map<std::string, std::string> names_;  ///< by the name that they share in the IR
};

}  // namespace

std::string comment_of(const ir::Parameter& parameter) {
  constexpr float unbounded = 1e30f;
  std::string text = parameter.doc;
  const auto number = [](float value) { return decimal(std::bit_cast<uint32_t>(value)); };
  const bool from = parameter.least && *parameter.least > -unbounded;
  const bool to = parameter.most && *parameter.most < unbounded;
  if (!from && !to) return text;
  text += text.empty() ? "" : "; ";
  if (from) text += (to ? "" : "at least ") + number(*parameter.least);
  if (to) text += (from ? " to " : "at most ") + number(*parameter.most);
  return text;
}

bool fits_on_line(std::string_view name, std::span<const RecordField> fields) {
  size_t columns = name.size() + 12;
  for (const RecordField& field : fields) {
    if (!field.comment.empty()) return false;
    columns += field.name.size() + 7;
  }
  return columns <= 80;
}

bool uses_hidden_zero(const ir::Module& module, uint32_t entry) {
  const std::array entries{entry};
  const auto reached = ir::callees_first(module, entries);
  for (uint32_t index : *reached)
    for (const ir::Instruction& instruction : module.functions[index].instructions)
      if (instruction.op == ir::Opcode::hidden_zero) return true;
  return false;
}

RecordWords::RecordWords(const ir::Buffer& buffer, Names& globals)
    : buffer_(buffer), taken_(buffer.fields.size()) {
  for (uint32_t i = 0; i < buffer.fields.size(); ++i) {
    const ir::RecordField& field = buffer.fields[i];
    names_.push_back(globals.take(field.name));
    if (field_of_word_.size() < field.first + field.words)
      field_of_word_.resize(field.first + field.words, ir::none);
    std::fill_n(field_of_word_.begin() + field.first, field.words, i);
  }
}

const std::string* RecordWords::take(uint32_t word, uint32_t& rest) {
  if (word >= field_of_word_.size() || field_of_word_[word] == ir::none) return nullptr;
  const uint32_t field = field_of_word_[word];
  taken_[field] = true;
  rest = word - buffer_.fields[field].first;
  return &names_[field];
}

void RecordWords::take_again(const std::vector<bool>& fields) {
  for (size_t i = 0; i < taken_.size(); ++i) taken_[i] = taken_[i] || fields[i];
}

std::vector<std::string> RecordWords::taken() const {
  std::vector<std::string> constants;
  for (size_t i = 0; i < names_.size(); ++i)
    if (taken_[i]) constants.push_back(names_[i] + " = " + std::to_string(buffer_.fields[i].first));
  return constants;
}

WordReaders::WordReaders(const ir::Buffer& buffer, Names& globals) : buffer_(buffer) {
  if (!buffer.name.empty())
    for (size_t i = 0; i < names_.size(); ++i) names_[i] = globals.take(buffer.name + std::to_string(i + 2));
}

const std::string& WordReaders::take(size_t width) {
  taken_[width - 2] = true;
  return names_[width - 2];
}

void WordReaders::take_again(const std::array<bool, 3>& widths) {
  for (size_t i = 0; i < taken_.size(); ++i) taken_[i] = taken_[i] || widths[i];
}

void WordReaders::define(std::string& out, const Language& language) const {
  for (int width = 2; width <= 4; ++width) {
    if (!taken_[static_cast<size_t>(width - 2)]) continue;
    language.word_reader(out, names_[static_cast<size_t>(width - 2)], width);
    for (int i = 0; i < width; ++i) {
      if (i != 0) out += ", ";
      language.load(out, buffer_.name, i == 0 ? "word" : "word + " + std::to_string(i));
    }
    language.end_word_reader(out);
  }
}

/// `const int roughness = 54, metallic = 55;` for each name that was taken, several a line.
static void declare(const std::vector<RecordWords>& records, std::string& out) {
  constexpr size_t columns = 116;
  size_t line = 0;
  for (const RecordWords& words : records) {
    for (const std::string& constant : words.taken()) {
      const bool fits = !out.empty() && out.size() - line + constant.size() + 3 <= columns;
      if (!out.empty()) out += fits ? ", " : ";\n";
      if (!fits) line = out.size();
      out.append(fits ? "" : "const int ").append(constant);
    }
  }
  if (!out.empty()) out += ";\n";
}

namespace {

/// Prints functions in an order, and what they share.
class FunctionsPrinter {
 public:
  FunctionsPrinter(const ir::Module& module, std::span<const uint32_t> entries, const std::vector<uint32_t>& order,
                   const Language& language, std::vector<FunctionText>& texts)
      : module_(module), order_(order), language_(language), texts_(texts), groups_(language, globals_) {
    for (const uint32_t entry : entries) {
      const ir::Function& function = module.functions[entry];
      own_documents_.push_back(function.document);
      for (const ir::Instruction& instruction : function.instructions)
        if (instruction.op == ir::Opcode::call)
          own_documents_.push_back(module.functions[instruction.imm].document);
    }
    std::erase(own_documents_, std::string_view());
    is_entry_.assign(module.functions.size(), false);
    for (const uint32_t entry : entries) is_entry_[entry] = true;
  }

  Names& globals() { return globals_; }

  /// What loads, and what several results are called, once all functions have names. `prefix`: of names of structs.
  void settle(const std::string& prefix) {
    std::vector<bool> loaded(module_.buffers.size());
    for (const uint32_t index : order_) {
      const ir::Function& function = module_.functions[index];
      FunctionText& text = texts_[index];
      text.loads |= !text.host.empty() || std::ranges::any_of(text.parameters, &ParameterText::is_call);
      for (const ir::Instruction& instruction : function.instructions) {
        if (instruction.op == ir::Opcode::load) text.loads = loaded[instruction.imm] = true;
        if (instruction.op == ir::Opcode::call) text.loads |= texts_[instruction.imm].loads;
      }
      if (function.results.size() <= 1 || !text.result_type.empty()) continue;
      std::string_view name = text.name;
      if (name.starts_with(prefix)) name.remove_prefix(prefix.size());
      text.result_type = globals_.take(prefix + record_name(name) + "Result");
      Names fields(Scope::field);
      for (const ir::Result& result : function.results) text.result_fields.push_back(fields.take(result.name));
    }
    for (size_t i = 0; i < module_.buffers.size(); ++i) {
      records_.emplace_back(loaded[i] ? module_.buffers[i] : unread_buffer, globals_);
      readers_.emplace_back(loaded[i] ? module_.buffers[i] : unread_buffer, globals_);
    }
  }

  /// Appends a function to a text, which ends with what was printed to it before.
  void print(std::string& out, uint32_t index) {
    const ir::Function& function = module_.functions[index];
    const size_t before = out.size();
    if (!out.empty()) out += "\n";
    if (!function.document.empty()) out += "// " + comment_text(function.document) + "\n";
    print_result_record(out, function, texts_[index], language_);
    if (!texts_[index].has_signature) groups_.print(out, function, texts_[index]);
    const size_t begin = out.size();
    const TextContext context{module_, language_, texts_, globals_, records_, readers_};
    const bool is_line = is_own(index) ? print_function(out, function, texts_[index], context)
                                       : print_known_function(out, function, texts_[index], context);
    // Functions of a line stand together.
    if (is_line && follows_line_ && begin == before + 1) out.erase(before, 1);
    follows_line_ = is_line;
  }

  /// Constants and functions for reading buffers, which stand in front.
  std::string head() const {
    std::string head;
    declare(records_, head);
    if (!head.empty()) head += "\n";
    const size_t constants = head.size();
    for (const WordReaders& reader : readers_) reader.define(head, language_);
    if (head.size() != constants) head += "\n";
    return head;
  }

 private:
  /// Whether a function was made for this program: an entry, or one of the document whose functions the entries call. The
  /// others are of the library, of documents that it calls, or of ours.
  bool is_own(uint32_t index) const {
    return is_entry_[index] || std::ranges::find(own_documents_, module_.functions[index].document) != own_documents_.end();
  }

  const ir::Module& module_;
  const std::vector<uint32_t>& order_;
  const Language& language_;
  std::vector<FunctionText>& texts_;
  Names globals_{Scope::global};
  std::vector<RecordWords> records_;
  std::vector<WordReaders> readers_;
  GroupRecords groups_;
  std::vector<std::string_view> own_documents_;
  std::vector<bool> is_entry_;  ///< by function
  bool follows_line_ = false;
};

std::vector<uint32_t> order_of(const ir::Module& module, std::span<const uint32_t> entries) {
  const auto order = ir::callees_first(module, entries);
  support::assert_that(order.has_value(), "calls are cyclic");
  return *order;
}

/// Which functions texts can share, by function: those of the library that call no others. One that passes a constant on
/// calls a clone, which may be another in each text.
std::vector<bool> shared_functions(const ir::Module& module, const std::vector<uint32_t>& callees_first) {
  std::vector<bool> shared(module.functions.size());
  for (const uint32_t index : callees_first) {
    const ir::Function& function = module.functions[index];
    shared[index] = !function.library.empty();
    for (const ir::Block& block : function.blocks)
      for (const ir::InstructionId id : block.instructions) {
        const ir::Instruction& instruction = function.instructions[id];
        if (instruction.op == ir::Opcode::call && !shared[instruction.imm]) shared[index] = false;
      }
  }
  return shared;
}

/// A macro that tells whether a text has a function, and which: its value is a hash of the text.
void add_guarded(std::string& out, std::string& checks, const std::string& function_name, const std::string& text) {
  std::string macro = function_name;
  for (char& c : macro)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  const std::string value = std::to_string(hash_of(text));
  out += "#ifndef " + macro + "\n#define " + macro + " " + value + "\n" + text + "#endif\n";
  checks += (checks.empty() ? "#if " : " || \\\n    ") + macro + " != " + value;
}

}  // namespace

uint32_t hash_of(std::string_view text) {
  uint32_t hash = 2166136261u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619u;
  return hash & 0x7fffffffu;
}

std::string print_functions(const ir::Module& module, uint32_t entry, const Language& language,
                            std::vector<FunctionText>& texts) {
  const std::array entries{entry};
  const std::vector<uint32_t> order = order_of(module, entries);
  texts.assign(module.functions.size(), {});
  FunctionsPrinter printer(module, entries, order, language, texts);
  Names& globals = printer.globals();
  for (const ir::Buffer& buffer : module.buffers) globals.hold(buffer.name);
  // Library functions and stages are named by us, and first.
  const auto is_ours = [](const ir::Function& function) {
    return function.document.empty() || interface::is_kernel_function(function.name);
  };
  OwnNames own(globals);
  for (const uint32_t index : order)
    if (is_ours(module.functions[index])) texts[index].name = own.take(module.functions[index]);
  for (const uint32_t index : order)
    if (!is_ours(module.functions[index])) texts[index].name = globals.take(module.functions[index].name);
  printer.settle("");
  std::string out;
  for (const uint32_t index : order) printer.print(out, index);
  return printer.head() + out;
}

LinkedText print_linked(const ir::Module& module, std::span<const uint32_t> entries, const Language& language,
                        const LinkedNames& names, std::vector<FunctionText>& texts) {
  const std::vector<uint32_t> order = order_of(module, entries);
  const std::vector<bool> shared = shared_functions(module, order);
  FunctionsPrinter printer(module, entries, order, language, texts);
  Names& globals = printer.globals();
  for (const FunctionText& text : texts)
    if (!text.name.empty()) globals.hold(text.name);
  for (const std::string& record : names.records) globals.hold(record);
  OwnNames library(globals, names.tier);
  for (const uint32_t index : order)
    if (shared[index]) texts[index].name = library.take(module.functions[index]);
  for (const uint32_t index : order)
    if (texts[index].name.empty() && texts[index].host.empty()) {
      const ir::Function& function = module.functions[index];
      texts[index].noun = function.name;
      const std::string wanted = names.prefix + function.name;
      texts[index].name = function.document.empty() ? globals.take_own(wanted) : globals.take(wanted);
    }
  printer.settle(names.prefix);
  LinkedText made;
  std::string checks;
  for (const uint32_t index : order) {
    if (!texts[index].host.empty()) continue;
    if (!shared[index]) {
      printer.print(made.own, index);
      continue;
    }
    std::string text;
    printer.print(text, index);
    add_guarded(made.shared, checks, module.functions[index].name + names.tier, text);
  }
  if (!checks.empty())
    made.shared += checks + "\n#error \"Two files of one program come from different versions of isoshade\"\n#endif\n";
  return made;
}

}  // namespace isoshade::emit
