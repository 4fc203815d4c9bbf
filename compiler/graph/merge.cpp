// SPDX-License-Identifier: Apache-2.0
#include "compiler/graph/document.h"

#include <algorithm>
#include <iterator>
#include <unordered_map>
#include <utility>

#include "compiler/support/visible.h"

namespace isoshade::graph {
namespace {

bool is_null(const Member& member) { return member.value.kind == Json::Kind::null; }

/// Merges values of a base, which have sources from 1, and changes, which have source 0.
class Merger {
 public:
  Merger(const Document& changes, support::Diagnostics& diagnostics)
      : changes_(changes), diagnostics_(diagnostics) {}

  void merge(Json& base, Json changes) {
    const bool both = base.kind == Json::Kind::object && changes.kind == Json::Kind::object;
    const Json* type = changes.find("type");
    if (!both || (type != nullptr && type->kind == Json::Kind::string)) {
      base = without_nulls(std::move(changes));
      return;
    }
    std::unordered_map<std::string_view, Member*> known;
    for (Member& member : base.members) known.emplace(member.key, &member);
    std::vector<Member> added;
    for (Member& change : changes.members) {
      const auto found = known.find(change.key);
      if (found != known.end()) {
        Member& member = *found->second;
        member.key_begin = change.key_begin;
        member.key_end = change.key_end;
        const Extras extras(*this, change.key);
        merge(member.value, std::move(change.value));
      } else if (is_null(change)) {
        report_nothing_removed(change, base);
      } else {
        const Extras extras(*this, change.key);
        change.value = without_nulls(std::move(change.value));
        added.push_back(std::move(change));
      }
    }
    std::erase_if(base.members,
                  [](const Member& member) { return is_null(member) && member.value.source == 0; });
    std::ranges::move(added, std::back_inserter(base.members));
    base.source = changes.source;
    base.begin = changes.begin;
    base.end = changes.end;
  }

 private:
  /// Sets extras_ during its lifetime if the key is "extras".
  class Extras {
   public:
    Extras(Merger& merger, std::string_view key) : extras_(merger.extras_), before_(extras_) {
      extras_ = extras_ || key == "extras";
    }
    ~Extras() { extras_ = before_; }

   private:
    bool& extras_;
    bool before_;
  };

  void report_nothing_removed(const Member& change, const Json& base) {
    if (extras_ || diagnostics_.full()) return;
    std::vector<std::string_view> keys;
    for (const Member& member : base.members) keys.push_back(member.key);
    diagnostics_.report_unknown(support::Id::unknown_key, changes_.key_span(change),
                                "there is no " + support::quote(change.key) + " to remove", change.key, keys);
  }

  /// Removes nulls from a new value, and reports them: there is nothing to remove.
  Json without_nulls(Json value) {
    for (Member& member : value.members) {
      if (is_null(member)) report_nothing_removed(member, Json{});
      const Extras extras(*this, member.key);
      member.value = without_nulls(std::move(member.value));
    }
    std::erase_if(value.members, is_null);
    return value;
  }

  const Document& changes_;
  support::Diagnostics& diagnostics_;
  bool extras_ = false;
};

/// Adds `by` to the source index of the value and of all values in it.
void renumber(Json& value, uint32_t by) {
  value.source += by;
  for (Json& item : value.items) renumber(item, by);
  for (Member& member : value.members) renumber(member.value, by);
}

}  // namespace

Json adopt(Document& document, support::Source source, Json value) {
  document.others.push_back(std::move(source));
  renumber(value, static_cast<uint32_t>(document.others.size()));
  return value;
}

Document merge(Document base, Document changes, support::Diagnostics& diagnostics) {
  Json root = adopt(changes, base.source, std::move(base.root));
  changes.others.insert(changes.others.end(), base.others.begin(), base.others.end());
  Merger(changes, diagnostics).merge(root, std::move(changes.root));
  return {std::move(changes.source), std::move(root), std::move(changes.others)};
}

}  // namespace isoshade::graph
