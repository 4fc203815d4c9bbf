// SPDX-License-Identifier: Apache-2.0
// The files that a reflection lists, and their names.
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <stdlib.h>

#include "compiler/reflect/files.h"
#include "compiler/support/sha256.h"
#include "tests/unit/front_end.h"

namespace isoshade::reflect {
namespace {

namespace fs = std::filesystem;

const std::string half = R"({"isoshade": 1, "function": "half", "inputs": {"x": {"type": "float"}}, "nodes":
  {"h": {"type": "multiply", "in1": "x", "in2": 0.5}}, "outputs": {"out": "h"}})";
const std::string quarter =
    R"({"isoshade": 1, "function": "quarter", "inputs": {"x": {"type": "float"}}, "nodes":
  {"a": {"type": "maths/half", "x": "x"}, "b": {"type": "maths/half", "x": "a"}}, "outputs": {"out": "b"}})";

std::string effect(const std::string& image) {
  return R"({"isoshade": 1, "effect": "e", "parameters": {"p": {"type": "filename", "value": ")" + image +
         R"("}}, "nodes": {"q": {"type": "../shared/quarter.json", "x": 1},
    "t": {"type": "image", "file": {"link": "p"}, "to": "color3"}, "u": {"type": "image", "file": "../textures/none.png"},
    "c": {"type": "multiply", "in1": "t", "in2": "q"}, "d": {"type": "add", "in1": "c", "in2": "u"}},
    "passes": [{"name": "base", "color": "d"}]})";
}

/// A collection with a library beside it.
class ReflectedFiles : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "isoshade_files_XXXXXX").string();
    folder_ = fs::canonical(mkdtemp(pattern.data()));
    before_ = fs::current_path();
    write("mine/isoshade.root", "");
    write("mine/shared/quarter.json", quarter);
    write("mine/textures/t.png", "not decoded");
    write("outside.png", "secret");
    write("library/maths/half.json", half);
    fs::create_directories(folder_ / "mine/effects");
  }
  void TearDown() override {
    fs::current_path(before_);
    fs::remove_all(folder_);
  }

  void write(const std::string& name, const std::string& text) {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }

  /// The files of an effect that reads an image, compiled in a working directory, from which all paths lead.
  std::vector<ReadFile> files(const std::string& image, const std::string& directory = ".",
                              bool allow_outside = false) {
    write("mine/effects/e.json", effect(image));
    fs::current_path(folder_ / directory);
    const fs::path here = fs::current_path();
    FrontEnd front((folder_ / "library").lexically_relative(here).string());
    front.library.allow_outside(allow_outside);
    const auto graph = front.check_file((folder_ / "mine/effects/e.json").lexically_relative(here).string());
    EXPECT_NE(graph, nullptr) << front.diagnostics.text();
    return graph != nullptr ? files_of(*graph, front.library.files()) : std::vector<ReadFile>();
  }

  static std::vector<std::string> names(const std::vector<ReadFile>& files) {
    std::vector<std::string> all;
    for (const ReadFile& file : files) all.push_back(file.file.path);
    return all;
  }

  fs::path folder_, before_;
};

TEST_F(ReflectedFiles, AreTheDocumentItsFunctionsAndItsImages) {
  const std::vector<ReadFile> found = files("../textures/t.png");
  EXPECT_EQ(names(found),
            (std::vector<std::string>{"effects/e.json", "library/maths/half.json", "shared/quarter.json",
                                      "textures/none.png", "textures/t.png"}));
  ASSERT_EQ(found.size(), 5u);
  EXPECT_EQ(found[0].file.sha256, support::sha256(effect("../textures/t.png")));
  EXPECT_EQ(found[1].file.sha256, support::sha256(half));
  EXPECT_EQ(found[2].file.sha256, support::sha256(quarter));
  EXPECT_EQ(found[3].file.sha256, std::nullopt) << "it does not exist";
  EXPECT_EQ(found[4].file.sha256, support::sha256("not decoded"));
  EXPECT_EQ(found[1].file.role, FileRole::function);
  EXPECT_EQ(found[4].file.role, FileRole::image);
}

TEST_F(ReflectedFiles, ListTheDocumentsThatAnEffectExtendsWithTheirFunctionsAndImages) {
  write("mine/bases/b.json", effect("t.png"));
  write("mine/bases/t.png", "of the base");
  write("mine/effects/c.json", R"({"isoshade": 1, "effect": "c", "extends": "../bases/b.json"})");
  write("mine/effects/d.json", R"({"isoshade": 1, "effect": "d", "extends": "c.json"})");
  fs::current_path(folder_);
  FrontEnd front("library");
  const auto graph = front.check_file("mine/effects/d.json");
  ASSERT_NE(graph, nullptr) << front.diagnostics.text();
  const std::vector<ReadFile> found = files_of(*graph, front.library.files());
  EXPECT_EQ(std::vector<std::string>(names(found)).front(), "effects/d.json");
  EXPECT_EQ(found[1].file.path, "bases/b.json");
  EXPECT_EQ(found[1].file.role, FileRole::base);
  EXPECT_EQ(found[2].file.path, "effects/c.json");
  EXPECT_EQ(found[2].file.role, FileRole::base);
  const auto image = std::ranges::find(found, "bases/t.png", [](const ReadFile& file) { return file.file.path; });
  ASSERT_NE(image, found.end());
  EXPECT_EQ(image->file.sha256, support::sha256("of the base"));
}

TEST_F(ReflectedFiles, HaveTheSameNamesInEveryWorkingDirectory) {
  const auto here = names(files("../textures/t.png"));
  for (const char* directory : {"mine", "mine/effects", "library/maths", "mine/textures"})
    EXPECT_EQ(names(files("../textures/t.png", directory)), here) << directory;
}

TEST_F(ReflectedFiles, HavePathsThatOpenThemFromTheWorkingDirectory) {
  for (const ReadFile& file : files("../textures/t.png", "mine/textures"))
    EXPECT_EQ(fs::exists(file.path), file.file.path != "textures/none.png") << file.path;
}

TEST_F(ReflectedFiles, AreNotReadOutsideOfTheCollectionUnlessAllowed) {
  const std::string outside = "../../outside.png";
  EXPECT_EQ(files(outside).back().file.path, "textures/none.png");
  EXPECT_EQ(files(outside)[3].file.path, "../outside.png");
  EXPECT_EQ(files(outside)[3].file.sha256, std::nullopt);
  EXPECT_EQ(files(outside, ".", true)[3].file.sha256, support::sha256("secret"));
}

}  // namespace
}  // namespace isoshade::reflect
