// SPDX-License-Identifier: Apache-2.0
// The subcommands for documents (compile, eval, check, fmt, draw, nodes) and the options for diagnostics.
#include <algorithm>
#include <gtest/gtest.h>

#include "tests/unit/command.h"

namespace isoshade {
namespace {

using namespace testing;
namespace fs = std::filesystem;

TEST_F(Cli, EvalWritesOneRowPerInputRow) {
  const std::string table = file("in.csv", "n_dot_h, alpha\n1, 0.5\n0x1.8p-1,0.0625\n0.5,nan\n");
  for (const char* backend : {"cpu", "interpreter"})
    EXPECT_EQ(run("eval " + ggx + " --inputs " + table + " --backend " + backend).text,
              "out\n0x1.45f306p+0\n0x1.a57c44p-8\nnan\n");
  EXPECT_EQ(run("eval " + ggx + " --inputs " + table + " -o " + file("out.csv")).text, "");
  EXPECT_EQ(read(folder_ / "out.csv"), "out\n0x1.45f306p+0\n0x1.a57c44p-8\nnan\n");
}

TEST_F(Cli, TableErrorsHaveAPosition) {
  const auto error = [&](const std::string& text) {
    return run("eval " + ggx + " --inputs " + file("in.csv", text)).text;
  };
  EXPECT_NE(error("alpha,n_dot_l\n1,1\n").find("did you mean \"n_dot_h\"?"), std::string::npos);
  EXPECT_NE(error("roughness,n_dot_h\n1,1\n").find("the columns are alpha,n_dot_h"), std::string::npos);
  EXPECT_NE(error("alpha\n1\n").find("there is no column \"n_dot_h\""), std::string::npos);
  EXPECT_NE(error("\xef\xbb\xbf"
                  "alpha,n_dot_h\n1\n")
                .find("this row has 1 cell, but there are 2 columns"),
            std::string::npos);
  EXPECT_NE(error("alpha,n_dot_h\n1,one\n").find("in.csv:2:3: error[bad-table]: \"one\" is not a float"),
            std::string::npos);
}

TEST_F(Cli, CompiledFilesNeedNoSourceTree) {
  const std::string command = "compile " + graphs + "/materials/cook_torrance.json -o " + file("out");
  EXPECT_EQ(run(command).exit, 0);
  const Outcome outcome = run(command + " --wrapper isoshade --target glsl,cpp,spirv");
  EXPECT_EQ(outcome.exit, 0) << outcome.text;
  for (const char* name :
       {"cook_torrance.glsl", "cook_torrance.h", "cook_torrance.base.pixel.frag", "cook_torrance.base.pixel.frag.spv", "cook_torrance.base.pixel.cpp",
        "cook_torrance.base.vertex.vert", "cook_torrance.json", "isoshade/lanes/lanes.h"})
    EXPECT_TRUE(fs::exists(folder_ / "out" / name)) << name;
  const std::string compiler = "c++ -std=c++20 -Wall -Wextra -Werror -fsyntax-only -I " + file("out") + " ";
  EXPECT_EQ(std::system((compiler + file("out") + "/cook_torrance.base.pixel.cpp").c_str()), 0);
  const std::string user = file("user.cpp", "#include \"cook_torrance.h\"\nint main() {}\n");
  EXPECT_EQ(std::system((compiler + user).c_str()), 0);
}

TEST_F(Cli, PrefixNamesAllThatAShaderDefines) {
  const std::string command = "compile " + graphs + "/effects/flat.json -q -o " + file("out") + " --target glsl,cpp --prefix ";
  EXPECT_EQ(run(command + "mine").exit, 0);
  const std::string glsl = read(folder_ / "out" / "flat.glsl"), cpp = read(folder_ / "out" / "flat.h");
  EXPECT_NE(glsl.find(" mine_shade(mine_"), std::string::npos) << glsl;
  EXPECT_EQ(glsl.find(" flat_"), std::string::npos) << glsl;
  EXPECT_NE(cpp.find("namespace isoshade::shaders::mine {"), std::string::npos) << cpp;
  const Outcome code = run(command + "'int; } evil {'");
  EXPECT_EQ(code.exit, 2);
  EXPECT_NE(code.text.find("is not a valid prefix"), std::string::npos) << code.text;
  // A prefix that is a word of a language gets one underscore, and no name has two in a row.
  EXPECT_EQ(run(command + "flat").exit, 0);
  EXPECT_NE(read(folder_ / "out" / "flat.glsl").find(" flat_shade(flat_"), std::string::npos);
}

TEST_F(Cli, CompileSetLeavesOutWhatOtherValuesNeed) {
  const std::string effect = file("glow.json", R"json({"isoshade": 1, "effect": "glow", "parameters": {
    "strength": {"type": "float", "value": 1, "min": 0, "max": 4}, "tint": {"type": "color3", "value": [1, 1, 1]},
    "mode": {"type": "integer", "enum": ["flat", "noisy"], "value": "noisy"}, "map": {"type": "filename", "value": ""}},
    "nodes": {"noise": {"type": "noise3d", "to": "float"}, "picture": {"type": "image", "file": {"link": "map"}, "default": [1, 1, 1]},
      "color": {"type": "expression", "code": "tint * picture * (strength > 0 ? (mode == 1 ? noise : 1) * strength : 0)",
                "tint": "tint", "picture": "picture", "noise": "noise", "mode": "mode", "strength": "strength"}},
    "passes": [{"name": "base", "color": "color"}]})json");
  const auto compiled = [&](const std::string& options) {
    const Outcome outcome = run("compile " + effect + " -o " + file("out") + " -q --target glsl,cpp " + options);
    return outcome.exit == 0 ? read(folder_ / "out" / "glow.glsl") : outcome.text;
  };
  const auto has = [](const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; };
  const std::string all = compiled("");
  EXPECT_TRUE(has(all, "noise3d") && has(all, "parameters.strength") && has(all, "isoshade_texel(") && has(all, "parameters.mode")) << all;
  const std::string flat = compiled("--set mode=flat --set 'map=\"\"'");
  EXPECT_TRUE(has(flat, "parameters.strength") && has(flat, "int mode;")) << flat;
  EXPECT_FALSE(has(flat, "noise3d") || has(flat, "isoshade_texel(") || has(flat, "parameters.mode")) << flat;
  const std::string reflection = read(folder_ / "out" / "glow.json");
  EXPECT_TRUE(has(reflection, "\"fixed\": 0") && has(reflection, "\"fixed\": \"\"")) << reflection;
  EXPECT_TRUE(has(compiled("--set tint=0.25,0.5,0.75 --set strength=2 --set strength=3"), "3.0"));
  std::string squeezed = read(folder_ / "out" / "glow.json");
  std::erase_if(squeezed, [](char c) { return c == ' ' || c == '\n'; });
  EXPECT_TRUE(has(squeezed, "\"fixed\":[0.25,0.5,0.75]") && has(squeezed, "\"fixed\":3")) << squeezed;
  EXPECT_TRUE(has(reflection, "\"skip\": \"parameters\"") && has(reflection, "\"node\": \"noise\"")) << reflection;
  const std::string off = compiled("--set strength=0");
  EXPECT_TRUE(has(off, "parameters.tint") && !has(off, "noise3d") && !has(off, "parameters.strength") && !has(off, "parameters.mode")) << off;
  for (const char* wrapper : {"forward --target glsl,spirv", "isoshade --target glsl,cpp,spirv"})
    EXPECT_EQ(run("compile " + effect + " -q -o " + file("wrapped") + " --set mode=flat --wrapper " + wrapper).exit, 0) << wrapper;
  EXPECT_FALSE(has(read(folder_ / "wrapped" / "glow.base.pixel.frag"), "noise3d"));

