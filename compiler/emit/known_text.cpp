// SPDX-License-Identifier: Apache-2.0
#include "compiler/emit/known_text.h"

#include <algorithm>
#include <array>
#include <memory>
#include <mutex>
#include <unordered_map>

#include "compiler/emit/function_printer.h"

namespace isoshade::emit {

namespace {

/// Longer functions are seldom those of a library.
constexpr size_t most_instructions = 500;
/// All are forgotten when there are more bytes.
constexpr size_t most_bytes = 8 << 20;

/// What was printed.
struct KnownText {
  std::string text;
  bool is_line = false;
  // The text is the same where the globals have the names that locals avoided, and none of the others.
  support::NameTable locals;         ///< all names that locals have, or would have had
  std::vector<std::string> avoided;
  std::vector<TakenWords> taken;  ///< of each buffer of KeyWriter::buffers
};

/// Writes all that the text of a function depends on, but for the names of globals.
class KeyWriter {
 public:
  KeyWriter(const ir::Function& function, const FunctionText& text, const TextContext& context)
      : f_(function), context_(context) {
    key_.reserve(256 + 80 * f_.instructions.size());
    context.language.identify(key_, f_);
    add(text);
    parameters(f_);
    for (const ir::Result& result : f_.results) key_.append({code(result.type), ';'});
    body();
  }

  std::string take() { return std::move(key_); }
  /// The buffers that it loads from, in order.
  const std::vector<uint32_t>& buffers() const { return buffers_; }

 private:
  static char code(ir::Type type) { return static_cast<char>(static_cast<int>(type.scalar) * 8 + type.width); }

  template <size_t count>
  void numbers(const std::array<uint32_t, count>& values) {
    key_.append(reinterpret_cast<const char*>(values.data()), sizeof values);
  }
  void list(const std::vector<uint32_t>& values) {
    numbers(std::array{static_cast<uint32_t>(values.size())});
    key_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(uint32_t));
  }
  void string(std::string_view text) {
    numbers(std::array{static_cast<uint32_t>(text.size())});
    key_.append(text);
  }
  void strings(const std::vector<std::string>& texts) {
    numbers(std::array{static_cast<uint32_t>(texts.size())});
    for (const std::string& text : texts) string(text);
  }

  void add(const FunctionText& text) {
    for (const std::string* part : {&text.name, &text.result_type, &text.noun, &text.host, &text.leading}) string(*part);
    for (const auto* parts : {&text.result_fields, &text.groups, &text.fields}) strings(*parts);
    key_.append({text.loads ? 'l' : '-', text.is_given_host ? 'h' : '-'});
  }
  void parameters(const ir::Function& function) {
    numbers(std::array{static_cast<uint32_t>(function.parameters.size())});
    for (const ir::Parameter& parameter : function.parameters) {
      string(parameter.name);
      string(parameter.group);
      key_.append({code(parameter.type), parameter.uniform ? 'u' : '-'});
    }
  }

  void body() {
    numbers(std::array{static_cast<uint32_t>(f_.origins.size()), static_cast<uint32_t>(f_.values.size()),
                       static_cast<uint32_t>(f_.instructions.size()), static_cast<uint32_t>(f_.blocks.size())});
    for (const ir::Origin& origin : f_.origins) {
      string(origin.node);
      string(origin.doc);
      numbers(std::array{origin.line});
    }
    for (const ir::Value& value : f_.values)
      numbers(std::array{static_cast<uint32_t>(code(value.type)), value.names});
    list(f_.operands);
    for (const ir::Block& block : f_.blocks) {
      list(block.parameters);
      list(block.instructions);
      list(block.yields);
    }
    for (const ir::Instruction& made : f_.instructions) instruction(made);
  }

  void instruction(const ir::Instruction& made) {
    const bool is_index = made.op == ir::Opcode::call || made.op == ir::Opcode::load;  // into the module
    numbers(std::array{static_cast<uint32_t>(made.op), is_index ? 0 : made.imm, made.first_operand, made.operand_count,
                       made.first_result, made.result_count, made.blocks[0], made.blocks[1], made.origin});
    if (made.op == ir::Opcode::call) {
      add(context_.texts[made.imm]);
      parameters(context_.module.functions[made.imm]);
    }
    if (made.op == ir::Opcode::load) load(made.imm);
  }

