// SPDX-License-Identifier: Apache-2.0
// The command as a user meets it: exit codes, what goes where, and what it says when used wrongly.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>
#include <string>
#include <sys/wait.h>

#include "tests/unit/gltf_files.h"

namespace isoshade {
namespace {

namespace fs = std::filesystem;

struct Outcome {
  int exit = -1;
  std::string text;  ///< standard output and standard error
};

Outcome run_command(const std::string& command) {
  Outcome outcome;
  FILE* pipe = popen(("{ " + command + "; } 2>&1").c_str(), "r");
  char buffer[4096];
  for (size_t got; (got = fread(buffer, 1, sizeof buffer, pipe)) > 0;) outcome.text.append(buffer, got);
  outcome.exit = WEXITSTATUS(pclose(pipe));
  return outcome;
}

Outcome run(const std::string& arguments) {
  return run_command(std::string(ISOSHADE_COMMAND) + " " + arguments);
}

class Cli : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "isoshade-cli-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string file(const std::string& name, const std::string& text = "") const {
    if (!text.empty()) std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  static std::string read(const fs::path& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
  }

  fs::path folder_;
};

const std::string graphs = ISOSHADE_GRAPHS;
const std::string scene = graphs + "/scenes/borders.json";
const std::string ggx = graphs + "/library/brdf/ggx_d.json";

TEST_F(Cli, TellsItsVersionAndItsExitCodes) {
  EXPECT_EQ(run("--version").text, "isoshade " ISOSHADE_VERSION "\n");
  const Outcome help = run("--help");
  EXPECT_EQ(help.exit, 0);
  EXPECT_NE(help.text.find("Exit codes: 0"), std::string::npos);
}

TEST_F(Cli, EndsWithTwoWhereItIsUsedWrongly) {
  for (const char* arguments :
       {"", "paint", "render", "render x.json", "--no-such-flag", "verify a.json --backends gpu",
        "render a.json -o b.png --size 0x5", "render a.json -o b.png --size 9000x1",
        "render a.json -o b.png --lanes 5", "compile a.json", "eval f.json"})
    EXPECT_EQ(run(arguments).exit, 2) << arguments;
}

TEST_F(Cli, NamesAMissingFile) {
  const Outcome outcome = run("render " + file("none.json") + " -o " + file("a.png"));
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_NE(outcome.text.find("error[missing-file]"), std::string::npos) << outcome.text;
  EXPECT_FALSE(fs::exists(folder_ / "a.png"));
}

TEST_F(Cli, RendersPngAndExrAndRefusesOtherEndings) {
  EXPECT_EQ(run("render " + scene + " --size 16x9 -o " + file("a.png")).exit, 0);
  EXPECT_EQ(read(folder_ / "a.png").substr(1, 3), "PNG");
  EXPECT_EQ(run("render " + scene + " --size 16x9 --backend interpreter -o " + file("a.exr")).exit, 0);
  EXPECT_EQ(read(folder_ / "a.exr").substr(0, 4), "\x76\x2f\x31\x01");
  const Outcome outcome = run("render " + scene + " -o " + file("a.bmp"));
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_NE(outcome.text.find(".png"), std::string::npos) << outcome.text;
}

TEST_F(Cli, HasAReferenceThatDrawsSmallImagesAndPrintsManyDigits) {
  const std::string out = " --backend reference -o " + file("a.exr");
  EXPECT_EQ(run("render " + scene + " --size 16x9" + out).exit, 0);
  const Outcome large = run("render " + scene + " --size 16x300" + out);
  EXPECT_EQ(large.exit, 2);
  EXPECT_NE(large.text.find("at most 256x256"), std::string::npos) << large.text;
  const Outcome compared = run("verify " + scene + " --backends cpu,reference");
  EXPECT_EQ(compared.exit, 2);
  EXPECT_NE(compared.text.find("does not round"), std::string::npos) << compared.text;
  const std::string table = file("third.csv", "base_color.r,base_color.g,base_color.b\n1,0.5,inf\n");
  EXPECT_EQ(
      run("eval " + graphs + "/library/brdf/lambert.json --inputs " + table + " --backend reference").text,
      "out.x,out.y,out.z\n0.3183098773260113707468318358143994802985,"
      "0.1591549386630056853734159179071997401493,inf\n");
}

TEST_F(Cli, SaysOfASettingWhatIsWrongWithIt) {
  const std::string command =
      "render " + graphs + "/scenes/material_balls.json --size 8x8 -o " + file("a.png");
  const Outcome unknown = run(command + " --set balls.roughnes=0.5");
  EXPECT_EQ(unknown.exit, 2);
  EXPECT_NE(unknown.text.find("roughness"), std::string::npos) << unknown.text;
  const Outcome outside = run(command + " --set roughness=2");
  EXPECT_EQ(outside.exit, 2);
  EXPECT_NE(outside.text.find("at most 1"), std::string::npos) << outside.text;
  EXPECT_EQ(run(command + " --set balls.base_color=0.1,0.2,0.3").exit, 0);
}

TEST_F(Cli, ShowsAModelInPlaceOfTheOnlyObject) {
  std::ofstream(file("model.glb"), std::ios::binary)
      << testing::glb(testing::square_json(), testing::square_data());
  std::ofstream(file("plain.json")) << R"({"isoshade": 1, "effect": "plain",
    "nodes": {"c": {"type": "vertexcolor"}}, "passes": [{"name": "base", "color": "c"}]})";
  const auto write_scene = [&](const std::string& more) {
    std::ofstream(file("viewer.json")) << R"({"isoshade": 1, "scene": "viewer", "size": [8, 8],
      "camera": {"position": [0, 0, 2], "target": [0, 0, 0]},
      "objects": {"model": {"mesh": "box", "effect": "plain.json"})" +
                                              more + "}}";
  };
  const std::string command =
      "verify " + file("viewer.json") + " --backends cpu,interpreter --mesh " + file("model.glb");
  write_scene("");
  const Outcome shown = run(command);
  EXPECT_EQ(shown.exit, 0) << shown.text;
  EXPECT_NE(shown.text, run("verify " + file("viewer.json") + " --backends cpu,interpreter").text);
  write_scene(R"(, "other": {"mesh": "box", "effect": "plain.json"})");
  const Outcome which = run(command);
  EXPECT_EQ(which.exit, 2);
  EXPECT_NE(which.text.find("2 objects"), std::string::npos) << which.text;
}