  EXPECT_TRUE(has(compiled("--set strenght=0"), "\"glow\" has no parameter \"strenght\"") && has(compiled("--set strenght=0"), "\"strength\"?"));
  EXPECT_TRUE(has(compiled("--set strength=9"), "is at most 4"));
  EXPECT_TRUE(has(compiled("--set mode=nosy"), "did you mean"));
  EXPECT_TRUE(has(compiled("--set strength"), "is not of the form"));
  EXPECT_TRUE(has(compiled("--set glow.strength=1"), "--set strength=1"));
  EXPECT_TRUE(has(compiled("--set map=a.png"), "no image can be compiled into a program"));
  EXPECT_TRUE(has(run("compile " + ggx + " -o " + file("out") + " --set alpha=1").text, "parameters of effects and posts"));
}

TEST_F(Cli, CompiledTextsAreTheSameInEveryWorkingDirectory) {
  const std::string graph = fs::canonical(graphs + "/materials/textured.json").string();
  std::vector<std::string> texts;
  for (const std::string& there : {std::string("/"), fs::path(graph).parent_path().string()}) {
    const std::string name = there == "/" ? graph : "textured.json";
    const Outcome outcome =
        run_command("cd " + there + " && " + std::string(ISOSHADE_COMMAND) + " compile " + name + " -q -o " + file("out"));
    EXPECT_EQ(outcome.exit, 0) << outcome.text;
    texts.push_back(read(folder_ / "out" / "textured.glsl") + read(folder_ / "out" / "textured.h"));
  }
  EXPECT_EQ(texts[0], texts[1]);
  EXPECT_NE(texts[0].find("from materials/textured.json"), std::string::npos);
}

