// SPDX-License-Identifier: Apache-2.0
// Reflections as JSON, their schema and their manual: three walks over reflection.def. What each type of a key is in them
// stands together, in a specialisation of Format.
#include <algorithm>
#include <charconv>
#include <cmath>

#include "compiler/nodes/schema_json.h"
#include "compiler/reflect/reflection.h"
#include "compiler/support/assert.h"
#include "compiler/support/parse_number.h"

namespace isoshade::reflect {

namespace {

using Json = nlohmann::ordered_json;
using nodes::SchemaJson;
using nodes::SchemaKey;

/// Writes JSON as Json::dump(2) does. Nothing stands in a Json but scalars: the destructor of others takes memory, and ends
/// the program where there is none.
class Writer {
 public:
  void scalar(const Json& value) { text_ += value.dump(-1, ' ', false, Json::error_handler_t::replace); }

  /// The shortest number that reads back as the same float.
  void number(float value) {
    const std::string text = support::format_float(value);
    double shortest = 0;
    std::from_chars(text.data(), text.data() + text.size(), shortest);
    scalar(static_cast<float>(shortest) == value ? shortest : static_cast<double>(value));
  }

  /// Calls write(item) with each.
  template <class Items, class Write>
  void array(const Items& items, const Write& write) {
    nested('[', ']', [&] {
      for (const auto& item : items) {
        next();
        write(item);
      }
    });
  }
  /// Calls write(), which calls key() before each value.
  template <class Write>
  void object(const Write& write) {
    nested('{', '}', write);
  }
  void key(std::string_view name) {
    next();
    scalar(name);
    text_ += ": ";
  }

  std::string take() { return std::move(text_); }

 private:
  template <class Write>
  void nested(char opening, char closing, const Write& write) {
    text_ += opening;
    ++depth_;
    write();
    --depth_;
    if (text_.back() != opening) new_line();
    text_ += closing;
  }
  void next() {
    if (text_.back() != '[' && text_.back() != '{') text_ += ',';
    new_line();
  }
  void new_line() { text_.append(1, '\n').append(2 * depth_, ' '); }

  std::string text_;
  size_t depth_ = 0;
};

/// What a type is in JSON: its value, its schema, its name in the manual.
template <class T>
struct Format;

template <>
struct Format<Text> {
  static void write(Writer& out, const Text& text) { out.scalar(text); }
  static SchemaJson schema() { return nodes::string_schema(); }
  static std::string name() { return "string"; }
};
template <>
struct Format<Boolean> {
  static void write(Writer& out, Boolean value) { out.scalar(value); }
  static SchemaJson schema() { return nodes::boolean_schema(); }
  static std::string name() { return "boolean"; }
};
template <>
struct Format<Integer> {
  static void write(Writer& out, Integer value) { out.scalar(value); }
  static SchemaJson schema() { return {{"type", "integer"}}; }
  static std::string name() { return "integer"; }
};
template <>
struct Format<Real> {
  static void write(Writer& out, Real value) {
    support::assert_that(std::isfinite(value), "a number of a reflection is not finite");
    out.scalar(value);
  }
  static SchemaJson schema() { return nodes::number_schema(); }
  static std::string name() { return "number"; }
};
template <>
struct Format<Float> : Format<Real> {
  static void write(Writer& out, Float value) { out.number(value); }
};
template <>
struct Format<Version> {
  static void write(Writer& out, Version) { out.scalar(Version::number); }
  static SchemaJson schema() { return {{"const", Version::number}}; }
  static std::string name() { return std::to_string(Version::number); }
};

template <class T>
struct Format<Optional<T>> : Format<T> {
  static void write(Writer& out, const Optional<T>& value) { Format<T>::write(out, *value); }
};
template <class T>
struct Format<List<T>> {
  static void write(Writer& out, const List<T>& list) {
    out.array(list, [&](const T& item) { Format<T>::write(out, item); });
  }
  static SchemaJson schema() { return {{"type", "array"}, {"items", Format<T>::schema()}}; }
  static std::string name() { return "list of " + Format<T>::name(); }
};

std::string listed(const std::vector<std::string_view>& words) {
  std::string text;
  for (const std::string_view word : words) text += (text.empty() ? "`" : ", `") + std::string(word) + "`";
  return text;
}

template <std::vector<std::string_view> (*list)()>
struct Format<Word<list>> {
  static void write(Writer& out, const Word<list>& word) {
    support::assert_that(std::ranges::count(list(), word.text) == 1, "no such word: " + word.text);
    out.scalar(word.text);
  }
  static SchemaJson schema() { return nodes::one_of(list()); }
  static std::string name() { return listed(list()); }
};

template <>
struct Format<Value> {
  static void write(Writer& out, const Value& value) {
    const graph::Literal& literal = value.literal;
    switch (literal.kind) {
      case graph::Literal::Kind::boolean: return out.scalar(literal.boolean);
      case graph::Literal::Kind::string: return out.scalar(literal.string);
      case graph::Literal::Kind::number:
        if (value.type == graph::Type::integer) return out.scalar(static_cast<int64_t>(literal.number));
        return out.number(literal.number);
      case graph::Literal::Kind::numbers:
        return out.array(literal.numbers, [&](float component) { out.number(component); });
    }
  }
  static SchemaJson schema() {
    return nodes::any_of({nodes::boolean_schema(), nodes::number_schema(), nodes::string_schema(),
                          nodes::array_schema(nodes::number_schema(), 2, graph::max_literal_numbers)});
  }
  static std::string name() { return "boolean, number, string or list of numbers"; }
};

template <>
struct Format<PassStates> {
  static void write(Writer& out, const PassStates& states) {
    out.object([&] {
      for (const interface::PassStateRow& row : interface::pass_states()) {
        out.key(row.key);
        out.scalar(row.values[row.get(states.state)]);
      }
    });
  }
  static SchemaJson schema() {
    std::vector<SchemaKey> keys;
    for (const interface::PassStateRow& row : interface::pass_states())
      keys.push_back({row.key, nodes::described(nodes::one_of(row.values), row.doc), true});
    return nodes::closed_schema(keys);
  }
  static std::string name() { return "object: the states of the pass in the document"; }
};

struct Choice {
  std::string_view name, doc;
};

/// Of an enumeration of reflection.def; `Table` has its rows.
template <class Enum, class Table>
struct ChoiceFormat {
  static void write(Writer& out, Enum value) { out.scalar(Table::rows[static_cast<size_t>(value)].name); }
  static SchemaJson schema() {
    std::vector<SchemaJson> words;
    for (const Choice& row : Table::rows) words.push_back({{"const", row.name}, {"description", row.doc}});
    return nodes::any_of(std::move(words));
  }
  static std::string name() {
    std::string text;
    for (const Choice& row : Table::rows)
      text += (text.empty() ? "`" : "; `") + std::string(row.name) + "`: " + std::string(row.doc);
    return text;
  }
};

/// Of a record of reflection.def; `Table::visit` calls its argument with each member, key and doc.
template <class Record, class Table>
struct RecordFormat {
  static void write(Writer& out, const Record& record) {
    out.object([&] {
      Table::visit([&]<class T>(T Record::*member, std::string_view key, std::string_view) {
        if constexpr (requires { (record.*member).has_value(); })
          if (!(record.*member).has_value()) return;
        out.key(key);
        Format<T>::write(out, record.*member);
      });
    });
  }
  /// The key of its definition in the schema.
  static std::string id() {
    std::string text(Table::title);
    std::ranges::replace(text, ' ', '_');
    return text;
  }
  static SchemaJson schema() { return nodes::reference(id()); }
  static SchemaJson definition() {
    std::vector<SchemaKey> keys;
    Table::visit([&]<class T>(T Record::*, std::string_view key, std::string_view doc) {
      keys.push_back({key, nodes::described(Format<T>::schema(), doc), !is_optional<T>});
    });
    return nodes::described(nodes::closed_schema(keys), Table::doc);
  }
  static std::string name() { return std::string(Table::title); }
  static std::string table() {
    std::string text =
        "**" + name() + "**: " + std::string(Table::doc) + "\n\n| key | value | |\n|---|---|---|\n";
    Table::visit([&]<class T>(T Record::*, std::string_view key, std::string_view doc) {
      text += "| `" + std::string(key) + "` | " + (is_optional<T> ? "optional: " : "") + Format<T>::name() +
              " | " + std::string(doc) + " |\n";
    });
    return text;
  }

