// SPDX-License-Identifier: Apache-2.0
// The layering of DESIGN: a folder is a target, its links say which folders it may include, and no two need
// each other. Read from the CMakeLists.txt and the sources, because a compiler finds any header.
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <regex>
#include <set>
#include <sstream>

namespace isoshade {
namespace {

namespace fs = std::filesystem;

const fs::path root = ISOSHADE_SOURCE_DIR;

std::string read(const fs::path& path) {
  std::ifstream file(path);
  return (std::stringstream() << file.rdbuf()).str();
}

std::vector<std::string> matches(const std::string& text, const char* pattern) {
  const std::regex regex(pattern);
  std::vector<std::string> found;
  for (std::sregex_iterator at(text.begin(), text.end(), regex), end; at != end; ++at)
    found.push_back((*at)[1]);
  return found;
}

struct Library {
  std::string folder;           ///< "compiler/graph"
  std::set<std::string> links;  ///< names of libraries of ours: "support"
};

/// By name, from every isoshade_library(...) of the tree.
std::map<std::string, Library> libraries() {
  std::map<std::string, Library> all;
  for (const char* top : {"compiler", "runtime", "backends"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / top)) {
      if (entry.path().filename() != "CMakeLists.txt") continue;
      const std::string text = read(entry.path());
      for (const std::string& call : matches(text, R"(isoshade_(?:shared_)?library\(([^)]*)\))")) {
        const std::string name = matches(call, R"(^\s*(\w+))").at(0);
        const std::vector<std::string> links = matches(call, R"(\bisoshade_(\w+))");
        all[name] = {fs::relative(entry.path().parent_path(), root).string(), {links.begin(), links.end()}};
      }
      // Links that only some builds have are added afterwards.
      for (const std::string& call : matches(text, R"(target_link_libraries\(isoshade_([^)]*)\))")) {
        const std::string name = matches(call, R"(^(\w+))").at(0);
        for (const std::string& link : matches(call, R"(\bisoshade_(\w+))")) all[name].links.insert(link);
      }
    }
  }
  return all;
}

/// The library and all that it links, directly or not.
std::set<std::string> reachable(const std::map<std::string, Library>& all, const std::string& name) {
  std::set<std::string> seen;
  std::vector<std::string> open = {name};
  while (!open.empty()) {
    const std::string next = open.back();
    open.pop_back();
    const auto found = all.find(next);
    if (found == all.end() || !seen.insert(next).second) continue;
    open.insert(open.end(), found->second.links.begin(), found->second.links.end());
  }
  return seen;
}

TEST(Layering, LibrariesHaveNoDependencyCycle) {
  const std::map<std::string, Library> all = libraries();
  ASSERT_TRUE(all.count("support") && all.count("graph"));
  for (const auto& [name, library] : all) {
    for (const std::string& link : library.links) {
      EXPECT_EQ(reachable(all, link).count(name), 0u)
          << name << " links " << link << ", which needs " << name;
    }
  }
}

TEST(Layering, FoldersIncludeOnlyWhatTheyLink) {
  const std::map<std::string, Library> all = libraries();
  size_t includes = 0;
  for (const auto& [name, library] : all) {
    std::set<std::string> allowed;
    for (const std::string& other : reachable(all, name)) allowed.insert(all.at(other).folder);
    for (const fs::directory_entry& entry : fs::directory_iterator(root / library.folder)) {
      const std::string extension = entry.path().extension();
      if (extension != ".h" && extension != ".cpp" && extension != ".def") continue;
      for (const std::string& header :
           matches(read(entry.path()), R"re((?:^|\n)\s*#\s*include\s+"([^"]*)")re")) {
        ++includes;
        const std::string folder = fs::path(header).parent_path().string();
        if (folder.empty() && header.ends_with(".inc")) continue;  // made beside the folder's objects
        if (name == "lanes" && folder.empty()) continue;           // a folder that is copied as a whole
        if (header == "compiler/targets/targets.def") continue;  // data of languages, whose code links what reads it
        EXPECT_TRUE(allowed.count(folder))
            << entry.path() << " includes " << header << ", which isoshade_" << name << " does not link";
      }
    }
  }
  EXPECT_GT(includes, 20u);
}

}  // namespace
}  // namespace isoshade