TEST_F(Cli, PureShadersHaveNoBinaryForm) {
  const Outcome outcome = run("compile " + ggx + " -o " + file("out") + " --target spirv");
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_NE(outcome.text.find("add --wrapper forward or isoshade"), std::string::npos) << outcome.text;
}

TEST_F(Cli, DepfilesEscapeWhatMakeAndNinjaWouldReadOtherwise) {
  std::filesystem::copy(ggx, file("a b#c$d:e.json"));
  const Outcome outcome = run("compile '" + file("a b#c$d:e.json") + "' -o " + file("out") + " --target glsl --depfile " + file("rule.d"));
  EXPECT_EQ(outcome.exit, 0) << outcome.text;
  const std::string rule = read(file("rule.d"));
  EXPECT_NE(rule.find(R"(a\ b\#c$$d\:e.json)"), std::string::npos) << rule;
}

TEST_F(Cli, DepfilesOverwriteNoOutput) {
  const Outcome outcome = run("compile " + ggx + " -o " + file("out") + " --target glsl --depfile " + file("out/ggx_d.glsl"));
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_NE(outcome.text.find("--depfile would overwrite"), std::string::npos) << outcome.text;
  EXPECT_NE(read(file("out/ggx_d.glsl")).find("float ggx_d("), std::string::npos);
}

TEST_F(Cli, UnknownStagesAreReportedBeforeFilesAreWritten) {
  const Outcome outcome = run("compile " + ggx + " -o " + file("out") + " --dump-after nonsense");
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_FALSE(std::filesystem::exists(file("out")));
}

TEST_F(Cli, LongestNamesGiveValidFileNames) {
  const std::string effect(128, 'e'), pass(127, 'p');
  std::string passes;
  for (const char* digit : {"1", "2"})
    passes +=
        std::string(passes.empty() ? "" : ", ") + R"({"name": ")" + pass + digit + R"(", "color": "c"})";
  const std::string document =
      R"({"isoshade": 1, "effect": ")" + effect +
      R"(", "nodes": {"c": {"type": "constant", "value": [1, 2, 3], "to": "color3"}}, "passes": [)" + passes +
      "]}";
  const Outcome outcome =
      run("compile " + file("long.json", document) + " --wrapper isoshade --target glsl,cpp,spirv -o " + file("out"));
  EXPECT_EQ(outcome.exit, 0) << outcome.text;
  // The reflection, and three files for each of two stages of two passes.
  const auto files = fs::directory_iterator(folder_ / "out");
  EXPECT_EQ(
      std::count_if(begin(files), end(files), [](const auto& entry) { return entry.is_regular_file(); }),
      1 + 2 * 2 * 3);
}

