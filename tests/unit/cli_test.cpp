// SPDX-License-Identifier: Apache-2.0
// The command line: exit codes, outputs, and messages for wrong usage.
#include <gtest/gtest.h>

#include "tests/unit/command.h"
#include "tests/unit/gltf_files.h"

namespace isoshade {
namespace {

using namespace testing;
namespace fs = std::filesystem;

TEST_F(Cli, PrintsVersionAndExitCodes) {
  EXPECT_EQ(run("--version").text, "isoshade " ISOSHADE_VERSION "\n");
  const Outcome help = run("--help");
  EXPECT_EQ(help.exit, 0);
  EXPECT_NE(help.text.find("Exit codes: 0"), std::string::npos);
}

TEST_F(Cli, UsageErrorsExitWithTwo) {
  for (const char* arguments :
       {"", "paint", "render", "render x.json", "--no-such-flag", "verify a.json --backends gpu",
        "render a.json -o b.png --size 0x5", "render a.json -o b.png --size 9000x1",
        "render a.json -o b.png --lanes 5", "compile a.json", "eval f.json"})
    EXPECT_EQ(run(arguments).exit, 2) << arguments;
}

TEST_F(Cli, MissingFilesAreNamed) {
  const Outcome outcome = run("render " + file("none.json") + " -o " + file("a.png"));
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_NE(outcome.text.find("error[missing-file]"), std::string::npos) << outcome.text;
  EXPECT_FALSE(fs::exists(folder_ / "a.png"));
}

TEST_F(Cli, RendersPngAndExrAndRejectsOtherExtensions) {
  EXPECT_EQ(run("render " + scene + " --size 16x9 -o " + file("a.png")).exit, 0);
  EXPECT_EQ(read(folder_ / "a.png").substr(1, 3), "PNG");
  EXPECT_EQ(run("render " + scene + " --size 16x9 --backend interpreter -o " + file("a.exr")).exit, 0);
  EXPECT_EQ(read(folder_ / "a.exr").substr(0, 4), "\x76\x2f\x31\x01");
  const Outcome outcome = run("render " + scene + " -o " + file("a.bmp"));
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_NE(outcome.text.find(".png"), std::string::npos) << outcome.text;
}

TEST_F(Cli, StandardOutputCarriesTheImageAndNothingElse) {
  const std::string render = "render " + scene + " --size 16x9 --backend interpreter --stats ";
  for (const char* format : {"png", "exr", "jpg", "ppm", "pfm"}) {
    const std::string to = file(std::string("a.") + format), piped = file("piped");
    ASSERT_EQ(run(render + "-o " + to).exit, 0) << format;
    ASSERT_EQ(run(render + "-o - --format " + format + " | cat > " + piped).exit, 0) << format;
    EXPECT_TRUE(read(to) == read(piped)) << format;
    ASSERT_EQ(run(render + "-o /dev/stdout --format " + format + " | cat > " + piped).exit, 0) << format;
    EXPECT_TRUE(read(to) == read(piped)) << format;
  }
  ASSERT_EQ(run(render + "-o - | cat > " + file("piped")).exit, 0);
  EXPECT_TRUE(read(file("a.png")) == read(file("piped")));
  EXPECT_EQ(run(render + "-o - --format png 2>&1 >/dev/full").exit, 2);
}

TEST_F(Cli, OptionsOfFormatsAreRefusedForOthers) {
  const auto message = [&](const std::string& options) {
    const Outcome outcome = run("render " + scene + " --size 16x9 --backend interpreter " + options);
    EXPECT_EQ(outcome.exit, 2) << options;
    return outcome.text;
  };
  EXPECT_NE(message("--compression piz -o " + file("a.png")).find("--compression needs the format exr, not png"), std::string::npos);
  EXPECT_NE(message("--quality 50 -o -").find("--quality needs the format jpg, not png"), std::string::npos);
  EXPECT_NE(message("--format exr -o " + file("a.png")).find("does not fit the format exr"), std::string::npos);
  for (const char* wrong : {"--quality 0", "--quality 101", "--compression dwaa", "--format hdr", "--format gif"})
    message(std::string(wrong) + " -o " + file("a.jpg"));
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(Cli, QualityAndCompressionChangeTheSizeOfFiles) {
  const auto size = [&](const std::string& options, const std::string& name) {
    const Outcome outcome = run("render " + scene + " --size 64x36 --backend interpreter " + options + " -o " + file(name));
    EXPECT_EQ(outcome.exit, 0) << outcome.text;
    return read(file(name)).size();
  };
  EXPECT_LT(size("--quality 30", "a.jpg"), size("", "b.jpg"));
  EXPECT_LT(size("", "b.jpg"), size("--quality 100", "c.jpg"));
  EXPECT_EQ(size("", "z.exr"), size("--compression zip", "z.exr"));
  const size_t whole = size("--compression none", "n.exr");
  EXPECT_GT(whole, size_t{20} * 64 * 36);
  for (const char* compression : {"rle", "zips", "zip", "piz"})
    EXPECT_LT(size(std::string("--compression ") + compression, "c.exr"), whole) << compression;
}

TEST_F(Cli, FilesDoNotDependOnTheNumberOfThreads) {
  const std::string render = "render " + graphs + "/scenes/outline_cube.json --size 400x300 --threads ";
  for (const char* name : {"a.png", "a.exr"}) {
    ASSERT_EQ(run(render + "1 -o " + file(name)).exit, 0);
    const std::string one = read(file(name));
    ASSERT_EQ(run(render + "3 -o " + file(name)).exit, 0);
    EXPECT_TRUE(read(file(name)) == one) << name;
  }
}

TEST_F(Cli, TheReferenceRendersSmallImagesAndPrintsFortyDigits) {
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

TEST_F(Cli, InvalidSettingsAreExplained) {
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

TEST_F(Cli, MeshReplacesTheMeshOfTheOnlyObject) {
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

TEST_F(Cli, VerifyComparesBackendsAndRecordedHashes) {
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
      << "the working directory must not matter";
}

TEST_F(Cli, PrecisionSelectsTheTier) {
  const std::string golden = file("hashes.json");
  const std::string command = "verify " + scene + " --backends cpu --golden " + golden;
  EXPECT_EQ(run(command + " --update").exit, 0);
  EXPECT_EQ(run(command + " --precision fast").exit, 1) << "none is recorded";
  EXPECT_EQ(run(command + " --precision fast --update").exit, 0);
  EXPECT_EQ(run(command + " --precision fast").exit, 0);
  EXPECT_EQ(run(command).exit, 0) << "both tiers are kept";
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

TEST_F(Cli, BenchMeasuresEveryFormPrecisionAndBackend) {
  const Outcome outcome =
      run("bench --quick --only toon_highlight --lanes 1,4 --no-picture -o " + file("bench"));
  EXPECT_EQ(outcome.exit, 0) << outcome.text;
  std::istringstream csv(read(folder_ / "bench/bench.csv"));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line,
            "effect,form,precision,backend,lanes,compute,compute_spread,evaluation,making,nanoseconds,spread,transfer,"
            "cycles,port_cycles,simulated_cycles,spills,busiest,max_ulp,mean_ulp,max_absolute,identical");
  int points = 0;
  while (std::getline(csv, line)) {
    const bool same = line.ends_with(",yes"), yardstick = line.find(",built-ins,") != std::string::npos;
    const bool peer = line.find(",peer,") != std::string::npos;
    EXPECT_TRUE(same || yardstick || peer) << line;
    if (!peer) ++points;
  }
  EXPECT_NE(read(folder_ / "bench/bench.csv").find("toon_highlight,library,peer,glm,1,"), std::string::npos);
  EXPECT_NE(read(folder_ / "bench/bench.md").find("| toon_highlight |"), std::string::npos);
#ifdef ISOSHADE_VULKAN
  EXPECT_EQ(points, 2 * 3 * 3 + 1)
      << "two forms, three precisions, three backends; built-ins for the source's form";
#else
  EXPECT_EQ(points, 2 * 3 * 2);
#endif
  EXPECT_NE(read(folder_ / "bench/bench.json").find("\"max_ulp\""), std::string::npos);
  EXPECT_EQ(run("bench --only no_such_effect").exit, 2);
}

TEST_F(Cli, BenchMeasuresFramesByStep) {
  const Outcome outcome = run("bench --frames --quick --only outline_cube --sizes 32,64 --threads 1 --repetitions 1 " +
                              std::string("--no-vulkan -o ") + file("bench"));
  EXPECT_EQ(outcome.exit, 0) << outcome.text;
  std::istringstream csv(read(folder_ / "bench/frames.csv"));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line, "scene,size,backend,threads,triangles,plan_ms,vertices_ms,clip_ms,draw_ms,posts_ms,whole_ms,spread_ms");
  std::getline(csv, line);
  EXPECT_TRUE(line.starts_with("outline_cube,32,cpu,1,")) << line;
  std::getline(csv, line);
  EXPECT_TRUE(line.starts_with("outline_cube,64,cpu,1,")) << line;
  EXPECT_FALSE(std::getline(csv, line)) << line;
  EXPECT_NE(read(folder_ / "bench/frames.svg").find("outline_cube"), std::string::npos);
  EXPECT_EQ(run("bench --frames --only no_such_scene").exit, 2);
}

std::string hash_of(const std::string& changes) {
  const Outcome outcome = run("verify " + graphs + "/scenes/surface_attributes.json --size 64x36 " +
                              "--backends cpu,interpreter " + changes);
  EXPECT_EQ(outcome.exit, 0) << outcome.text;
  const size_t at = outcome.text.find("sha256 ");
  return outcome.text.substr(at, at == std::string::npos ? at : 71);
}

TEST_F(Cli, SamplesOverridesTheScene) {
  EXPECT_EQ(hash_of("--samples 4"), hash_of("--set samples=4"));
  EXPECT_EQ(hash_of("--samples 1 --set samples=4"), hash_of(""));
  EXPECT_NE(hash_of("--samples 4"), hash_of("--samples 16"));
  const std::string render = "render " + scene + " -o " + file("a.png");
  EXPECT_EQ(run(render + " --samples 5").exit, 2);
  const Outcome large = run(render + " --size 2049x1 --samples 16");
  EXPECT_EQ(large.exit, 2);
  EXPECT_NE(large.text.find("error[too-large]: an image of 16 samples a pixel"), std::string::npos)
      << large.text;
}

TEST_F(Cli, TimeOverridesTheScene) {
  EXPECT_EQ(hash_of(""), hash_of("--time 2.125")) << "the time of the scene";
  EXPECT_NE(hash_of(""), hash_of("--time 2.5"));
  EXPECT_EQ(run("render " + scene + " -o " + file("a.png") + " --time soon").exit, 2);
  for (const char* time : {"nan", "inf", "-2e9", "soon"})
    EXPECT_NE(
        run("render " + scene + " -o " + file("c.png") + " --time " + time).text.find("is not a number from"),
        std::string::npos)
        << time;
}

TEST_F(Cli, StatsListSkippedPosts) {
  const std::string command = "render " + graphs +
                              "/scenes/fog_balls.json --size 16x9 --backend interpreter --stats -o " +
                              file("a.png");
  const Outcome all = run(command);
  EXPECT_NE(all.text.find("posts:    2"), std::string::npos);
  EXPECT_NE(all.text.find("skipped:  operations of the post height_fog: the same for all pixels of a draw (saves "), std::string::npos)
      << all.text;
  EXPECT_NE(all.text.find("\nbuild:    0.0 ms\nvertices: "), std::string::npos) << all.text;  // the interpreter compiles nothing
  const Outcome without = run(command + " --set fog.fog_density=0");
  EXPECT_NE(without.text.find("skipped:  post fog: fog_density is 0"), std::string::npos) << without.text;
  EXPECT_NE(without.text.find("posts:    1"), std::string::npos) << without.text;
}

TEST_F(Cli, ShippedParametersThatChangeOftenAreNotFixed) {
  const auto fixed = [&](const std::string& scene) {
    return run("render " + graphs + "/scenes/" + scene + ".json --size 16x9 --backend interpreter --stats -o " + file("a.png")).text;
  };
  const std::string bloom = fixed("bloom_balls"), cut_outs = fixed("cut_outs");
  EXPECT_NE(bloom.find("of the post bloom_"), std::string::npos) << bloom;
  EXPECT_EQ(bloom.find("exposure"), std::string::npos) << bloom;
  EXPECT_NE(cut_outs.find("of the effect dissolve"), std::string::npos) << cut_outs;
  EXPECT_EQ(cut_outs.find("amount"), std::string::npos) << cut_outs;
}

TEST_F(Cli, EachSkipIsSwitchedOffByItsNameAndAllWithoutOne) {
  const std::string fog = graphs + "/scenes/fog_balls.json --size 16x9 --backend interpreter --stats -o " + file("a.png") +
                          " --set fog.fog_density=0";
  const auto skips = [&](const std::string& options) { return run("render " + options + " " + fog).text; };
  const std::string_view post = "skipped:  post fog: fog_density is 0", parameters = "of the effect cook_torrance";
  const std::string all = skips(""), without_posts = skips("--no-skip posts"), none = skips("--no-skip");
  EXPECT_NE(all.find(post), std::string::npos) << all;
  EXPECT_NE(all.find(parameters), std::string::npos) << all;
  EXPECT_EQ(without_posts.find(post), std::string::npos) << without_posts;
  EXPECT_NE(without_posts.find(parameters), std::string::npos) << without_posts;
  EXPECT_EQ(none.find("skipped:"), std::string::npos) << none;
  EXPECT_NE(skips("--no-skip=posts,parameters").find("the same for all pixels of a draw"), std::string::npos);
  EXPECT_NE(skips("--no-skip pots").find("\"pots\" is not a list of skips"), std::string::npos);
}

TEST_F(Cli, AnUnknownSubcommandListsTheKnownOnes) {
  const Outcome outcome = run("paint");
  EXPECT_NE(outcome.text.find("paint"), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find("compile, render, sheet, verify, eval, check, fmt, draw, page, bench, cache, devices"),
            std::string::npos)
      << outcome.text;
}

TEST_F(Cli, InputsAreNeverOverwritten) {
  const std::string text =
      R"({"isoshade": 1, "function": "f", "inputs": {"x": {"type": "float"}},
          "nodes": {"n": {"type": "sin", "in": "x"}}, "outputs": {"out": "n"}})";
  const std::string function = file("f.json", text), table = file("in.csv", "x\n1\n");
  EXPECT_EQ(run("compile " + function + " -o " + folder_.string()).exit, 2)
      << "the reflection would overwrite f.json";
  EXPECT_FALSE(fs::exists(folder_ / "f.cpp")) << "all or nothing";
  EXPECT_EQ(run("eval " + function + " --inputs " + table + " -o " + function).exit, 2);
  EXPECT_EQ(run("eval " + function + " --inputs " + table + " -o " + table).exit, 2);
  EXPECT_EQ(read(function), text);
  EXPECT_EQ(read(table), "x\n1\n");
  // A later run may overwrite the reflection.
  for (int i = 0; i < 2; ++i) EXPECT_EQ(run("compile " + function + " -o " + file("out")).exit, 0);
}

TEST_F(Cli, WritesToAPipe) {
  const std::string table = file("in.csv", "n_dot_h,alpha\n1,0.5\n");
  EXPECT_EQ(run("eval " + ggx + " --inputs " + table + " -o /dev/stdout | cat").text, "out\n0x1.45f306p+0\n");
}

TEST_F(Cli, StandardInputIsReadOnlyOnce) {
  EXPECT_NE(run("eval - --inputs - < " + ggx).text.find("only once"), std::string::npos);
  EXPECT_NE(run("verify - - < " + scene).text.find("only once"), std::string::npos);
  EXPECT_EQ(run("verify - --golden " + file("g.json") + " --update < " + scene).exit, 2) << "it has no name";
}

TEST_F(Cli, AFailureToWriteStandardOutputIsAnError) {
  const std::string verify = "verify " + scene + " --backends interpreter,interpreter --size 8x8";
  EXPECT_EQ(run(verify).exit, 0);
  EXPECT_EQ(run(verify + " 2>&1 >/dev/full").exit, 2);
  EXPECT_EQ(run(verify + " 2>&1 >&-").exit, 2);
  EXPECT_EQ(
      run("render " + scene + " --backend interpreter --size 8x8 -o " + file("a.png") + " >&- 2>&- <&-").exit,
      0);
  EXPECT_EQ(read(folder_ / "a.png").substr(1, 3), "PNG") << "and nothing else is written to the file";
}

TEST_F(Cli, TheCpuInterpretsWithoutACompilerExceptForVerify) {
  const std::string bare = "env -u ISOSHADE_CXX PATH=/nonexistent ";
  const std::string render = "render " + scene + " --size 8x8 -o " + file("a.png");
  const auto with = [](const std::string& environment, const std::string& arguments) {
    return run_command(environment + ISOSHADE_COMMAND + " " + arguments);
  };
  const Outcome rendered = with("/usr/bin/" + bare, render);
  EXPECT_EQ(rendered.exit, 0);
  EXPECT_NE(rendered.text.find("there is no C++ compiler"), std::string::npos) << rendered.text;
  const Outcome proof =
      with("/usr/bin/" + bare, "verify " + scene + " --backends cpu,interpreter --size 8x8");
  EXPECT_EQ(proof.exit, 2) << "it would compare the interpreter with itself";
  EXPECT_NE(proof.text.find("g++ 12"), std::string::npos) << proof.text;
  EXPECT_EQ(with("ISOSHADE_CXX=/nonexistent ", render).exit, 2) << "a compiler was named, and is not there";
}

}  // namespace
}  // namespace isoshade
