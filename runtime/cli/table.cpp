// SPDX-License-Identifier: Apache-2.0
#include "runtime/cli/table.h"

#include <algorithm>
#include <bit>
#include <charconv>

#include "compiler/support/parse_number.h"

namespace isoshade::cli {

namespace {

enum class Cell : uint8_t { floating, integer, boolean };

Cell cell_of(const driver::Field& field) {
  if (field.type == "integer") return Cell::integer;
  return field.type == "boolean" ? Cell::boolean : Cell::floating;
}

std::optional<int32_t> parse_cell(std::string_view text, Cell cell) {
  if (cell == Cell::floating) {
    const auto value = support::parse_float_in_range(text);
    return value ? std::optional(std::bit_cast<int32_t>(*value)) : std::nullopt;
  }
  int32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (cell == Cell::boolean && value != 0 && value != 1) return std::nullopt;
  return value;
}

std::string_view trimmed(std::string_view text) {
  const size_t begin = text.find_first_not_of(" \t\r\"");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r\"") - begin + 1);
}

/// Reads the lines of a CSV text and their cells, and reports errors at their positions.
class Reader {
 public:
  Reader(const support::Source& source, support::Diagnostics& diagnostics)
      : source_(source), text_(source->text()), diagnostics_(diagnostics) {
    if (text_.starts_with("\xef\xbb\xbf")) at_ = 3;  // spreadsheets write a byte order mark
  }

  bool next_line() {
    while (at_ < text_.size()) {
      size_t end = text_.find('\n', at_);
      if (end == std::string_view::npos) end = text_.size();
      line_begin_ = at_;
      line_ = text_.substr(at_, end - at_);
      at_ = end + 1;
      if (!trimmed(line_).empty()) return true;
    }
    return false;
  }

  std::vector<std::string_view> cells() const {
    std::vector<std::string_view> cells;
    size_t begin = 0;
    while (true) {
      const size_t comma = line_.find(',', begin);
      cells.push_back(trimmed(line_.substr(begin, comma == std::string_view::npos ? comma : comma - begin)));
      if (comma == std::string_view::npos) return cells;
      begin = comma + 1;
    }
  }

  support::Diagnostic& report(std::string_view cell, std::string message) {
    const auto begin = static_cast<uint32_t>(cell.empty() ? line_begin_ : cell.data() - text_.data());
    const auto size = static_cast<uint32_t>(cell.empty() ? line_.size() : cell.size());
    return diagnostics_.report(support::Id::bad_table, {source_, begin, begin + size}, std::move(message));
  }

 private:
  const support::Source& source_;
  std::string_view text_;
  support::Diagnostics& diagnostics_;
  size_t at_ = 0;
  size_t line_begin_ = 0;
  std::string_view line_;
};

struct Column {
  std::string name;
  size_t word;
  Cell cell;
};

std::vector<Column> all_columns(const std::vector<driver::Field>& fields) {
  std::vector<Column> columns;
  for (const driver::Field& field : fields)
    for (const std::string& name : columns_of(field))
      columns.push_back({name, columns.size(), cell_of(field)});
  return columns;
}

/// The names separated by commas, at most 16 of them.
std::string joined(const std::vector<std::string_view>& names) {
  constexpr size_t most = 16;
  std::string text;
  for (size_t i = 0; i < names.size() && i < most; ++i) text += (i == 0 ? "" : ",") + std::string(names[i]);
  return names.size() > most ? text + ",..." : text;
}

/// "c.y" for "c.g": columns are named by x y z w.
std::string column_name(std::string_view cell) {
  std::string name(cell);
  if (name.size() < 3 || name[name.size() - 2] != '.') return name;
  if (const size_t component = std::string_view("rgba").find(name.back());
      component != std::string_view::npos)
    name.back() = "xyzw"[component];
  return name;
}

