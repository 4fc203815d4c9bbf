// SPDX-License-Identifier: Apache-2.0
//
// Effects as a program takes them: three that are shipped, with lights and images, written by `isoshade compile` and linked
// into one program (tests/portable/effects).
#include <cstdlib>

#include "tests/unit/command.h"

namespace isoshade::testing {
namespace {

const std::string sources = ISOSHADE_ROOT "/tests/portable/effects/";

class Effects : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    for (const char* effect : {"materials/cook_torrance", "effects/cartoon", "materials/gltf_pbr"}) {
      const Outcome outcome =
          run("compile " + graphs + "/" + effect + ".json --target glsl,cpp -o " + file("effects"));
      ASSERT_EQ(outcome.exit, 0) << outcome.text;
    }
  }

  /// The colours that the program writes, built with no flag that fixes bits: the headers must suffice.
  std::string colors(const std::string& compiler, const std::string& files,
                     const std::string& runner = "") const {
    std::string command =
        compiler + " -std=c++20 -O2 -Wall -Wextra -Werror -I " + file("effects") + " -o " + file("program");
    for (const char* name : {"main", "cook_torrance", "cartoon", "gltf_pbr", "all"})
      if (files.find(name) != std::string::npos) command += " " + sources + name + ".cpp";
    for (const std::string& line : {command, runner + " " + file("program") + " " + file("colors")}) {
      const Outcome outcome = run_command(line);
      EXPECT_EQ(outcome.exit, 0) << line << "\n" << outcome.text;
    }
    return read(file("colors"));
  }

  static bool is_missing(const std::string& program) {
    return run_command("command -v " + program).exit != 0;
  }
};

constexpr const char* in_one = "main all";
constexpr const char* in_three = "main cook_torrance cartoon gltf_pbr";

TEST_F(Effects, GiveTheSameBitsInOneTranslationUnitAndInThreeAndInLanes) {
  const std::string expected = colors("g++", in_one);
  ASSERT_EQ(expected.size(), 3u * 64 * 64 * 4 * 4);
  EXPECT_EQ(colors("g++", in_three), expected);
  EXPECT_EQ(colors("g++ -DISOSHADE_LANES=4", in_one), expected);
  EXPECT_EQ(colors("clang++", in_three), expected);
  if (is_missing("aarch64-linux-gnu-g++") || is_missing("qemu-aarch64"))
    GTEST_SKIP() << "there is no aarch64-linux-gnu-g++ or no qemu-aarch64; scripts/setup.sh installs them";
  // No product of these points falls just below the least normal float (see float_rules.h).
  EXPECT_EQ(colors("aarch64-linux-gnu-g++", in_three, "qemu-aarch64 -L /usr/aarch64-linux-gnu"), expected);
}

TEST_F(Effects, GlslOfAllIsIncludedInOneShader) {
  const Outcome outcome =
      run_command("glslangValidator -V -I" + file("effects") + " " + sources + "effects.frag -o " +
                  file("effects.spv") + " && spirv-val " + file("effects.spv"));
  EXPECT_EQ(outcome.exit, 0) << outcome.text;
}

TEST_F(Effects, MissingMemberOfTheHostIsOneErrorThatNamesIt) {
  const std::string program = file("host.cpp", R"(
#include "cartoon.h"
struct Host {
  int light_count() const { return 0; }
};
auto color(const Host& host, const isoshade::shaders::cartoon::Surface<float>& surface, const isoshade::shaders::cartoon::Parameters& parameters) {
  return isoshade::shaders::cartoon::base_shade(host, surface, parameters);
}
)");
  for (const char* compiler : {"g++", "clang++"}) {
    const Outcome outcome = run_command(std::string(compiler) + " -std=c++20 -fsyntax-only -I " +
                                        file("effects") + " " + program);
    EXPECT_NE(outcome.exit, 0);
    EXPECT_NE(outcome.text.find("host.light(index, position)"), std::string::npos) << outcome.text;
    const size_t error = outcome.text.find("error: no matching function for call to");
    ASSERT_NE(error, std::string::npos) << outcome.text;
    EXPECT_EQ(outcome.text.find("error: ", error + 1), std::string::npos) << outcome.text;
  }
}

}  // namespace
}  // namespace isoshade::testing
