// SPDX-License-Identifier: Apache-2.0
// Signals, time limits, file and memory limits: the command leaves no files or processes, and reports what failed.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include "tests/unit/command.h"

namespace isoshade {
namespace {

using namespace testing;

class CliProcess : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    fs::create_directories(folder_ / "cache");
    fs::create_directories(folder_ / "temporary");
    surroundings_ = "XDG_CACHE_HOME=" + file("cache") + " TMPDIR=" + file("temporary") + " ";
    file("plain.json", R"({"isoshade": 1, "effect": "plain",
      "nodes": {"c": {"type": "vertexcolor"}}, "passes": [{"name": "base", "color": "c"}]})");
    scene_ = file("s.json", scene_text("s"));
  }

  static std::string scene_text(const std::string& name) {
    return R"({"isoshade": 1, "scene": ")" + name + R"(", "size": [8, 8],
      "camera": {"position": [0, 0, 2], "target": [0, 0, 0]},
      "objects": {"model": {"mesh": "box", "effect": "plain.json"}}})";
  }

  std::string command(const std::string& arguments) const {
    return surroundings_ + ISOSHADE_COMMAND + " " + arguments;
  }

  /// A program, such as a compiler, that never exits and has a child that never exits. It writes both process ids to files
  /// in its folder.
  std::string endless(const std::string& name) const {
    const std::string path =
        file(name, "#!/bin/sh\n[ \"$1\" = --version ] && echo c++ 1.0 && exit\necho $$ >" + file("program") +
                       "\nsleep 1000 & echo $! >" + file("child") + "\nwait\n");
    fs::permissions(path, fs::perms::owner_all);
    return path;
  }
  pid_t number_in(const std::string& name) const {
    pid_t number = 0;
    for (int i = 0; i < 1000 && !(std::ifstream(folder_ / name) >> number); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return number;
  }
  static bool is_gone(pid_t process) {
    for (int i = 0; i < 500; ++i) {
      std::string state;
      std::ifstream facts("/proc/" + std::to_string(process) + "/stat");
      if (!(facts >> state >> state >> state) || state == "Z") return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }
  /// The files that a run has left in these folders, except cache entries.
  std::string left_over() const {
    std::string names;
    for (const char* where : {"", "temporary", "cache/isoshade"}) {
      std::error_code error;
      for (const auto& entry : fs::directory_iterator(folder_ / where, error)) {
        const std::string name = entry.path().filename();
        if (name.find("isoshade-") != std::string::npos || name.find("big") != std::string::npos)
          names += name + " ";
      }
    }
    return names;
  }

  std::string surroundings_, scene_;
};

TEST_F(CliProcess, ASignalStopsTheCompilerAndLeavesNoFiles) {
  const std::string compiler = endless("c++");
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    for (const char* name : {"program", "child"}) fs::remove(folder_ / name);
    const pid_t process = fork();
    if (process == 0) {
      setenv("XDG_CACHE_HOME", file("cache").c_str(), 1);
      execl(ISOSHADE_COMMAND, "isoshade", "verify", scene_.c_str(), "--backends", "cpu,interpreter", "--lanes", "1",
            "--cxx", compiler.c_str(), nullptr);
      _exit(99);
    }
    const pid_t program = number_in("program"), child = number_in("child");
    kill(process, signal);
    int status = 0;
    ASSERT_EQ(waitpid(process, &status, 0), process);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal) << signal << ": " << status;
    EXPECT_TRUE(is_gone(program)) << signal;
    EXPECT_TRUE(is_gone(child)) << signal;
    EXPECT_EQ(left_over(), "") << signal;
  }
}