/// The column that each cell of the heading names.
std::optional<std::vector<const Column*>> read_heading(Reader& reader, const std::vector<Column>& columns) {
  std::vector<const Column*> heading;
  std::vector<std::string_view> names;
  for (const Column& column : columns) names.push_back(column.name);
  bool good = true;
  for (std::string_view cell : reader.cells()) {
    const auto found = std::ranges::find(columns, column_name(cell), &Column::name);
    if (found == columns.end()) {
      auto& report = reader.report(cell, "no input has a column \"" + std::string(cell) + "\"");
      if (const auto near = support::nearest(cell, names); !near.empty())
        report.suggest("did you mean \"" + std::string(near) + "\"?");
      else
        report.note("the columns are " + joined(names));
      good = false;
    } else if (std::ranges::find(heading, &*found) != heading.end()) {
      reader.report(cell, "the column \"" + std::string(cell) + "\" occurs twice");
      good = false;
    } else {
      heading.push_back(&*found);
    }
  }
  for (const Column& column : columns) {
    if (!good || std::ranges::find(heading, &column) != heading.end()) continue;
    reader.report({}, "there is no column \"" + column.name + "\"").note("the columns are " + joined(names));
    good = false;
  }
  return good ? std::optional(std::move(heading)) : std::nullopt;
}

}  // namespace

std::vector<std::string> columns_of(const driver::Field& field) {
  if (field.words == 1) return {field.name};
  std::vector<std::string> columns;
  for (int i = 0; i < field.words; ++i)
    columns.push_back(field.name + "." + (field.words <= 4 ? std::string(1, "xyzw"[i]) : std::to_string(i)));
  return columns;
}

std::optional<Table> read_table(const support::Source& source, const std::vector<driver::Field>& fields,
                                support::Diagnostics& diagnostics) {
  Reader reader(source, diagnostics);
  if (!reader.next_line()) {
    diagnostics.report(support::Id::bad_table, {source, 0, 0}, "the table is empty")
        .suggest("the first line must name the columns");
    return std::nullopt;
  }
  const std::vector<Column> columns = all_columns(fields);
  const auto heading = read_heading(reader, columns);
  if (!heading) return std::nullopt;
  Table table;
  while (reader.next_line()) {
    const std::vector<std::string_view> cells = reader.cells();
    if (cells.size() != heading->size()) {
      reader.report({}, "this row has " + std::to_string(cells.size()) +
                            (cells.size() == 1 ? " cell" : " cells") + ", but there are " +
                            std::to_string(heading->size()) + " columns");
      return std::nullopt;
    }
    table.words.resize(table.words.size() + columns.size());
    for (size_t i = 0; i < cells.size(); ++i) {
      const Column& column = *(*heading)[i];
      const auto value = parse_cell(cells[i], column.cell);
      if (!value) {
        constexpr std::string_view kinds[] = {"a float", "an integer", "a boolean, 0 or 1"};
        auto& report = reader.report(cells[i], "\"" + std::string(cells[i].substr(0, 40)) + "\" is not " +
                                                   std::string(kinds[static_cast<size_t>(column.cell)]));
        if (column.cell == Cell::floating && support::parse_float(cells[i]))
          report.suggest("it is outside the range of float; write infinities as inf and -inf");
        return std::nullopt;
      }
      table.words[table.rows * columns.size() + column.word] = *value;
    }
    ++table.rows;
  }
  return table;
}

namespace {

/// `cell` returns the text of a word of the table.
template <class CellText>
std::string write_cells(size_t rows, const std::vector<Column>& columns, CellText cell) {
  std::string text;
  for (const Column& column : columns) text += (column.word == 0 ? "" : ",") + column.name;
  text += "\n";
  for (size_t row = 0; row < rows; ++row) {
    for (const Column& column : columns)
      text += (column.word == 0 ? "" : ",") + cell(row * columns.size() + column.word, column.cell);
    text += "\n";
  }
  return text;
}

}  // namespace

std::string write_table(const Table& table, const std::vector<driver::Field>& fields) {
  return write_cells(table.rows, all_columns(fields), [&](size_t at, Cell cell) {
    const int32_t word = table.words[at];
    return cell == Cell::floating ? support::format_hex_float(std::bit_cast<float>(word))
                                  : std::to_string(word);
  });
}

std::string write_table(std::span<const reference::Real> numbers, size_t rows,
                        const std::vector<driver::Field>& fields) {
  return write_cells(rows, all_columns(fields), [&](size_t at, Cell) { return numbers[at].text(40); });
}

}  // namespace isoshade::cli