TEST_F(Cli, VerifiesAndHoldsScenesAgainstRecordedHashes) {
  const Outcome same = run("verify " + scene + " --backends cpu,interpreter --size 32x18");
  EXPECT_EQ(same.exit, 0) << same.text;
  EXPECT_NE(same.text.find("identical: 0 of 576 pixels differ"), std::string::npos) << same.text;

  EXPECT_EQ(run("verify " + scene + " --backends cpu --size 32x18").exit, 2)
      << "there is nothing to compare with";

  const std::string golden = file("hashes.json");
  const std::string command = "verify " + scene + " --backends cpu --golden " + golden;
  EXPECT_EQ(run(command).exit, 2) << "there is no such file yet";
  EXPECT_EQ(run(command + " --update").exit, 0);
  EXPECT_EQ(run(command).exit, 0);
  const Outcome changed = run(command + " --set background=0.5,0,0,1");
  EXPECT_EQ(changed.exit, 1) << changed.text;
  EXPECT_EQ(run("verify " + scene + " --backends cpu --update").exit, 2) << "--update needs --golden";
  const std::string elsewhere = fs::relative(scene, folder_).string();
  EXPECT_EQ(run_command("cd " + folder_.string() + " && " ISOSHADE_COMMAND " verify " + elsewhere +
                        " --backends cpu --golden hashes.json")
                .exit,
            0)
      << "the file is the same from wherever it is used";
}