TEST_F(CliProcess, ACompilerThatHangsIsStoppedAndTheDocumentNamed) {
  const Outcome outcome = run_command(command("verify " + scene_ + " --backends cpu,interpreter --lanes 1 " +
                                              "--build-timeout 0.5 --cxx " + endless("c++")));
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_NE(outcome.text.find("did not compile"), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find("plain.json"), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find("within 0.5 seconds"), std::string::npos) << outcome.text;
  EXPECT_TRUE(is_gone(number_in("child")));
  EXPECT_EQ(left_over(), "");
  EXPECT_EQ(run("render " + scene_ + " --build-timeout 0 -o " + file("a.png")).exit, 2);
  EXPECT_EQ(run("render " + scene_ + " --build-timeout nan -o " + file("a.png")).exit, 2);
}

TEST_F(CliProcess, ACompilerThatHangsDoesNotHoldUpAPictureAndIsStopped) {
  const Outcome outcome =
      run_command(command("render " + scene_ + " --lanes 1 --build-timeout 1 --cxx " + endless("c++") + " -o " + file("a.png")));
  EXPECT_EQ(outcome.exit, 0) << outcome.text;
  EXPECT_TRUE(fs::exists(folder_ / "a.png"));
  EXPECT_TRUE(is_gone(number_in("child")));
}

TEST_F(CliProcess, GraphvizThatHangsIsStopped) {
  endless("dot");
  const Outcome outcome = run_command("PATH=" + folder_.string() + ":/usr/bin:/bin " +
                                      command("draw " + ggx + " --build-timeout 0.5 -o " + file("a.svg")));
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_NE(outcome.text.find("error[no-graphviz]"), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find("ggx_d.json"), std::string::npos) << outcome.text;
  EXPECT_TRUE(is_gone(number_in("child")));
  EXPECT_EQ(left_over(), "");
}

TEST_F(CliProcess, AFileSizeLimitIsReportedAndLeavesNoPartialFile) {
  for (const char* blocks : {"0", "1", "8"}) {
    const Outcome outcome = run_command(
        "ulimit -f " + std::string(blocks) + "; " +
        command("render " + scene_ + " --backend interpreter --size 200x200 -o " + file("big.exr")) +
        "; echo exit $?");
    EXPECT_NE(outcome.text.find("big.exr\": File too large"), std::string::npos) << outcome.text;
    EXPECT_NE(outcome.text.find("ulimit -f"), std::string::npos) << outcome.text;
    EXPECT_NE(outcome.text.find("exit 2"), std::string::npos) << outcome.text;
    EXPECT_EQ(left_over(), "");
  }
  const Outcome compiled = run_command(
      "ulimit -f 1; " + command("verify " + scene_ + " --backends cpu,interpreter --lanes 1") + "; echo exit $?");
  EXPECT_NE(compiled.text.find("File too large"), std::string::npos) << compiled.text;
  EXPECT_NE(compiled.text.find("exit 2"), std::string::npos) << compiled.text;
  EXPECT_EQ(left_over(), "");
}

TEST_F(CliProcess, AReadOnlyDiskIsReportedWithAFix) {
  // A mount that only this process sees; not every machine permits it.
  const std::string mount =
      "unshare -m sh -c 'mount -t tmpfs -o ro,size=1m none " + file("temporary") + " && ";
  if (run_command(mount + "true'").exit != 0) GTEST_SKIP() << "no read-only disk can be mounted";
  const Outcome outcome = run_command(
      mount + command("render " + scene_ + " --backend interpreter -o " + file("temporary") + "/a.png") +
      "; echo exit $?'");
  EXPECT_NE(outcome.text.find("a.png\": Read-only file system"), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find("mounted read-only"), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find("exit 2"), std::string::npos) << outcome.text;
}

TEST_F(CliProcess, AFullDiskIsReportedWithAFix) {
  const std::string mount = "unshare -m sh -c 'mount -t tmpfs -o size=16k none " + file("temporary") + " && ";
  if (run_command(mount + "true'").exit != 0) GTEST_SKIP() << "no small disk can be mounted";
  const Outcome outcome =
      run_command(mount +
                  command("render " + scene_ + " --backend interpreter --size 500x500 -o " +
                          file("temporary") + "/a.exr") +
                  "; echo exit $?; ls -A " + file("temporary") + "'");
  EXPECT_NE(outcome.text.find("a.exr\": No space left on device"), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find("free space"), std::string::npos) << outcome.text;
  EXPECT_TRUE(outcome.text.ends_with("exit 2\n")) << "no file may be left: " << outcome.text;
}

