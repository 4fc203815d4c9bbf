// SPDX-License-Identifier: Apache-2.0
// The command line as values. Only arguments.cpp knows CLI11, which takes longer to compile than all the rest.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "compiler/functions/tier.h"
#include "compiler/support/process.h"

namespace isoshade::cli {

/// Exit codes of every subcommand.
enum Exit : int {
  success = 0,    ///< done; for verify: identical
  different = 1,  ///< verify: some bit differs, or a hash is not the recorded one; --fail-on-nan
  failure = 2,    ///< an error, told on stderr
};

struct Size {
  int width = 0;
  int height = 0;
};

/// What every subcommand that runs programs understands.
struct BackendChoice {
  std::string lanes;   ///< "1" "4" "8" "16" "8x2" "16x2"; empty: the widest of the machine
  int threads = 0;     ///< 0: every core
  std::string device;  ///< part of a Vulkan device's name, or its number; empty: a CPU device if there is one
  std::string compiler;  ///< of generated C++; empty: $ISOSHADE_CXX, c++, g++, clang++
  std::string division;  ///< "", "native" or "exact": overrides what the probe chose
};

/// What a command shows otherwise than a scene's document says.
struct SceneChanges {
  std::vector<std::string> settings;  ///< name.parameter=value
  std::string mesh;                   ///< a glTF file in place of the scene's; empty: none
  std::optional<float> time;          ///< in seconds
  std::optional<int> samples;         ///< of each pixel
};

struct CompileArguments {
  std::string graph;
  std::string output;
  std::vector<std::string> targets{"glsl", "cpp"};
  std::string division = "native";
  functions::Tier precision = functions::Tier::standard;
  std::string dump_after;
};

struct RenderArguments {
  std::string scene;
  std::string output;
  std::string backend = "cpu";
  std::optional<Size> size;
  SceneChanges changes;
  bool stats = false;
  bool fail_on_nan = false;
  functions::Tier precision = functions::Tier::standard;
  BackendChoice choice;
};

struct VerifyArguments {
  std::vector<std::string> scenes;
  std::vector<std::string> backends{"cpu", "vulkan"};
  std::vector<Size> sizes;
  SceneChanges changes;
  std::vector<std::string> lanes;  ///< each makes a cpu backend
  std::string report;
  std::string golden;
  bool update = false;
  bool fail_on_nan = false;
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

/// Where an input, or the scalar product that a node gives, shall lie.
struct NamedRange {
  std::string name;
  float lo = 0, hi = 0;
};

struct CheckArguments {
  std::vector<std::string> documents;
  std::vector<NamedRange> where;
  functions::Tier precision = functions::Tier::standard;
  std::string output;  ///< a table of counterexamples; empty: none is written
};

struct FormatArguments {
  std::vector<std::string> documents;
  bool check = false;
};

struct DrawArguments {
  std::string graph;
  std::string output;
  int depth = 1;  ///< of called functions that are drawn inside
};

struct BenchArguments {
  std::string output;  ///< a folder; empty: only the summary
  std::string only;    ///< a part of the names of effects; empty: all
  bool quick = false;
  bool without_picture = false;
  bool without_vulkan = false;
  std::vector<std::string> lanes;  ///< of the cpu; empty: all of the machine
  BackendChoice choice;
};

struct CacheArguments {
  bool clear = false;
};

struct DevicesArguments {
  BackendChoice choice;
};

struct NodesArguments {
  std::string name;       ///< empty: all
  bool markdown = false;  ///< all, as the manual's tables
};

struct SchemaArguments {};

struct Common {
  bool quiet = false;
  bool json = false;  ///< diagnostics as a JSON array, and nothing else on stderr
  bool warnings_as_errors = false;
  std::vector<std::string> disabled;                             ///< ids of warnings
  bool allow_outside = false;                                    ///< documents may name files anywhere
  support::Seconds build_timeout = support::default_time_limit;  ///< of each compiler and drawing program
  std::string library;  ///< the folder of library documents; empty: found beside the command or as installed
};

struct Arguments {
  Common common;
  std::optional<CompileArguments> compile;
  std::optional<RenderArguments> render;
  std::optional<VerifyArguments> verify;
  std::optional<EvalArguments> eval;
  std::optional<CheckArguments> check;
  std::optional<FormatArguments> format;
  std::optional<DrawArguments> draw;
  std::optional<BenchArguments> bench;
  std::optional<CacheArguments> cache;
  std::optional<DevicesArguments> devices;
  std::optional<NodesArguments> nodes;
  std::optional<SchemaArguments> schema;
};

/// Exactly one subcommand is set, or `exit` is (help, version, a wrong command line).
std::optional<Arguments> parse_arguments(int argc, char** argv, int& exit);

}  // namespace isoshade::cli