TEST_F(Cli, ComputesInThePrecisionThatIsAskedFor) {
  const std::string golden = file("hashes.json");
  const std::string command = "verify " + scene + " --backends cpu --golden " + golden;
  EXPECT_EQ(run(command + " --update").exit, 0);
  EXPECT_EQ(run(command + " --precision fast").exit, 1) << "none is recorded";
  EXPECT_EQ(run(command + " --precision fast --update").exit, 0);
  EXPECT_EQ(run(command + " --precision fast").exit, 0);
  EXPECT_EQ(run(command).exit, 0) << "both are kept";
  EXPECT_EQ(run(command + " --precision best").exit, 2);

  std::ofstream(file("root.json"))
      << R"({"isoshade": 1, "function": "root", "inputs": {"x": {"type": "float"}},
    "nodes": {"r": {"type": "power", "in1": "x", "in2": 0.3}}, "outputs": {"out": "r"}})";
  std::ofstream(file("x.csv")) << "x\n0.7\n";
  const std::string eval = "eval " + file("root.json") + " --inputs " + file("x.csv");
  const auto compile = "compile " + file("root.json") + " -o " + file("out") + " --target cpp";
  const std::string fast = run(eval + " --precision fast").text,
                    precise = run(eval + " --precision precise").text;
  EXPECT_NE(fast, precise);
  EXPECT_EQ(run(eval + " --precision fast --backend interpreter").text, fast);
  EXPECT_EQ(run(compile + " --precision fast").exit, 0);
  EXPECT_NE(read(folder_ / "out/root.json").find("\"precision\": \"fast\""), std::string::npos);
  const std::string node = run("nodes power").text;
  EXPECT_NE(node.find("with --precision fast"), std::string::npos) << node;
}

TEST_F(Cli, MeasuresEveryFormPrecisionAndBackend) {
  const Outcome outcome =
      run("bench --quick --only toon_highlight --lanes 1,4 --no-picture -o " + file("bench"));
  EXPECT_EQ(outcome.exit, 0) << outcome.text;
  std::istringstream csv(read(folder_ / "bench/bench.csv"));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line,
            "effect,form,precision,backend,lanes,nanoseconds,spread,transfer,max_ulp,mean_ulp,max_absolute,"
            "identical");
  int points = 0;
  for (; std::getline(csv, line); ++points) {
    const bool same = line.ends_with(",yes"), yardstick = line.find(",built-ins,") != std::string::npos;
    EXPECT_TRUE(same || yardstick) << line;
  }
#ifdef ISOSHADE_VULKAN
  EXPECT_EQ(points, 2 * 3 * 3 + 1)
      << "two forms, three precisions, three backends; built-ins of the source's form";
#else
  EXPECT_EQ(points, 2 * 3 * 2);
#endif
  EXPECT_NE(read(folder_ / "bench/bench.json").find("\"max_ulp\""), std::string::npos);
  EXPECT_EQ(run("bench --only no_such_effect").exit, 2);
}

TEST_F(Cli, ShowsAnotherTime) {
  const auto hash_of = [](const std::string& time) {
    const Outcome outcome = run("verify " + graphs + "/scenes/surface_attributes.json --size 64x36 " +
                                "--backends cpu,interpreter " + time);
    EXPECT_EQ(outcome.exit, 0) << outcome.text;
    const size_t at = outcome.text.find("sha256 ");
    return outcome.text.substr(at, at == std::string::npos ? at : 71);
  };
  EXPECT_EQ(hash_of(""), hash_of("--time 2.125")) << "the scene's own";
  EXPECT_NE(hash_of(""), hash_of("--time 2.5"));
  EXPECT_EQ(run("render " + scene + " -o " + file("a.png") + " --time soon").exit, 2);
}

TEST_F(Cli, EvaluatesATable) {
  const std::string table = file("in.csv", "n_dot_h, alpha\n1, 0.5\n0x1.8p-1,0.0625\n0.5,nan\n");
  for (const char* backend : {"cpu", "interpreter"})
    EXPECT_EQ(run("eval " + ggx + " --inputs " + table + " --backend " + backend).text,
              "out\n0x1.45f306p+0\n0x1.a57c44p-8\nnan\n");
  EXPECT_EQ(run("eval " + ggx + " --inputs " + table + " -o " + file("out.csv")).text, "");
  EXPECT_EQ(read(folder_ / "out.csv"), "out\n0x1.45f306p+0\n0x1.a57c44p-8\nnan\n");
}