TEST_F(CliProcess, FilesThatAreNotRegularAreRejectedWithoutBlocking) {
  ASSERT_EQ(mkfifo(file("pipe").c_str(), 0600), 0);
  const std::string pipe = file("pipe"), out = " -o " + file("a.png");
  file("in_effect.json",
       R"({"isoshade": 1, "scene": "s", "camera": {"position": [0, 0, 2], "target": [0, 0, 0]},
    "objects": {"model": {"mesh": "box", "effect": "pipe"}}})");
  file("in_mesh.json",
       R"({"isoshade": 1, "scene": "s", "camera": {"position": [0, 0, 2], "target": [0, 0, 0]},
    "objects": {"model": {"mesh": {"type": "gltf", "file": "pipe"}, "effect": "plain.json"}}})");
  file("in_base.json", R"({"isoshade": 1, "scene": "s", "extends": "pipe"})");
  file("textured.json",
       R"({"isoshade": 1, "effect": "textured", "parameters": {"t": {"type": "filename", "value": "pipe"}},
    "nodes": {"uv": {"type": "texcoord"}, "c": {"type": "image", "file": {"link": "t"}, "texcoord": "uv"}},
    "passes": [{"name": "base", "color": "c"}]})");
  file("in_image.json",
       R"({"isoshade": 1, "scene": "s", "camera": {"position": [0, 0, 2], "target": [0, 0, 0]},
    "objects": {"model": {"mesh": "box", "effect": "textured.json"}}})");
  const std::string fast = " --backend interpreter";
  for (const std::string& arguments :
       {"render " + pipe + fast + out, "render /dev/zero" + fast + out,
        "render " + folder_.string() + fast + out, "compile " + pipe + " -o " + file("out"), "check " + pipe,
        "draw " + pipe + " -o " + file("a.svg"), "fmt " + pipe, "eval " + pipe + " --inputs " + pipe + fast,
        "eval " + ggx + " --inputs " + pipe + fast,
        "verify " + scene_ + " --backends interpreter --golden " + pipe,
        "render " + scene_ + " --mesh " + pipe + fast + out, "render " + file("in_effect.json") + fast + out,
        "render " + file("in_mesh.json") + fast + out, "render " + file("in_base.json") + fast + out,
        "render " + file("in_image.json") + fast + out}) {
    const Outcome outcome = run_command("timeout 20 " ISOSHADE_COMMAND " --allow-outside " + arguments);
    EXPECT_EQ(outcome.exit, 2) << arguments << "\n" << outcome.text;
    EXPECT_NE(outcome.text.find("not a regular file"), std::string::npos) << arguments << "\n" << outcome.text;
  }
}

