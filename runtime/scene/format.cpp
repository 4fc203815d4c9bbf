// SPDX-License-Identifier: Apache-2.0
// The rows of format.def, and the tables of the manual.
#include "runtime/scene/format.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "compiler/support/parse_number.h"

namespace isoshade::scene::format {
namespace {

constexpr ObjectRow object_rows[] = {
#define OBJECT(name, forms, shorthand, doc) {Object::name, #name, forms, shorthand, doc},
#include "runtime/scene/format.def"
};

const KeyRow key_rows[] = {
#define KEY(object, identifier, key, need, type, forms, doc) {Object::object, key, need, type, forms, doc},
#include "runtime/scene/format.def"
};

/// Whole numbers have no fraction.
std::string number_text(double number) {
  if (std::abs(number) < 1e6 && number == std::floor(number))
    return std::to_string(static_cast<int64_t>(number));
  std::string text = support::format_float(static_cast<float>(number));
  // "1e9", not "1e+09"
  if (const size_t e = text.find('e'); e != std::string::npos) {
    const bool negative = text[e + 1] == '-';
    const size_t digits = text.find_first_not_of("+-0", e + 1);
    text = text.substr(0, e + 1) + (negative ? "-" : "") + text.substr(digits);
  }
  return text;
}

template <class Values>
std::string list_text(const Values& values) {
  std::string text;
  for (const auto value : values)
    text += (text.empty() ? "[" : ", ") + number_text(static_cast<double>(value));
  return text + "]";
}

std::string words_text(std::span<const std::string_view> words) {
  std::string text;
  for (const std::string_view word : words)
    text += (text.empty() ? "`\"" : ", `\"") + std::string(word) + "\"`";
  return text;
}

/// The name of an object in the manual.
std::string title(Object object) {
  std::string text(row_of(object).name);
  std::ranges::replace(text, '_', ' ');
  return text;
}

std::string range_text(const Range& range) {
  return number_text(range.low) + " to " + number_text(range.high);
}

/// What a key takes. A type without an overload does not compile.
struct ValueText {
  std::string operator()(const Boolean&) const { return "true or false"; }
  std::string operator()(const Integer& t) const { return "integer, " + range_text(t.range); }
  std::string operator()(const Number& t) const { return "number, " + range_text(t.range); }
  template <size_t N>
  std::string operator()(const Numbers<N>& t) const {
    return std::to_string(N) + " numbers, each " + range_text(t.range);
  }
  std::string operator()(const Size& t) const { return "2 integers, each " + range_text(t.range); }
  std::string operator()(const Samples& t) const {
    std::string text;
    for (const int value : t.values) text += (text.empty() ? "" : ", ") + std::to_string(value);
    return text;
  }
  std::string operator()(const Scale& t) const { return "1 or 3 numbers, each " + range_text(t.range); }
  std::string operator()(const Rotation& t) const {
    return "3 numbers, each " + range_text(t.range) + ", or 4";
  }
  std::string operator()(const Choice& t) const { return words_text(t.words); }
  std::string operator()(const Name&) const { return "name"; }
  std::string operator()(const Path&) const { return "path, relative to the file that contains it"; }
  std::string operator()(const Literal&) const { return "number or list of numbers"; }
  std::string operator()(const Literals&) const { return "list of values"; }
  std::string operator()(const MapOfLiterals&) const { return "object: name to value"; }
  std::string operator()(const MapOfNames&) const { return "object: name to name"; }
  std::string operator()(const Keyframes&) const { return "list of [number, value]"; }
  std::string operator()(const MapOfPaths& t) const { return "object: path to " + title(t.object); }
  std::string operator()(const ObjectOf& t) const { return title(t.object); }
  std::string operator()(const MapOf& t) const {
    const std::string most = t.most == no_limit ? "" : ", at most " + std::to_string(t.most);
    return "object: name to " + title(t.object) + most;
  }
  std::string operator()(const ListOf& t) const {
    return "list of " + title(t.object) + ", " + std::to_string(t.least) + " to " + std::to_string(t.most);
  }
};

template <class T>
concept WithoutDefault = !requires(T type) {
  type.fallback;
};

/// The default of a key; empty if it has none. A type that has a default does not compile without an overload.
struct DefaultText {
  std::string operator()(const Boolean& t) const {
    return t.fallback ? (*t.fallback ? "true" : "false") : "";
  }
  std::string operator()(const Integer& t) const { return t.fallback ? std::to_string(*t.fallback) : ""; }
  std::string operator()(const Number& t) const { return t.fallback ? number_text(*t.fallback) : ""; }
  template <size_t N>
  std::string operator()(const Numbers<N>& t) const {
    return t.fallback ? list_text(*t.fallback) : "";
  }
  std::string operator()(const Size& t) const { return list_text(t.fallback); }
  std::string operator()(const Samples& t) const { return std::to_string(t.fallback); }
  std::string operator()(const Scale&) const { return "1"; }
  std::string operator()(const Rotation&) const { return "[0, 0, 0]"; }
  std::string operator()(const Choice& t) const {
    return t.fallback ? words_text(t.words.subspan(*t.fallback, 1)) : "";
  }
  template <WithoutDefault T>
  std::string operator()(const T&) const {
    return "";
  }
};

/// "sphere, cone" of an object with forms; empty if all have the key.
std::string forms_text(const ObjectRow& object, Forms forms) {
  std::string text;
  size_t count = 0;
  for (size_t i = 0; i < object.forms.size(); ++i) {
    if ((forms & of(i)) == 0) continue;
    text.append(text.empty() ? "" : ", ").append(object.forms[i]);
    ++count;
  }
  return count == object.forms.size() ? "" : text;
}

}  // namespace

std::span<const ObjectRow> objects() { return object_rows; }

const ObjectRow& row_of(Object object) { return object_rows[static_cast<size_t>(object)]; }

std::vector<const KeyRow*> keys_of(Object object, Forms forms) {
  std::vector<const KeyRow*> keys;
  for (const KeyRow& row : key_rows)
    if (row.object == object && (row.forms & forms) != 0) keys.push_back(&row);
  return keys;
}

std::vector<std::string_view> object_keys_of_scene() {
  std::vector<std::string_view> keys;
  for (const KeyRow* row : keys_of(Object::scene))
    if (std::holds_alternative<ObjectOf>(row->type)) keys.push_back(row->name);
  return keys;
}

std::vector<std::string_view> plain_keys_of_scene() {
  const auto is_plain = []<class T>(const T&) {
    return !(std::is_same_v<T, Name> || std::is_same_v<T, Path> || std::is_same_v<T, ObjectOf> ||
             std::is_same_v<T, MapOf> || std::is_same_v<T, MapOfPaths> || std::is_same_v<T, ListOf>);
  };
  std::vector<std::string_view> keys;
  for (const KeyRow* row : keys_of(Object::scene))
    if (std::visit(is_plain, row->type)) keys.push_back(row->name);
  return keys;
}

std::string markdown() {
  std::string text;
  for (const ObjectRow& object : object_rows) {
    text += (text.empty() ? "**" : "\n**") + title(object.object) + "**" +
            (object.doc.empty() ? "" : ": " + std::string(object.doc)) +
            "\n\n| key | value | default | |\n|---|---|---|---|\n";
    for (const KeyRow* key : keys_of(object.object)) {
      const std::string forms = forms_text(object, key->forms);
      std::string doc(key->doc);
      if (!forms.empty()) doc = forms + (doc.empty() ? "" : ": " + doc);
      text += "| `" + std::string(key->name) + "` | " + std::visit(ValueText{}, key->type) + " | " +
              (key->required ? "required" : std::visit(DefaultText{}, key->type)) + " | " + doc + " |\n";
    }
  }
  return text;
}

}  // namespace isoshade::scene::format