TEST_F(Cli, SaysWhereATableIsWrong) {
  const auto error = [&](const std::string& text) {
    return run("eval " + ggx + " --inputs " + file("in.csv", text)).text;
  };
  EXPECT_NE(error("alpha,n_dot_l\n1,1\n").find("did you mean \"n_dot_h\"?"), std::string::npos);
  EXPECT_NE(error("roughness,n_dot_h\n1,1\n").find("the columns are alpha,n_dot_h"), std::string::npos);
  EXPECT_NE(error("alpha\n1\n").find("there is no column \"n_dot_h\""), std::string::npos);
  EXPECT_NE(error("\xef\xbb\xbf"
                  "alpha,n_dot_h\n1\n")
                .find("this row has 1 cells"),
            std::string::npos);
  EXPECT_NE(error("alpha,n_dot_h\n1,one\n").find("in.csv:2:3: error[bad-table]: \"one\" is not a float"),
            std::string::npos);
}

TEST_F(Cli, CompilesAGraphToFilesThatStandAlone) {
  const Outcome outcome =
      run("compile " + graphs + "/materials/cook_torrance.json --target glsl,cpp,spirv -o " + file("out"));
  EXPECT_EQ(outcome.exit, 0) << outcome.text;
  for (const char* name :
       {"cook_torrance.base.pixel.frag", "cook_torrance.base.pixel.frag.spv", "cook_torrance.base.pixel.cpp",
        "cook_torrance.base.vertex.vert", "cook_torrance.json", "runtime/lanes/lanes.h"})
    EXPECT_TRUE(fs::exists(folder_ / "out" / name)) << name;
  const std::string compiler = "c++ -std=c++20 -Wall -Wextra -Werror -fsyntax-only -I " + file("out") + " ";
  EXPECT_EQ(std::system((compiler + file("out") + "/cook_torrance.base.pixel.cpp").c_str()), 0);
}

TEST_F(Cli, CompilesAPostToFiles) {
  const Outcome outcome =
      run("compile " + graphs + "/effects/bloom/blur.json --target glsl,cpp -o " + file("out"));
  EXPECT_EQ(outcome.exit, 0) << outcome.text;
  for (const char* name : {"bloom_blur.post.frag", "bloom_blur.post.cpp", "bloom_blur.json"})
    EXPECT_TRUE(fs::exists(folder_ / "out" / name)) << name;
  const std::string reflection = read(folder_ / "out" / "bloom_blur.json");
  EXPECT_NE(reflection.find("\"post\": \"bloom_blur\""), std::string::npos) << reflection;
  EXPECT_NE(reflection.find("\"taps\""), std::string::npos) << reflection;
}

TEST_F(Cli, TellsOfPostsThatAreSwitchedOff) {
  const std::string command = "render " + graphs +
                              "/scenes/fog_balls.json --size 16x9 --backend interpreter --stats -o " +
                              file("a.png");
  EXPECT_NE(run(command).text.find("posts:    2"), std::string::npos);
  const Outcome without = run(command + " --set fog.fog_density=0");
  EXPECT_NE(without.text.find("skipped:  post fog: fog_density is 0"), std::string::npos) << without.text;
  EXPECT_NE(without.text.find("posts:    1"), std::string::npos) << without.text;
}

TEST_F(Cli, ChecksByExitCodeAndGivesCounterexamplesToEval) {
  const Outcome proved = run("check " + ggx);
  EXPECT_EQ(proved.exit, 0) << proved.text;
  EXPECT_NE(proved.text.find("ggx_d.json: proved\n  out in ["), std::string::npos) << proved.text;
  const std::string source_form = graphs + "/source_forms/ggx_d.json", table = file("found.csv");
  const Outcome refuted = run("check " + source_form + " -o " + table);
  EXPECT_EQ(refuted.exit, 1) << refuted.text;
  EXPECT_NE(refuted.text.find("error[refuted]: in node \"d\", port \"in2\""), std::string::npos)
      << refuted.text;
  const Outcome evaluated = run("eval " + source_form + " --backend interpreter --inputs " + table);
  EXPECT_EQ(evaluated.text, "out\nnan\n");
  const Outcome restricted = run("check " + ggx + " --where n_dot_h=0:0.5");
  EXPECT_EQ(restricted.exit, 0) << restricted.text;
  EXPECT_NE(restricted.text, proved.text);
  const Outcome unknown = run("check " + ggx + " --where n_dot_x=0:1");
  EXPECT_EQ(unknown.exit, 2);
  EXPECT_NE(unknown.text.find("did you mean \"n_dot_h\"?"), std::string::npos) << unknown.text;
  EXPECT_EQ(run("check " + ggx + " --where n_dot_h=1").exit, 2);
  EXPECT_EQ(run("check " + scene).exit, 2);
  const Outcome as_data = run("check " + source_form + " --diagnostics json");
  EXPECT_NE(as_data.text.find("\"refuted\""), std::string::npos) << as_data.text;
}

