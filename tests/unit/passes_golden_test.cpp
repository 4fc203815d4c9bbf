// SPDX-License-Identifier: Apache-2.0
// Text in, text out: tests/golden/<pass>/*.ir hold a module and what the pass makes of it, in canonical order.
// `passes_test --update` writes what the passes make now.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <sstream>

#include "compiler/ir/printer.h"
#include "compiler/passes/passes.h"
#include "tests/unit/ir_text.h"

namespace isoshade::passes {
namespace {

namespace fs = std::filesystem;

bool update = false;
const std::string separator = "\n# becomes\n\n";

void drop_unreached(ir::Module& module) {
  std::vector<uint32_t> entries{module.find("main")};
  dce(module, entries);
}

// What each folder of goldens tests.
const std::map<std::string, void (*)(ir::Module&)> passes{
    {"renumber", renumber},
    {"dce", drop_unreached},
    {"derivatives", derivatives},
    {"cse", cse},
    {"decide", [](ir::Module& module) { decide(module, functions::Tier::standard); }},
    {"fold", [](ir::Module& module) { fold(module); }},
    {"hide_foldables", [](ir::Module& module) { hide_foldables(module, {}); }},
    {"sink", [](ir::Module& module) { sink(module, {4, 2}); }},
    {"specialize",
     [](ir::Module& module) {
       specialize(module);
       drop_unreached(module);
     }},
};

void check(const fs::path& path, void (*pass)(ir::Module&)) {
  SCOPED_TRACE(path.string());
  std::ifstream file(path);
  const std::string text = (std::stringstream() << file.rdbuf()).str();
  const std::string before = text.substr(0, text.find(separator));
  ir::Module module = ir::valid(before);
  pass(module);
  EXPECT_EQ(ir::validate(module), "");
  renumber(module);
  const std::string expected = before + separator + ir::print(module);
  if (update) {
    if (text != expected) std::ofstream(path) << expected;
  } else {
    EXPECT_EQ(text, expected);
  }
}

TEST(PassesGolden, EveryPassMatchesItsGoldens) {
  const fs::path root = fs::path(ISOSHADE_SOURCE_DIR) / "tests/golden";
  for (const auto& [name, pass] : passes) {
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(root / name))
      files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    EXPECT_FALSE(files.empty()) << name;
    for (const fs::path& file : files) check(file, pass);
  }
}

}  // namespace
}  // namespace isoshade::passes

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  isoshade::passes::update = argc > 1 && std::string_view(argv[1]) == "--update";
  return RUN_ALL_TESTS();
}
