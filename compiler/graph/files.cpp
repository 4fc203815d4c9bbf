// SPDX-License-Identifier: Apache-2.0
#include "compiler/graph/files.h"

#include <filesystem>

#include "compiler/graph/document.h"
#include "compiler/support/visible.h"

namespace isoshade::graph {

namespace fs = std::filesystem;

std::string canonical_path(const std::string& path) {
  std::error_code error;
  const fs::path absolute = fs::absolute(path.empty() ? "." : path, error);
  const fs::path found = fs::weakly_canonical(absolute, error);
  return (error ? absolute.lexically_normal() : found).string();
}

std::string path_beside(const std::string& document_path, const std::string& path) {
  const fs::path given(path);
  if (given.is_absolute()) return path;
  return (fs::path(document_path).parent_path() / given).lexically_normal().string();
}

bool is_within(const std::string& path, const std::string& folder) {
  if (folder.empty() || !path.starts_with(folder)) return false;
  return folder.back() == '/' || path.size() == folder.size() || path[folder.size()] == '/';
}

std::string home_of(const std::string& document_path, const FileRule& rule) {
  const fs::path own = fs::path(canonical_path(document_path)).parent_path();
  for (fs::path folder = own;; folder = folder.parent_path()) {
    std::error_code error;
    const fs::path marker = folder / collection_marker;
    if (rule.memory.contains(marker.string()) || fs::is_regular_file(marker, error)) return folder.string();
    if (folder == folder.parent_path()) return own.string();
  }
}

support::Source read_document(const std::string& path, const FileRule& rule,
                              support::Diagnostics& diagnostics, const support::Span& where) {
  if (!rule.memory.empty()) {
    const auto found = rule.memory.find(canonical_path(path));
    if (found != rule.memory.end()) return found->second;
  }
  return read_source(path, diagnostics, where);
}

std::string name_in_collection(const std::string& canonical, const std::string& home, const FileRule& rule) {
  const bool in_library = is_within(canonical, rule.library);
  const fs::path name = fs::path(canonical).lexically_relative(in_library ? rule.library : home);
  return ((in_library ? "library" : "") / name).string();
}

bool may_read(const std::string& path, const support::Span& where, const FileRule& rule,
              support::Diagnostics& diagnostics) {
  const support::Source& source = where.file;
  if (source == nullptr || source->origin() == support::SourceFile::Origin::argument ||
      rule.permits(canonical_path(path), home_of(source->path(), rule))) {
    return true;
  }
  diagnostics
      .report(support::Id::outside_reference, where, support::quote(path) + " is outside of the folder tree")
      .note(std::string(reference_rule));
  return false;
}

}  // namespace isoshade::graph