TEST_F(Cli, NamesAWrongSubcommandAndTheRightOnes) {
  const Outcome outcome = run("paint");
  EXPECT_NE(outcome.text.find("paint"), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find("compile, render, verify, eval, check, fmt, draw, bench, devices"), std::string::npos)
      << outcome.text;
}

TEST_F(Cli, NeverWritesOverWhatItReads) {
  const std::string text =
      R"({"isoshade": 1, "function": "f", "inputs": {"x": {"type": "float"}},
          "nodes": {"n": {"type": "sin", "in": "x"}}, "outputs": {"out": "n"}})";
  const std::string function = file("f.json", text), table = file("in.csv", "x\n1\n");
  EXPECT_EQ(run("compile " + function + " -o " + folder_.string()).exit, 2)
      << "f.json is its reflection's name";
  EXPECT_FALSE(fs::exists(folder_ / "f.cpp")) << "all or nothing";
  EXPECT_EQ(run("eval " + function + " --inputs " + table + " -o " + function).exit, 2);
  EXPECT_EQ(run("eval " + function + " --inputs " + table + " -o " + table).exit, 2);
  EXPECT_EQ(read(function), text);
  EXPECT_EQ(read(table), "x\n1\n");
  // Reflection itself may be replaced, by that of the next run.
  for (int i = 0; i < 2; ++i) EXPECT_EQ(run("compile " + function + " -o " + file("out")).exit, 0);
}

TEST_F(Cli, WritesToAPipeByItsPath) {
  const std::string table = file("in.csv", "n_dot_h,alpha\n1,0.5\n");
  EXPECT_EQ(run("eval " + ggx + " --inputs " + table + " -o /dev/stdout | cat").text, "out\n0x1.45f306p+0\n");
}

TEST_F(Cli, ReadsStandardInputForOneThingOnly) {
  EXPECT_NE(run("eval - --inputs - < " + ggx).text.find("only once"), std::string::npos);
  EXPECT_NE(run("verify - - < " + scene).text.find("only once"), std::string::npos);
  EXPECT_EQ(run("verify - --golden " + file("g.json") + " --update < " + scene).exit, 2) << "it has no name";
}

TEST_F(Cli, FailsWhereNobodyCanReadWhatItSays) {
  const std::string verify = "verify " + scene + " --backends interpreter,interpreter --size 8x8";
  EXPECT_EQ(run(verify).exit, 0);
  EXPECT_EQ(run(verify + " 2>&1 >/dev/full").exit, 2);
  EXPECT_EQ(run(verify + " 2>&1 >&-").exit, 2);
  EXPECT_EQ(
      run("render " + scene + " --backend interpreter --size 8x8 -o " + file("a.png") + " >&- 2>&- <&-").exit,
      0);
  EXPECT_EQ(read(folder_ / "a.png").substr(1, 3), "PNG") << "and nothing else is written to the file";
}