 private:
  template <class T>
  static constexpr bool is_optional = requires(T value) {
    value.has_value();
  };
};

// clang-format off
#define CHOICES(Name)                  \
  struct Name##Table {                 \
    static constexpr Choice rows[] = {
#define CHOICE(name, doc) {#name, doc},
#define END_CHOICES(Name)              \
    };                                 \
  };                                   \
  template <> struct Format<Name> : ChoiceFormat<Name, Name##Table> {};
#define RECORD(Name, heading, about)   \
  struct Name##Table {                 \
    using Record = Name;               \
    static constexpr std::string_view title = heading, doc = about; \
    template <class Visitor> static void visit(Visitor&& visitor) {
#define FIELD(type, member, key, doc) visitor(&Record::member, key, doc);
#define END_RECORD(Name)               \
    }                                  \
  };                                   \
  template <> struct Format<Name> : RecordFormat<Name, Name##Table> {};
// clang-format on
#include "compiler/reflect/reflection.def"

}  // namespace

std::string json(const Reflection& reflection) {
  Writer out;
  Format<Reflection>::write(out, reflection);
  return out.take() + "\n";
}

std::string schema() {
  SchemaJson definitions;
#define RECORD(Name, title, doc) definitions[Format<Name>::id()] = Format<Name>::definition();
#define FIELD(type, member, key, doc)
#define END_RECORD(Name)
#include "compiler/reflect/reflection.def"
  SchemaJson schema{{"$schema", "http://json-schema.org/draft-07/schema#"},
                    {"title", "isoshade reflection"},
                    {"$ref", Format<Reflection>::schema()["$ref"]},
                    {"definitions", std::move(definitions)}};
  return schema.dump(1) + "\n";
}

std::string markdown() {
  std::vector<std::string> tables;
#define RECORD(Name, title, doc) tables.push_back(Format<Name>::table());
#define FIELD(type, member, key, doc)
#define END_RECORD(Name)
#include "compiler/reflect/reflection.def"
  std::string text = "| layout | |\n|---|---|\n";
#define LAYOUT(name, doc) text += "| `" #name "` | " doc " |\n";
  ISOSHADE_LAYOUTS(LAYOUT)
#undef LAYOUT
  // Readers begin with the whole.
  for (auto table = tables.rbegin(); table != tables.rend(); ++table) text += "\n" + *table;
  return text;
}

}  // namespace isoshade::reflect