TEST_F(CliProcess, InputsAreNeverOverwritten) {
  file("textured.json",
       R"({"isoshade": 1, "effect": "textured", "parameters": {"t": {"type": "filename", "value": "t.png"}},
    "nodes": {"uv": {"type": "texcoord"}, "c": {"type": "image", "file": {"link": "t"}, "texcoord": "uv"}},
    "passes": [{"name": "base", "color": "c"}]})");
  fs::copy_file(graphs + "/textures/toon_ramp.png", folder_ / "t.png");
  fs::copy_file(folder_ / "textured.json", folder_ / "effect.png");
  fs::copy_file(scene_, folder_ / "base.png");
  fs::copy_file(scene_, folder_ / "scene.png");
  file("scene.png", R"({"isoshade": 1, "scene": "s", "extends": "base.png",
    "objects": {"model": {"effect": "effect.png"}}})");
  fs::create_symlink("t.png", folder_ / "link.png");
  fs::create_hard_link(folder_ / "t.png", folder_ / "second.png");
  for (const char* name : {"t.png", "effect.png", "base.png", "scene.png", "link.png", "second.png"}) {
    const std::string before = read(folder_ / name);
    const Outcome outcome = run("render " + file("scene.png") + " --backend interpreter -o " + file(name));
    EXPECT_EQ(outcome.exit, 2) << name << outcome.text;
    EXPECT_NE(outcome.text.find("would destroy an input"), std::string::npos) << name << outcome.text;
    EXPECT_EQ(read(folder_ / name), before) << name;
  }
  EXPECT_EQ(run("render " + file("scene.png") + " --backend interpreter -o " + file("a.png")).exit, 0);
  // Also a function that another one calls.
  file("inner.json", R"({"isoshade": 1, "function": "inner", "inputs": {"x": {"type": "float"}},
    "nodes": {"n": {"type": "sin", "in": "x"}}, "outputs": {"out": "n"}})");
  const std::string outer =
      file("outer.json", R"({"isoshade": 1, "function": "outer", "inputs": {"x": {"type": "float"}},
    "nodes": {"n": {"type": "inner.json", "x": "x"}}, "outputs": {"out": "n"}})");
  const std::string table = file("x.csv", "x\n1\n");
  EXPECT_EQ(
      run("eval " + outer + " --inputs " + table + " --backend interpreter -o " + file("inner.json")).exit,
      2);
  EXPECT_EQ(run("draw " + outer + " -o " + file("inner.json")).exit, 2);
  EXPECT_EQ(run("check " + outer + " -o " + file("inner.json")).exit, 2);
  EXPECT_EQ(run("check " + outer + " " + file("inner.json") + " -o " + file("twice.csv")).exit, 2);
  EXPECT_NE(read(folder_ / "inner.json").find("\"inner\""), std::string::npos);
}

TEST_F(CliProcess, OutputThroughASymbolicLinkWritesItsTarget) {
  fs::create_directories(folder_ / "deep");
  fs::create_symlink("deep/target.png", folder_ / "one.png");
  fs::create_symlink("one.png", folder_ / "two.png");
  const std::string render = "render " + scene_ + " --backend interpreter -o ";
  for (int i = 0; i < 2; ++i) {  // the link dangles in the first run
    EXPECT_EQ(run(render + file("two.png")).exit, 0);
    EXPECT_TRUE(fs::is_symlink(folder_ / "one.png") && fs::is_symlink(folder_ / "two.png"));
    EXPECT_EQ(read(folder_ / "deep/target.png").substr(1, 3), "PNG");
  }
  fs::create_symlink("nowhere/target.png", folder_ / "lost.png");
  fs::create_symlink("circle.png", folder_ / "circle.png");
  EXPECT_EQ(run(render + file("lost.png")).exit, 2);
  EXPECT_EQ(run(render + file("circle.png")).exit, 2);
  const std::string longest = std::string(251, 'x') + ".png";
  EXPECT_EQ(run(render + file(longest)).exit, 0) << "a name may have 255 characters";
}

TEST_F(CliProcess, ConcurrentUpdatesOfGoldensLoseNoEntry) {
  const std::string golden = file("hashes.json");
  std::string all;
  for (const char* name : {"a", "b", "c", "d", "e", "f"}) {
    const std::string document = file(std::string("scene_") + name + ".json", scene_text(name));
    all += ISOSHADE_COMMAND " verify " + document + " --backends interpreter --golden " + golden +
           " --update & ";
  }
  run_command(all + "wait");
  const std::string text = read(golden);
  for (const char* name : {"a", "b", "c", "d", "e", "f"})
    EXPECT_NE(text.find(std::string("scene_") + name), std::string::npos) << name << " is not in " << text;
  EXPECT_EQ(run("verify " + file("scene_c.json") + " --backends interpreter --golden " + golden).exit, 0);
}