TEST_F(Cli, TakesTheInterpreterForTheCpuOnlyWhereNothingIsProven) {
  const std::string bare = "env -u ISOSHADE_CXX PATH=/nonexistent ";
  const std::string render = "render " + scene + " --size 8x8 -o " + file("a.png");
  const auto with = [](const std::string& environment, const std::string& arguments) {
    return run_command(environment + ISOSHADE_COMMAND + " " + arguments);
  };
  EXPECT_EQ(with("/usr/bin/" + bare, render).exit, 0);
  const Outcome proof =
      with("/usr/bin/" + bare, "verify " + scene + " --backends cpu,interpreter --size 8x8");
  EXPECT_EQ(proof.exit, 2) << "it would compare the interpreter with itself";
  EXPECT_NE(proof.text.find("g++ 12"), std::string::npos) << proof.text;
  EXPECT_EQ(with("ISOSHADE_CXX=/nonexistent ", render).exit, 2) << "a compiler was named, and is not there";
}

TEST_F(Cli, ListsTheNodesAndTellsAllOfOne) {
  const Outcome all = run("nodes");
  EXPECT_EQ(all.exit, 0);
  EXPECT_NE(all.text.find("\n  noise3d "), std::string::npos);
  const Outcome one = run("nodes sin");
  EXPECT_EQ(one.exit, 0);
  EXPECT_NE(one.text.find("\nerror  1.75 ULP\n"), std::string::npos) << one.text;
  EXPECT_NE(one.text.find(" operations on vector3\n"), std::string::npos) << one.text;
  const Outcome none = run("nodes nois3d");
  EXPECT_EQ(none.exit, 2);
  EXPECT_NE(none.text.find("did you mean \"noise3d\"?"), std::string::npos) << none.text;
}

TEST_F(Cli, NamesNodesByWhatOthersCallThem) {
  EXPECT_NE(run("nodes lerp").text.find("did you mean \"mix\"?"), std::string::npos);
  EXPECT_NE(run("nodes dot").text.find("did you mean \"dotproduct\"?"), std::string::npos);
  EXPECT_NE(run("rendr a.json").text.find("Did you mean \"render\"?"), std::string::npos);
}

TEST_F(Cli, ListsStagesAndDumpsThemWithoutAFolder) {
  const Outcome stages = run("compile " + ggx + " --dump-after help");
  EXPECT_EQ(stages.exit, 0) << stages.text;
  EXPECT_EQ(stages.text.find("\nfold\n"), stages.text.rfind("\nfold\n")) << stages.text;
  EXPECT_EQ(run("compile " + ggx + " --dump-after typed").exit, 0);
  EXPECT_EQ(run("compile " + ggx + " -o " + file("out") + " --dump-after help").text, stages.text);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  EXPECT_EQ(run("compile " + ggx).exit, 2);
}

TEST_F(Cli, TablesNameComponentsOfColoursAsColours) {
  const std::string function = file(
      "f.json",
      R"({"isoshade": 1, "function": "f", "inputs": {"c": {"type": "color3"}}, "outputs": {"out": "c"}})");
  const std::string table = file("in.csv", "c.b,c.r,c.g\n4,1,2\n");
  EXPECT_EQ(run("eval " + function + " --inputs " + table + " --backend interpreter").text,
            "out.x,out.y,out.z\n0x1p+0,0x1p+1,0x1p+2\n");
}

TEST_F(Cli, DumpsEveryStage) {
  const std::string command = "compile " + ggx + " -o " + file("out") + " --quiet --dump-after ";
  std::istringstream stages(run(command + "help").text);
  int count = 0;
  for (std::string stage; std::getline(stages, stage); ++count)
    EXPECT_NE(run(command + stage).text.find("# after " + stage + "\n"), std::string::npos) << stage;
  EXPECT_GE(count, 10);
  EXPECT_EQ(run(command + "nowhere").exit, 2);
}

TEST_F(Cli, FormatsDocumentsInPlaceAndChecksThem) {
  const std::string path = file("f.json", "{\"isoshade\":1,  \"function\":\"f\"}");
  const Outcome listed = run("fmt --check " + path);
  EXPECT_EQ(listed.exit, 1);
  EXPECT_EQ(listed.text, path + "\n");
  EXPECT_EQ(run("fmt " + path).exit, 0);
  EXPECT_EQ(read(path), "{\n  \"isoshade\": 1,\n  \"function\": \"f\"\n}\n");
  EXPECT_EQ(run("fmt --check " + path).exit, 0);
  EXPECT_EQ(run("fmt - < " + path).text, read(path));
  const std::string broken = file("broken.json", "{\"a\": ");
  EXPECT_EQ(run("fmt " + broken).exit, 2);
  EXPECT_EQ(read(broken), "{\"a\": ");
}