TEST_F(Cli, CompileWritesPosts) {
  const Outcome outcome =
      run("compile " + graphs + "/effects/bloom/blur.json --wrapper isoshade --target glsl,cpp -o " + file("out"));
  EXPECT_EQ(outcome.exit, 0) << outcome.text;
  for (const char* name : {"bloom_blur.post.frag", "bloom_blur.post.cpp", "bloom_blur.json"})
    EXPECT_TRUE(fs::exists(folder_ / "out" / name)) << name;
  const std::string reflection = read(folder_ / "out" / "bloom_blur.json");
  EXPECT_NE(reflection.find("\"kind\": \"post\""), std::string::npos) << reflection;
  EXPECT_NE(reflection.find("\"taps\": "), std::string::npos) << reflection;
}

TEST_F(Cli, CheckSetsTheExitCodeAndWritesCounterexamplesForEval) {
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
  const std::string fog = graphs + "/library/fog/height_density.json";
  EXPECT_EQ(run("check " + fog + " --precision fast").text, run("check " + fog).text)
      << "it calls no function that differs between tiers";
  const Outcome unknown = run("check " + ggx + " --where n_dot_x=0:1");
  EXPECT_EQ(unknown.exit, 2);
  EXPECT_NE(unknown.text.find("did you mean \"n_dot_h\"?"), std::string::npos) << unknown.text;
  EXPECT_EQ(run("check " + ggx + " --where n_dot_h=1").exit, 2);
  const Outcome vacuous = run("check " + ggx + " --where n_dot_h=2:3");
  EXPECT_EQ(vacuous.exit, 2);
  EXPECT_NE(vacuous.text.find("error[out-of-range]: no input lies within"), std::string::npos)
      << vacuous.text;
  EXPECT_EQ(run("check " + scene).exit, 2);
  const Outcome as_data = run("check " + source_form + " --diagnostics json");
  EXPECT_NE(as_data.text.find("\"refuted\""), std::string::npos) << as_data.text;
}

TEST_F(Cli, CheckProvesForValuesOfParameters) {
  const std::string effect = file("share.json", R"({"isoshade": 1, "effect": "share", "parameters": {
    "by": {"type": "float", "value": 1, "min": 0, "max": 4}, "tint": {"type": "color3", "value": [1, 1, 1], "min": 0, "max": 1}},
    "nodes": {"q": {"type": "divide", "in1": "tint", "in2": "by"}}, "passes": [{"name": "base", "color": "q"}]})");
  EXPECT_EQ(run("check " + effect).exit, 1);
  const Outcome proved = run("check " + effect + " --set by=2 --set tint=0.25,0.5,1");
  EXPECT_EQ(proved.exit, 0) << proved.text;
  EXPECT_NE(proved.text.find("color.y in [0.25, 0.25]"), std::string::npos) << proved.text;
  const Outcome refuted = run("check " + effect + " --set by=0");
  EXPECT_EQ(refuted.exit, 1) << "only the value counts\n" << refuted.text;
  EXPECT_NE(refuted.text.find("share.json:3:"), std::string::npos) << refuted.text;
  EXPECT_EQ(run("check " + effect + " --set yb=0").exit, 2);
  EXPECT_EQ(run("check " + ggx + " --set alpha=1").exit, 2) << "a function has no parameters";

  const auto outcome_of = [&](const std::string& options) {
    const Outcome made = run("compile " + effect + " -q --check -o " + file("out") + options);
    EXPECT_EQ(made.exit, 0) << made.text;
    const std::string reflection = read(folder_ / "out" / "share.json"), key = "\"outcome\": \"";
    const size_t at = reflection.find(key);
    return at == std::string::npos ? reflection : reflection.substr(at + key.size(), reflection.find('"', at + key.size()) - at - key.size());
  };
  EXPECT_EQ(outcome_of(""), "refuted");
  EXPECT_EQ(outcome_of(" --set by=2"), "proved");
  EXPECT_EQ(outcome_of(" --set by=0"), "refuted");
}