TEST_F(CliProcess, CachePrintsItsFolderAndClears) {
  EXPECT_EQ(run_command(command("verify " + scene_ + " --backends cpu,interpreter --lanes 1")).exit, 0);
  file("cache/isoshade/photo.jpg", "precious");
  const Outcome told = run_command(command("cache"));
  EXPECT_EQ(told.exit, 0);
  EXPECT_NE(told.text.find(file("cache/isoshade") + "\n2 entries"), std::string::npos) << told.text;
  EXPECT_NE(told.text.find("at most 1000"), std::string::npos) << told.text;
  const Outcome cleared = run_command(command("cache --clear"));
  EXPECT_NE(cleared.text.find("2 entries deleted, 0 left"), std::string::npos) << cleared.text;
  EXPECT_EQ(read(folder_ / "cache/isoshade/photo.jpg"), "precious");
}

TEST_F(CliProcess, DevicesTellsWhetherTheProbeRanNow) {
  const Outcome first = run_command(command("devices --device 0"));
  if (first.exit != 0) GTEST_SKIP() << "no Vulkan device: " << first.text;
  if (first.text.find("FAILED") != std::string::npos) GTEST_SKIP() << "the device fails the probe: " << first.text;
  EXPECT_NE(first.text.find("probe run now"), std::string::npos) << first.text;
  const std::string again = run_command(command("devices --device 0")).text;
  EXPECT_NE(again.find("its result is cached"), std::string::npos) << again;
  EXPECT_EQ(again.substr(again.find("ok ")), first.text.substr(first.text.find("ok "))) << "the same checks";
  const std::string anew = run_command(command("devices --device 0 --probe")).text;
  EXPECT_NE(anew.find("probe run now"), std::string::npos) << anew;
  const std::string told = run_command(command("cache")).text;
  EXPECT_NE(told.find("probe results: 1\n"), std::string::npos) << told;
  EXPECT_NE(told.find("SPIR-V shaders: "), std::string::npos) << told;
}

TEST_F(CliProcess, AnUnsafeCacheIsReportedAndNotUsed) {
  fs::create_directories(folder_ / "cache/isoshade");
  fs::permissions(folder_ / "cache/isoshade", fs::perms::all);
  const Outcome outcome = run_command(command("render " + scene_ + " --lanes 1 -o " + file("a.png")));
  EXPECT_EQ(outcome.exit, 0) << outcome.text;
  EXPECT_NE(outcome.text.find("warning[unsafe-cache]"), std::string::npos) << outcome.text;
  EXPECT_TRUE(fs::is_empty(folder_ / "cache/isoshade"));
  EXPECT_EQ(left_over(), "");
}