TEST_F(Cli, DrawsGraphsAsSvgPngAndDot) {
  if (std::system("command -v dot >/dev/null") != 0) GTEST_SKIP() << "graphviz is not installed";
  for (const std::string name : {"g.svg", "g.png", "g.dot"}) {
    const Outcome outcome = run("draw " + ggx + " -o " + file(name));
    EXPECT_EQ(outcome.exit, 0) << outcome.text;
  }
  EXPECT_NE(read(folder_ / "g.svg").find("<svg"), std::string::npos);
  EXPECT_EQ(read(folder_ / "g.png").substr(1, 3), "PNG");
  EXPECT_EQ(read(folder_ / "g.dot").substr(0, 7), "digraph");
  EXPECT_EQ(run("draw " + ggx + " -o " + file("g.pdf")).exit, 2);
}

TEST_F(Cli, TellsDiagnosticsAsData) {
  const std::string path =
      file("f.json", R"({"isoshade": 1, "function": "f", "inputs": {"x": {"type": "float"}},
"nodes": {"n": {"type": "add", "in1": "y", "in2": 1}}, "outputs": {"out": "n"}})");
  const Outcome outcome = run("compile " + path + " -o " + file("out") + " --diagnostics json");
  EXPECT_EQ(outcome.exit, 2);
  for (const std::string part : {R"("id": "unknown-node")", R"("line": 2)", R"("column": 39)",
                                 R"("pointer": "/nodes/n/in1")", R"("severity": "error")"})
    EXPECT_NE(outcome.text.find(part), std::string::npos) << outcome.text;
  EXPECT_EQ(run("compile " + ggx + " -o " + file("out") + " --diagnostics json").text, "[]\n");
}

TEST_F(Cli, TakesWarningsAsAsked) {
  const std::string path =
      file("f.json", R"({"isoshade": 1, "function": "f", "inputs": {"x": {"type": "float"}},
"nodes": {"lost": {"type": "add", "in1": "x", "in2": 1}}, "outputs": {"out": "x"}})");
  const std::string command = "compile " + path + " -q -o " + file("out");
  const Outcome warned = run(command);
  EXPECT_EQ(warned.exit, 0);
  EXPECT_NE(warned.text.find("warning[unused-node]"), std::string::npos) << warned.text;
  const Outcome refused = run(command + " -Werror");
  EXPECT_EQ(refused.exit, 2);
  EXPECT_NE(refused.text.find("error[unused-node]"), std::string::npos) << refused.text;
  EXPECT_EQ(run(command + " -Werror -Wno-unused-node").text, "");
  const Outcome unknown = run(command + " -Wno-such");
  EXPECT_EQ(unknown.exit, 2);
  EXPECT_NE(unknown.text.find("unused-node"), std::string::npos) << unknown.text;
}

TEST_F(Cli, FilesOutsideOfTheCollectionAreRefusedUnlessAllowed) {
  fs::create_directories(folder_ / "a");
  fs::create_directories(folder_ / "b");
  file("a/part.json", R"({"isoshade": 1, "function": "part", "inputs": {"x": {"type": "float"}},
"nodes": {"n": {"type": "sin", "in": "x"}}, "outputs": {"out": "n"}})");
  const std::string user =
      file("b/user.json", R"({"isoshade": 1, "function": "user", "inputs": {"x": {"type": "float"}},
"nodes": {"n": {"type": "../a/part.json", "x": "x"}}, "outputs": {"out": "n"}})");
  const std::string command = "compile " + user + " -q -o " + file("out");
  const Outcome refused = run(command);
  EXPECT_EQ(refused.exit, 2);
  EXPECT_NE(refused.text.find("error[outside-reference]"), std::string::npos) << refused.text;
  EXPECT_EQ(run(command + " --allow-outside").exit, 0);
  file("isoshade.root", "here");
  EXPECT_EQ(run(command).exit, 0);
}

}  // namespace
}  // namespace isoshade
