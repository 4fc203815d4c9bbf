// SPDX-License-Identifier: Apache-2.0
#include "compiler/support/diagnostics.h"

#include <algorithm>
#include <cctype>
#include <numeric>

#include "compiler/support/visible.h"

namespace isoshade::support {
namespace {

struct Row {
  std::string_view id;
  Severity severity;
  std::string_view meaning;
};

constexpr Row rows[] = {
#define DIAGNOSTIC(name, id, severity, meaning) {id, Severity::severity, meaning},
#include "compiler/support/diagnostics.def"
#undef DIAGNOSTIC
};

const Row& row(Id id) { return rows[static_cast<size_t>(id)]; }

std::string folded(std::string_view word) {
  std::string out;
  for (const unsigned char c : word) {
    if (c != '_' && c != '-') out += static_cast<char>(std::tolower(c));
  }
  return out;
}

/// The number of edits (insert, delete, replace, swap of neighbours) from `a` to `b`, or limit + 1 if more.
size_t edit_distance(std::string_view a, std::string_view b, size_t limit) {
  if (std::max(a.size(), b.size()) - std::min(a.size(), b.size()) > limit) return limit + 1;
  std::vector<size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), 0);
  for (size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
    if (*std::min_element(row.begin(), row.end()) > limit) return limit + 1;
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

}  // namespace

std::string_view id_text(Id id) { return row(id).id; }
Severity default_severity(Id id) { return row(id).severity; }
std::string_view meaning(Id id) { return row(id).meaning; }

std::vector<Id> all_ids() {
  std::vector<Id> ids;
  for (size_t i = 0; i < std::size(rows); ++i) ids.push_back(static_cast<Id>(i));
  return ids;
}

Diagnostic& Diagnostic::note(Span where, std::string message) {
  notes.push_back({std::move(where), std::move(message)});
  return *this;
}

Diagnostic& Diagnostic::note(std::string message) { return note(Span{}, std::move(message)); }

Diagnostic& Diagnostic::suggest(std::string fix) {
  this->fix = std::move(fix);
  return *this;
}

Diagnostic& Diagnostic::at(std::string json_pointer) {
  pointer = std::move(json_pointer);
  return *this;
}

Diagnostic& Diagnostics::report(Id id, Span where, std::string message) {
  Severity severity = default_severity(id);
  Diagnostic diagnostic{id, severity, std::move(where), std::move(message), {}, {}, {}};
  if (severity == Severity::warning) {
    const bool disabled = std::find(disabled_.begin(), disabled_.end(), id) != disabled_.end();
    if (disabled) return dropped_ = std::move(diagnostic);
    if (warnings_as_errors_) diagnostic.severity = severity = Severity::error;
  }
  size_t& count = severity == Severity::error ? errors_ : warnings_;
  if (++count > limit_) return dropped_ = std::move(diagnostic);
  return diagnostics_.emplace_back(std::move(diagnostic));
}

Diagnostic& Diagnostics::report_unknown(Id id, Span where, std::string message, std::string_view word,
                                        const std::vector<std::string_view>& candidates) {
  const bool is_read = !full();
  Diagnostic& diagnostic = report(id, std::move(where), std::move(message));
  const std::string_view near = is_read ? nearest(word, candidates) : std::string_view{};
  return near.empty() ? diagnostic : diagnostic.suggest("did you mean " + quote(near) + "?");
}

std::string_view nearest(std::string_view word, const std::vector<std::string_view>& candidates) {
  constexpr size_t longest = 64;
  size_t budget = 4'000'000;  // cells of the distance table: about 10 ms
  if (word.empty() || word.size() > longest) return {};
  const std::string wanted = folded(word);
  size_t limit = std::max<size_t>(1, word.size() / 3);
  std::string_view best;
  for (const std::string_view candidate : candidates) {
    const size_t cells = 16 + wanted.size() * std::min(candidate.size(), longest);
    if (budget < cells) break;
    budget -= cells;
    if (candidate.empty() || candidate.size() > longest) continue;
    const size_t distance = edit_distance(wanted, folded(candidate), limit);
    if (distance > limit || (distance == limit && !best.empty())) continue;
    // If every character changes, the words are not similar.
    if (distance >= std::max(wanted.size(), size_t{1})) continue;
    best = candidate;
    limit = distance;
    if (distance == 0) break;
  }
  return best;
}

}  // namespace isoshade::support
