// SPDX-License-Identifier: Apache-2.0
// Prints diagnostics: as text for people, as JSON for tools.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "compiler/support/diagnostics.h"
#include "compiler/support/visible.h"

namespace isoshade::support {
namespace {

constexpr size_t window = 160;         // bytes shown of a source line
constexpr size_t before_caret = 60;    // bytes shown before the caret if the line is longer than `window`
constexpr size_t longest_text = 2000;  // bytes shown of a message, note or fix
constexpr std::string_view cut_mark = "...";

/// Colours parts of a text for a terminal, or leaves them plain.
class Paint {
 public:
  explicit Paint(bool colour) : colour_(colour) {}
  std::string operator()(std::string_view code, std::string_view text) const {
    if (!colour_ || text.empty()) return std::string(text);
    return std::string("\x1b[").append(code).append("m").append(text).append("\x1b[0m");
  }

 private:
  bool colour_;
};
constexpr std::string_view bold = "1", red = "1;31", green = "1;32", magenta = "1;35", cyan = "1;36";

std::string limited(std::string_view text) {
  return text.size() > longest_text ? visible(text.substr(0, longest_text)).append(cut_mark) : visible(text);
}

std::string place(const Span& where) {
  if (!where.file) return {};
  const auto [line, column] = where.file->position(where.begin);
  return visible(where.file->path()) + ":" + std::to_string(line) + ":" + std::to_string(column) + ": ";
}

bool continues_character(char byte) { return (static_cast<unsigned char>(byte) & 0xc0) == 0x80; }

/// A source line as printed, and the columns to underline.
struct Shown {
  std::string text;
  size_t caret = 0, carets = 0;
};

/// `begin` and `end` are byte offsets in `line`.
Shown show_line(std::string_view line, size_t begin, size_t end) {
  size_t from = 0, to = line.size();
  if (line.size() > window) {
    from = std::min(begin - std::min(begin, before_caret), line.size() - window);
    to = from + window;
    // A character has at most three continuation bytes; longer runs are not UTF-8 and may be cut anywhere.
    for (int i = 0; i < 3 && from > 0 && continues_character(line[from]); ++i) --from;
    for (int i = 0; i < 3 && to < line.size() && continues_character(line[to]); ++i) ++to;
  }
  Shown shown;
  if (from > 0) shown.text = cut_mark;
  size_t column = shown.text.size();
  shown.caret = column;
  for (size_t at = from; at < to;) {
    Glyph glyph{1, 4};
    if (line[at] == '\t') {
      shown.text.append(4, ' ');
    } else {
      glyph = append_visible(line.substr(at, to - at), shown.text);
    }
    // A span that begins inside a character is underlined from the start of the character.
    if (at + glyph.bytes <= begin) shown.caret += glyph.columns;
    if (at + glyph.bytes > begin && at < end) shown.carets += glyph.columns;
    column += glyph.columns;
    at += glyph.bytes;
  }
  if (to < line.size()) shown.text.append(cut_mark);
  shown.carets = std::max<size_t>(shown.carets, 1);
  return shown;
}

/// The line of `where` and the carets under it, then `fix`.
void print_source(std::string& out, const Span& where, std::string_view fix, const Paint& paint) {
  const SourceFile::Position position = where.file->position(where.begin);
  const std::string_view line = where.file->line(position.line);
  const size_t begin = std::min<size_t>(position.column - 1, line.size());
  const size_t length = where.end > where.begin ? where.end - where.begin : 0;
  const Shown shown = show_line(line, begin, std::min(begin + length, line.size()));
  const std::string number = std::to_string(position.line);
  out.append("  ").append(number).append(" |");
  if (!shown.text.empty()) out.append(" ").append(shown.text);
  out.append("\n").append(number.size() + 2, ' ').append(" | ").append(shown.caret, ' ');
  out.append(paint(green, std::string(shown.carets, '^')));
  if (!fix.empty()) out.append(" ").append(paint(green, fix));
  out.append("\n");
}

void print(std::string& out, const Diagnostic& diagnostic, const Paint& paint) {
  const bool error = diagnostic.severity == Severity::error;
  std::string label = error ? "error[" : "warning[";
  label.append(id_text(diagnostic.id)).append("]:");
  out.append(paint(bold, place(diagnostic.where))).append(paint(error ? red : magenta, label)).append(" ");
  out.append(paint(bold, limited(diagnostic.message))).append("\n");
  const std::string fix = limited(diagnostic.fix);
  if (diagnostic.where.file) {
    print_source(out, diagnostic.where, fix, paint);
  } else if (!fix.empty()) {
    out.append("  ").append(paint(green, fix)).append("\n");
  }
  for (const Note& note : diagnostic.notes) {
    out.append(note.where.file ? paint(bold, place(note.where)) : "  ")
        .append(paint(cyan, "note:"))
        .append(" ");
    out.append(limited(note.message)).append("\n");
    if (note.where.file) print_source(out, note.where, {}, paint);
  }
}

nlohmann::ordered_json place_json(const Span& where) {
  const SourceFile::Position position =
      where.file ? where.file->position(where.begin) : SourceFile::Position{0, 0};
  return {
      {"file", where.file ? where.file->path() : ""}, {"line", position.line}, {"column", position.column}};
}

std::string more(size_t count, size_t limit, std::string_view what) {
  if (count <= limit) return {};
  const size_t hidden = count - limit;
  return std::to_string(hidden) + " more " + std::string(what) + (hidden == 1 ? "" : "s") + " not shown\n";
}

}  // namespace

std::string Diagnostics::text(bool colour) const {
  std::string out;
  for (const Diagnostic& diagnostic : diagnostics_) print(out, diagnostic, Paint(colour));
  return out + more(errors_, limit_, "error") + more(warnings_, limit_, "warning");
}

std::string Diagnostics::json() const {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Diagnostic& diagnostic : diagnostics_) {
    nlohmann::ordered_json entry = {
        {"id", id_text(diagnostic.id)},
        {"severity", diagnostic.severity == Severity::error ? "error" : "warning"}};
    entry.update(place_json(diagnostic.where));
    entry["pointer"] = diagnostic.pointer;
    entry["message"] = diagnostic.message;
    entry["notes"] = nlohmann::ordered_json::array();
    for (const Note& note : diagnostic.notes) {
      nlohmann::ordered_json& added = entry["notes"].emplace_back(place_json(note.where));
      added["message"] = note.message;
    }
    entry["fix"] = diagnostic.fix;
    list.push_back(std::move(entry));
  }
  // ASCII output is as safe for a terminal as text(); bytes that are not UTF-8 become U+FFFD.
  return list.dump(2, ' ', true, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace isoshade::support
