// SPDX-License-Identifier: Apache-2.0
#include "compiler/graph/document.h"

#include <algorithm>

namespace isoshade::graph {
namespace {

constexpr size_t width = 120;
constexpr size_t indent_width = 2;

class Formatter {
 public:
  explicit Formatter(const Document& document) : document_(document) {}

  std::string format() {
    expand(document_.root, 0);
    return std::move(out_) + "\n";
  }

 private:
  std::string_view source() const { return document_.source->text(); }
  std::string_view key(const Member& member) const {
    return source().substr(member.key_begin, member.key_end - member.key_begin);
  }

  /// Appends a value on one line. Returns false, with the line incomplete, if it gets longer than `most`.
  bool append_inline(const Json& json, size_t most, std::string& line) const {
    if (json.kind == Json::Kind::object) {
      line += '{';
      for (const Member& member : json.members) {
        if (&member != &json.members.front()) line += ", ";
        line.append(key(member)).append(": ");
        if (line.size() > most || !append_inline(member.value, most, line)) return false;
      }
      line += '}';
    } else if (json.kind == Json::Kind::array) {
      line += '[';
      for (const Json& item : json.items) {
        if (&item != &json.items.front()) line += ", ";
        if (line.size() > most || !append_inline(item, most, line)) return false;
      }
      line += ']';
    } else {
      line += document_.text(json);
    }
    return line.size() <= most;
  }

  /// `used`: columns before the value on its line; `after`: columns after it.
  void append(const Json& json, size_t depth, size_t used, size_t after, bool inline_allowed) {
    const bool compound = json.kind == Json::Kind::object
                              ? !json.members.empty()
                              : json.kind == Json::Kind::array && !json.items.empty();
    std::string line;
    const size_t room = used + after < width ? width - used - after : 0;
    if (!compound) {
      append_inline(json, std::string::npos, out_);
    } else if (inline_allowed && append_inline(json, room, line)) {
      out_ += line;
    } else {
      expand(json, depth);
    }
  }

  void begin_line(size_t depth) { out_.append(1, '\n').append(indent_width * depth, ' '); }

  void expand(const Json& json, size_t depth) {
    if (json.kind == Json::Kind::object && !json.members.empty()) return expand_object(json, depth);
    if (json.kind == Json::Kind::array && !json.items.empty()) return expand_array(json, depth);
    append_inline(json, std::string::npos, out_);
  }

  void expand_object(const Json& json, size_t depth) {
    out_ += '{';
    uint32_t end_before = 0;
    for (const Member& member : json.members) {
      const bool last = &member == &json.members.back();
      if (end_before != 0) {
        const std::string_view between = source().substr(end_before, member.key_begin - end_before);
        if (std::ranges::count(between, '\n') > 1) out_ += '\n';
      }
      begin_line(depth + 1);
      out_.append(key(member)).append(": ");
      const bool holds_objects =
          depth == 0 && std::ranges::any_of(member.value.members, [](const Member& inner) {
            return inner.value.kind == Json::Kind::object;
          });
      append(member.value, depth + 1, indent_width * (depth + 1) + key(member).size() + 2, last ? 0 : 1,
             !holds_objects);
      if (!last) out_ += ',';
      end_before = member.value.end;
    }
    begin_line(depth);
    out_ += '}';
  }

  void expand_array(const Json& json, size_t depth) {
    out_ += '[';
    for (const Json& item : json.items) {
      const bool last = &item == &json.items.back();
      begin_line(depth + 1);
      append(item, depth + 1, indent_width * (depth + 1), last ? 0 : 1, true);
      if (!last) out_ += ',';
    }
    begin_line(depth);
    out_ += ']';
  }

  const Document& document_;
  std::string out_;
};

}  // namespace

std::string format(const Document& document) { return Formatter(document).format(); }

}  // namespace isoshade::graph
