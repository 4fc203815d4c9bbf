// SPDX-License-Identifier: Apache-2.0
// The parsed command line. Only arguments.cpp and options.cpp include CLI11, which takes longer to compile than
// the rest together.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <isoshade/compiler.h>

#include "compiler/functions/tier.h"
#include "compiler/interface/skips.h"
#include "compiler/support/process.h"

namespace isoshade::cli {

/// Exit codes of every subcommand.
enum Exit : int {
  success = 0,    ///< verify: identical
  different = 1,  ///< verify: a bit differs, or a hash is not the recorded one; --fail-on-nan
  failure = 2,    ///< an error, reported on stderr
};

struct Size {
  int width = 0;
  int height = 0;
};

/// Options of every subcommand that runs programs.
struct BackendChoice {
  std::string lanes;   ///< "1" "4" "8" "16" "8x2" "16x2"; empty: the widest that the machine has
  int threads = 0;     ///< 0: one for each core
  std::string device;  ///< part of the name of a Vulkan device, or its number; empty: a CPU device if there is one
  std::string compiler;  ///< for generated C++; empty: $ISOSHADE_CXX, c++, g++, clang++
  std::string division;  ///< "native" or "exact"; empty: as the probe decides
};

/// Options that override values of a scene document.
struct SceneChanges {
  std::vector<std::string> settings;  ///< name.parameter=value
  std::string mesh;                   ///< a glTF file to show instead of the scene's mesh; empty: none
  std::optional<float> time;          ///< in seconds
  std::optional<int> samples;         ///< per pixel
};

/// How the image file of a subcommand is written.
struct OutputChoice {
  std::string format;          ///< an entry of scene::image_formats(); empty: as the name ends, PNG for "-"
  std::string compression;     ///< an entry of scene::lossless_compressions; empty: zip
  std::optional<int> quality;  ///< of JPEG
};

struct CompileArguments {
  std::string graph;
  std::string output;
  std::vector<std::string> targets;  ///< empty: all usual ones that have such a wrapper, glsl and cpp
  Wrapper wrapper = Wrapper::none;
  bool hardware_samplers = false;  ///< of a forward pair
  std::string prefix;
  std::string division = "native";
  bool check = false;  ///< the reflection says what is proved
  std::vector<std::string> settings;  ///< PARAMETER=VALUE: what the programs are for
  functions::Tier precision = functions::Tier::standard;
  std::string depfile;         ///< receives the names of all files that were read; empty: none
  bool without_lanes = false;  ///< the program has the headers of isoshade/lanes
  std::string dump_after;
  bool explain = false;  ///< print what is computed, and what fell away
};

/// Times of pictures: `count` of them from `first` to `last`, both included; or all at the scene's time.
struct FrameTimes {
  float first = 0, last = 0;
  int count = 1;
  bool at_scene_time = false;
};

struct RenderArguments {
  std::string scene;
  std::string output;  ///< empty: frames are only measured
  OutputChoice output_choice;
  std::string backend = "cpu";
  std::optional<Size> size;
  std::optional<FrameTimes> frames;
  bool turntable = false;  ///< the camera turns once about its target over the frames
  SceneChanges changes;
  bool stats = false;
  std::string stats_json;  ///< a file for the times of all frames, or "-"; empty: none
  bool fail_on_nan = false;
  interface::Skips skips;
  functions::Tier precision = functions::Tier::standard;
  BackendChoice choice;
};

/// A parameter of `sheet`, and its values as `--set` takes them.
struct VariedParameter {
  std::string name;
  std::vector<std::string> values;
};

struct SheetArguments {
  std::string scene;
  std::string output;
  OutputChoice output_choice;
  std::vector<VariedParameter> axes;  ///< 1 or 2: along columns, along rows
  std::string backend = "cpu";
  std::optional<Size> size;  ///< of each picture
  SceneChanges changes;
  functions::Tier precision = functions::Tier::standard;
  BackendChoice choice;
};

struct VerifyArguments {
  std::vector<std::string> scenes;
  std::vector<std::string> backends{"cpu", "vulkan"};
  std::vector<Size> sizes;
  SceneChanges changes;
  std::vector<std::string> lanes;  ///< one cpu backend for each
  std::string report;
  std::string golden;
  bool update = false;
  bool fail_on_nan = false;
  interface::Skips skips;
  functions::Tier precision = functions::Tier::standard;
  BackendChoice choice;
};

struct EvalArguments {
  std::string function;
  std::string inputs;
  std::string output = "-";
  std::string backend = "cpu";
  functions::Tier precision = functions::Tier::standard;
  BackendChoice choice;
};

/// A range to which `check` restricts an input, or the scalar product or clamp computed by a node.
struct NamedRange {
  std::string name;
  float lo = 0, hi = 0;
};

struct CheckArguments {
  std::vector<std::string> documents;
  std::vector<NamedRange> where;
  std::vector<std::string> settings;
  functions::Tier precision = functions::Tier::standard;
  std::string output;  ///< file for the table of counterexamples; empty: none is written
};

struct FormatArguments {
  std::vector<std::string> documents;
  bool check = false;
};

struct DrawArguments {
  std::string graph;
  std::string output;
  int depth = 1;  ///< how many levels of called functions are drawn
  std::vector<std::string> settings;    ///< parameter=value
  bool after_specialisation = false;    ///< what compiling for them leaves out is grey
};

struct PageArguments {
  std::string scene;
  std::string output;
  SceneChanges changes;
  functions::Tier precision = functions::Tier::standard;
  BackendChoice choice;
};

struct BenchArguments {
  std::string output;  ///< a folder; empty: print only the summary
  std::string only;    ///< part of the names of effects; empty: all
  bool quick = false;
  bool without_picture = false;
  bool without_vulkan = false;
  bool frames = false;              ///< measure frames by step, not computations
  std::vector<int> sizes;           ///< of frames; empty: 256 to 4096
  int repetitions = 0;              ///< 0: as many as usual
  std::vector<std::string> lanes;  ///< of the cpu backend; empty: all that the machine has
  BackendChoice choice;
};

struct CacheArguments {
  bool clear = false;
};

struct DevicesArguments {
  BackendChoice choice;
  bool probe = false;  ///< also where the cache has its result
};

struct NodesArguments {
  std::string name;       ///< empty: list all
  bool markdown = false;  ///< list all as the tables of graphs/README.md
};

struct SchemaArguments {
  bool reflection = false;  ///< of reflections, not of documents
  bool stats = false;       ///< of the times of frames
  bool markdown = false;    ///< the keys of scenes or reflections, as the manual's tables
};

struct Common {
  bool quiet = false;
  bool json = false;  ///< print diagnostics as a JSON array, and nothing else on stderr
  bool warnings_as_errors = false;
  std::vector<std::string> disabled;                             ///< ids of warnings
  bool allow_outside = false;                                    ///< documents may name files in any folder
  support::Seconds build_timeout = support::default_time_limit;  ///< for each run of a compiler, Graphviz or gnuplot
  std::string library;  ///< the folder of library documents; empty: check::shipped_library()
};

struct Arguments {
  Common common;
  std::optional<CompileArguments> compile;
  std::optional<RenderArguments> render;
  std::optional<SheetArguments> sheet;
  std::optional<VerifyArguments> verify;
  std::optional<EvalArguments> eval;
  std::optional<CheckArguments> check;
  std::optional<FormatArguments> format;
  std::optional<DrawArguments> draw;
  std::optional<PageArguments> page;
  std::optional<BenchArguments> bench;
  std::optional<CacheArguments> cache;
  std::optional<DevicesArguments> devices;
  std::optional<NodesArguments> nodes;
  std::optional<SchemaArguments> schema;
};

/// Returns arguments with exactly one subcommand set; or nothing, and sets `exit` (after --help, --version or an error).
std::optional<Arguments> parse_arguments(int argc, char** argv, int& exit);

}  // namespace isoshade::cli