  void load(uint32_t index) {
    const auto known = std::ranges::find(buffers_, index);
    numbers(std::array{static_cast<uint32_t>(known - buffers_.begin())});
    if (known != buffers_.end()) return;
    buffers_.push_back(index);
    const ir::Buffer& buffer = context_.module.buffers[index];
    string(buffer.name);
    key_ += buffer.one_record ? 'o' : '-';
    for (const ir::RecordField& field : buffer.fields) numbers(std::array{field.first, field.words});
    strings(context_.records[index].names());
    for (const std::string& name : context_.readers[index].names()) string(name);
  }

  const ir::Function& f_;
  const TextContext& context_;
  std::string key_;
  std::vector<uint32_t> buffers_;
};

/// By key. All threads share it.
class KnownTexts {
 public:
  std::shared_ptr<const KnownText> find(const std::string& key) {
    const std::lock_guard lock(mutex_);
    const auto found = texts_.find(key);
    return found == texts_.end() ? nullptr : found->second;
  }

  void add(std::string key, std::shared_ptr<const KnownText> made) {
    const std::lock_guard lock(mutex_);
    if (bytes_ > most_bytes) {
      texts_.clear();
      bytes_ = 0;
    }
    constexpr size_t of_name = 48;  // about
    const size_t bytes = key.size() + made->text.size() + of_name * made->locals.size();
    if (texts_.insert_or_assign(std::move(key), std::move(made)).second) bytes_ += bytes;
  }

 private:
  std::mutex mutex_;
  std::unordered_map<std::string, std::shared_ptr<const KnownText>> texts_;
  size_t bytes_ = 0;
};

bool holds_for(const KnownText& known, const Names& globals) {
  const auto is_avoided = [&](std::string_view name) {
    return std::ranges::find(known.avoided, name) != known.avoided.end();
  };
  for (size_t i = 0; i < known.locals.size(); ++i) {
    const std::string_view name = known.locals.name(i);
    if (globals.holds(name, known.locals.hash_of(i)) != is_avoided(name)) return false;
  }
  return std::ranges::all_of(known.avoided, [&](std::string_view name) {
    return globals.holds(name, support::NameTable::hash(name));
  });
}

}  // namespace

bool print_known_function(std::string& out, const ir::Function& function, const FunctionText& text,
                          const TextContext& context) {
  static KnownTexts known;
  if (function.is_declaration() || text.has_signature || function.instructions.size() > most_instructions)
    return print_function(out, function, text, context);
  KeyWriter writer(function, text, context);
  std::string key = writer.take();
  const std::vector<uint32_t>& buffers = writer.buffers();
  if (const auto found = known.find(key); found != nullptr && holds_for(*found, context.globals)) {
    for (size_t i = 0; i < buffers.size(); ++i) {
      context.records[buffers[i]].take_again(found->taken[i].fields);
      context.readers[buffers[i]].take_again(found->taken[i].widths);
    }
    out += found->text;
    return found->is_line;
  }

  auto made = std::make_shared<KnownText>();
  std::vector<TakenWords> before;
  for (const uint32_t buffer : buffers)
    before.push_back({context.records[buffer].forget(), context.readers[buffer].forget()});
  Names locals(Scope::local);
  made->is_line = print_function(made->text, function, text, context, &locals);
  for (size_t i = 0; i < buffers.size(); ++i) {
    made->taken.push_back({context.records[buffers[i]].forget(), context.readers[buffers[i]].forget()});
    for (const TakenWords& taken : {before[i], made->taken[i]}) {
      context.records[buffers[i]].take_again(taken.fields);
      context.readers[buffers[i]].take_again(taken.widths);
    }
  }
  out += made->text;
  const bool is_line = made->is_line;
  made->locals = locals.take_table();
  made->avoided = locals.take_avoided();
  known.add(std::move(key), std::move(made));
  return is_line;
}

}  // namespace isoshade::emit