TEST_F(Cli, NodesListsAllAndDescribesOne) {
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

TEST_F(Cli, NodesListsLibraryFunctionsAndDescribesOne) {
  EXPECT_NE(run("nodes").text.find("\nlibrary\n  brdf/"), std::string::npos);
  const Outcome one = run("nodes brdf/ggx_d");
  EXPECT_EQ(one.exit, 0);
  EXPECT_NE(one.text.find("brdf/ggx_d (library)\n"), std::string::npos) << one.text;
  for (const char* part : {"\n  alpha    float; required\n", "; 1e-04 to 1.0\n", "\noutputs\n  out      float\n"})
    EXPECT_NE(one.text.find(part), std::string::npos) << part << "\n" << one.text;
  const Outcome none = run("nodes brdf/ggx_e");
  EXPECT_EQ(none.exit, 2);
  EXPECT_NE(none.text.find("did you mean \"brdf/ggx_d\"?"), std::string::npos) << none.text;
}

TEST_F(Cli, NodesSuggestsTheNodeForTheNameInOtherLanguages) {
  EXPECT_NE(run("nodes lerp").text.find("did you mean \"mix\"?"), std::string::npos);
  const Outcome function = run("nodes dot");
  EXPECT_EQ(function.exit, 0);
  EXPECT_NE(function.text.find("dot (function)"), std::string::npos) << function.text;
  EXPECT_NE(function.text.find("The node is dotproduct.\n"), std::string::npos) << function.text;
  EXPECT_NE(run("rendr a.json").text.find("Did you mean \"render\"?"), std::string::npos);
}

TEST_F(Cli, DumpAfterNeedsNoOutputFolder) {
  const Outcome stages = run("compile " + ggx + " --dump-after help");
  EXPECT_EQ(stages.exit, 0) << stages.text;
  EXPECT_EQ(stages.text.find("\nfold\n"), stages.text.rfind("\nfold\n")) << stages.text;
  EXPECT_EQ(run("compile " + ggx + " --dump-after typed").exit, 0);
  EXPECT_EQ(run("compile " + ggx + " -o " + file("out") + " --dump-after help").text, stages.text);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  EXPECT_EQ(run("compile " + ggx).exit, 2);
}

TEST_F(Cli, TablesAcceptColourComponentNames) {
  const std::string function = file(
      "f.json",
      R"({"isoshade": 1, "function": "f", "inputs": {"c": {"type": "color3"}}, "outputs": {"out": "c"}})");
  const std::string table = file("in.csv", "c.b,c.r,c.g\n4,1,2\n");
  EXPECT_EQ(run("eval " + function + " --inputs " + table + " --backend interpreter").text,
            "out.x,out.y,out.z\n0x1p+0,0x1p+1,0x1p+2\n");
}

TEST_F(Cli, DumpAfterPrintsEveryStage) {
  const std::string command = "compile " + ggx + " -o " + file("out") + " --quiet --dump-after ";
  std::istringstream stages(run(command + "help").text);
  int count = 0;
  for (std::string stage; std::getline(stages, stage); ++count)
    EXPECT_NE(run(command + stage).text.find("# after " + stage + "\n"), std::string::npos) << stage;
  EXPECT_GE(count, 10);
  EXPECT_EQ(run(command + "nowhere").exit, 2);
}

TEST_F(Cli, FmtFormatsInPlaceAndChecks) {
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

TEST_F(Cli, DrawWritesSvgPngAndDot) {
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

TEST_F(Cli, DiagnosticsJsonHasPositionsAndPointers) {
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

TEST_F(Cli, WarningOptionsAreRespected) {
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

TEST_F(Cli, FilesOutsideTheCollectionNeedAllowOutside) {
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