TEST_F(CliProcess, RunningOutOfMemoryIsReportedAndExitsWithTwo) {
  const auto limited = [&](int mebibytes, const std::string& arguments) {
    return run_command("ulimit -c 0; ulimit -v " + std::to_string(1024 * mebibytes) + "; " +
                       command(arguments));
  };
  int least = 20;  // MiB in which the command can start
  while (least < 400 && limited(least, "--version").exit != 0) least += 5;
  if (least >= 400) GTEST_SKIP() << "this build reserves its address space at start-up";
  EXPECT_EQ(run_command(command("render " + scene_ + " --lanes 1 -o " + file("a.png"))).exit, 0)
      << "fills the cache";
  std::string rows = "n_dot_h,alpha\n";
  for (int i = 0; i < 200000; ++i) rows += "0.5,0.5\n";
  const std::string table = file("large.csv", rows), out = " -o " + file("a.exr");
  std::vector<std::string> all = {
      "render " + scene_ + " --backend interpreter --size 1200x1200" + out,
      "render " + scene_ + " --lanes 1 --size 1200x1200" + out,
      "verify " + scene_ + " --backends interpreter,cpu --lanes 1 --size 1200x1200",
      "check " + graphs + "/library/brdf/lambert.json",
      "compile " + ggx + " --wrapper isoshade --target glsl,cpp,spirv -o " + file("out"),
      "eval " + ggx + " --backend interpreter --inputs " + table + " -o " + file("o.csv"),
      "draw " + ggx + " -o " + file("a.dot")};
#ifdef ISOSHADE_VULKAN
  all.push_back("render " + scene_ + " --backend vulkan" + out);
#endif
  const int step = std::getenv("ISOSHADE_FULL") != nullptr ? 10 : 80;
  int told = 0;
  for (const std::string& arguments : all) {
    const bool driver = arguments.find("vulkan") != std::string::npos;
    for (int more = 0; more <= (driver ? 480 : 120); more += driver ? 2 * step : step) {
      const Outcome outcome = limited(least + more, arguments);
      EXPECT_TRUE(outcome.exit == 0 || outcome.exit == 2)
          << arguments << " in " << least + more << " MiB: " << outcome.exit << "\n"
          << outcome.text;
      if (outcome.exit != 2) continue;
      ++told;
      EXPECT_NE(outcome.text.find("error["), std::string::npos) << arguments << "\n" << outcome.text;
    }
  }
  EXPECT_GE(told, 4) << "the limits are too wide to test anything";
  const Outcome json = limited(least + 5, "--diagnostics json " + all[0]);
  EXPECT_NE(json.text.find("\"id\": \"device-limit\""), std::string::npos) << json.text;
}

TEST_F(CliProcess, AnImageThatExceedsMemoryIsRejectedBeforeAllocation) {
  const Outcome outcome = run_command(
      "ulimit -v 1000000; " +
      command("render " + scene_ + " --backend interpreter --size 8192x8192 -o " + file("a.exr")));
  if (outcome.text.find("cannot allocate memory") != std::string::npos) GTEST_SKIP() << "a sanitizer reports this first";
  EXPECT_EQ(outcome.exit, 2);
  EXPECT_NE(outcome.text.find("the image needs 1.2 GiB of memory"), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find("--size"), std::string::npos) << outcome.text;
}

TEST_F(CliProcess, NumbersOutsideTheRangeOfFloatAreRejected) {
  const std::string eval = "eval " + ggx + " --backend interpreter --inputs ";
  for (const char* number : {"1e400", "-1e400", "1e39", "0x1p200"}) {
    const Outcome outcome = run(eval + file("in.csv", "n_dot_h,alpha\n1," + std::string(number) + "\n"));
    EXPECT_EQ(outcome.exit, 2) << number;
    EXPECT_NE(outcome.text.find("in.csv:2:3: error[bad-table]"), std::string::npos) << outcome.text;
  }
  for (const char* number : {"inf", "-inf", "nan", "3e38", "1e-400"})
    EXPECT_EQ(run(eval + file("in.csv", "n_dot_h,alpha\n1," + std::string(number) + "\n")).exit, 0) << number;
}

TEST_F(CliProcess, IntegersMayBeWrittenAsFloats) {
  std::string text = scene_text("s");
  text.replace(text.find("\"isoshade\": 1"), 13, "\"isoshade\": 1.0");
  text.replace(text.find("[8, 8]"), 6, "[8.0, 0.8e1]");
  const Outcome outcome =
      run("render " + file("v.json", text) + " --backend interpreter -o " + file("a.png"));
  EXPECT_EQ(outcome.exit, 0) << outcome.text;
  for (const char* version : {"1.5", "2.0", "true", "\"1\""}) {
    std::string other = scene_text("s");
    other.replace(other.find("\"isoshade\": 1"), 13, "\"isoshade\": " + std::string(version));
    EXPECT_EQ(run("render " + file("v.json", other) + " --backend interpreter -o " + file("a.png")).exit, 2)
        << version;
  }
}

}  // namespace
}  // namespace isoshade
