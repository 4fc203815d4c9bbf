// SPDX-License-Identifier: Apache-2.0
#include "runtime/cli/arguments.h"

#include <CLI/CLI.hpp>
#include <iostream>

#include "compiler/support/diagnostics.h"
#include "compiler/support/parse_number.h"
#include "runtime/cli/places.h"

namespace isoshade::cli {

namespace {

constexpr const char* footer =
    "Exit codes: 0 success (verify: identical), 1 different (verify, fmt --check), not proved (check) or not\n"
    "finite (--fail-on-nan), 2 error.\n"
    "The options of `isoshade --help` stand before or after the subcommand.\n"
    "\"-\" is standard input or output. Errors go to standard error.";

bool parse_size(const std::string& text, Size& size) {
  const size_t x = text.find('x');
  if (x == std::string::npos || text.size() > 11) return false;
  const auto number = [](const std::string& digits, int& out) {
    if (digits.empty() || digits.size() > 5 || digits.find_first_not_of("0123456789") != std::string::npos)
      return false;
    out = std::stoi(digits);
    return out >= 1 && out <= 8192;
  };
  return number(text.substr(0, x), size.width) && number(text.substr(x + 1), size.height);
}

const CLI::Validator size_text(
    [](std::string& text) {
      Size size;
      return parse_size(text, size) ? std::string()
                                    : "\"" + text + "\" is no size: write WxH, 1x1 to 8192x8192";
    },
    "WxH");

std::optional<NamedRange> parse_range(const std::string& text) {
  const size_t equals = text.find('='), colon = text.find(':', std::min(equals, text.size()));
  if (equals == 0 || equals == std::string::npos || colon == std::string::npos) return std::nullopt;
  const auto lo =
      support::parse_float_in_range(std::string_view(text).substr(equals + 1, colon - equals - 1));
  const auto hi = support::parse_float_in_range(std::string_view(text).substr(colon + 1));
  if (!lo || !hi || !(*lo <= *hi)) return std::nullopt;
  return NamedRange{text.substr(0, equals), *lo, *hi};
}

const CLI::Validator range_text(
    [](std::string& text) {
      return parse_range(text) ? std::string()
                               : "\"" + text + "\" is no range: write NAME=LEAST:MOST, as roughness=0.1:1";
    },
    "NAME=LEAST:MOST");

/// CLI::Range takes what is no number.
const CLI::Validator time_text(
    [](std::string& text) {
      const auto time = support::parse_float_in_range(text);
      return time && *time >= -1e9f && *time <= 1e9f ? std::string()
                                                     : "\"" + text + "\" is no number from -1e9 to 1e9";
    },
    "SECONDS");

const CLI::Validator limit_text(
    [](std::string& text) {
      const auto limit = support::parse_float_in_range(text);
      return limit && *limit >= 0.001f && *limit <= 86400
                 ? std::string()
                 : "\"" + text + "\" is no number of seconds from 0.001 to 86400";
    },
    "SECONDS");

/// "error" or "no-" and the id of a warning.
const CLI::Validator warning_text(
    [](std::string& text) -> std::string {
      if (text == "error") return "";
      std::string ids;
      for (const support::Id id : support::all_ids()) {
        if (support::default_severity(id) != support::Severity::warning) continue;
        if (text == "no-" + std::string(support::id_text(id))) return "";
        ids += (ids.empty() ? "" : ", ") + std::string(support::id_text(id));
      }
      return "-W" + text + " is neither -Werror nor -Wno-ID; the warnings are " + ids;
    },
    "error|no-ID");

const CLI::IsMember backend_names({"cpu", "vulkan", "interpreter", "reference"});
/// Of backends that must agree in every bit.
const CLI::Validator compared_names(
    [](std::string& name) -> std::string {
      if (name != "reference") return backend_names(name);
      return "the reference does not round, and so is identical to nothing; it is for `render` and `eval`";
    },
    "cpu,vulkan,interpreter");
const CLI::IsMember lane_names({"1", "4", "8", "16", "8x2", "16x2"});
const CLI::IsMember division_names({"native", "exact"});

void add_fail_on_nan(CLI::App& app, bool& fail) {
  app.add_flag("--fail-on-nan", fail, "Exit with 1 if a pixel is infinite or NaN, before or after the posts");
}

void add_precision(CLI::App& app, functions::Tier& precision) {
  const auto choose = [&precision](const std::string& name) { precision = *functions::find_tier(name); };
  app.add_option_function<std::string>(
         "--precision", choose,
         "How exact functions are: fast, default or precise; in each all backends give the same bits")
      ->check(CLI::IsMember({"fast", "default", "precise"}))
      ->default_str("default");
}

void add_choice(CLI::App& app, BackendChoice& choice, bool lanes = true) {
  if (lanes)
    app.add_option("--lanes", choice.lanes, "Lanes of the cpu backend (default: the machine's widest)")
        ->check(lane_names);
  app.add_option("--threads", choice.threads, "Threads of the cpu backend (default: every core)")
      ->check(CLI::Range(1, 1024));
  app.add_option("--device", choice.device,
                 "Vulkan device: part of its name, or its number in `isoshade devices`");
  app.add_option("--division", choice.division, "Force how vulkan divides (default: what the probe finds)")
      ->check(division_names);
  app.add_option("--cxx", choice.compiler,
                 "Compiler of generated C++ (default: $ISOSHADE_CXX, c++, g++, clang++)");
}

void add_changes(CLI::App& app, SceneChanges& changes) {
  app.add_option("--set", changes.settings,
                 "Override a parameter: NAME.PARAMETER=VALUE, or PARAMETER=VALUE if only one has it")
      ->take_all();
  app.add_option("--mesh", changes.mesh,
                 "A glTF file (.gltf, .glb) in place of the scene's one, or of its only object's mesh");
  app.add_option("--time", changes.time, "Seconds for the node `time` instead of the scene's")
      ->check(time_text);
  app.add_option("--samples", changes.samples,
                 "Samples of each pixel, averaged, instead of the scene's: 1, 4 or 16")
      ->check(CLI::IsMember({"1", "4", "16"}));
}

std::string subcommand_names(const CLI::App& app) {
  std::string names;
  for (const CLI::App* subcommand : app.get_subcommands(nullptr))
    names += (names.empty() ? "" : ", ") + subcommand->get_name();
  return names;
}

/// A line for a subcommand that is misspelt; empty if none is near.
std::string near_subcommand(const CLI::App& app, int argc, char** argv) {
  std::vector<std::string_view> names;
  for (const CLI::App* subcommand : app.get_subcommands(nullptr)) names.push_back(subcommand->get_name());
  for (int i = 1; i < argc; ++i) {
    if (argv[i][0] == '-') continue;
    const std::string_view near = support::nearest(argv[i], names);
    return near.empty() ? "" : "Did you mean \"" + std::string(near) + "\"?\n";
  }
  return "";
}

}  // namespace

std::optional<Arguments> parse_arguments(int argc, char** argv, int& exit) {
  CLI::App app(
      "Compiles shader graphs to GLSL and C++, renders scenes with both, and proves the images identical.",
      "isoshade");
  app.footer(footer);
  app.set_version_flag("--version", std::string(version));
  app.require_subcommand(0, 1);  // so that a wrong word is named; none at all is refused below
  app.fallthrough();

  Arguments parsed;
  app.add_flag("-q,--quiet", parsed.common.quiet, "Print results, warnings and errors only");
  std::string diagnostics = "text";
  app.add_option("--diagnostics", diagnostics, "How errors and warnings are told: text, or json for tools")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
  std::vector<std::string> warnings;
  app.add_option("-W", warnings, "-Werror: warnings are errors; -Wno-ID: without the warnings of this id")
      ->check(warning_text)
      ->expected(1)
      ->take_all();
  app.add_flag("--allow-outside", parsed.common.allow_outside,
               "Let documents name files outside of their folder tree and the library");
  app.add_option_function<std::string>(
         "--build-timeout",
         [&parsed](const std::string& text) {
           parsed.common.build_timeout = support::Seconds(*support::parse_float_in_range(text));
         },
         "Seconds after which a C++ compiler, Graphviz or gnuplot that has not ended is ended")
      ->check(limit_text)
      ->default_str("120");
  app.add_option("--library", parsed.common.library, "Folder of the library's function documents")
      ->envname("ISOSHADE_LIBRARY")
      ->check(CLI::ExistingDirectory);

  CompileArguments compile;
  CLI::App* compile_app =
      app.add_subcommand("compile", "Write the programs of a graph as GLSL, C++ and SPIR-V");
  compile_app->add_option("GRAPH", compile.graph, "A function, effect or post document")->required();
  compile_app->add_option("-o,--output", compile.output,
                          "The folder to write to; with --dump-after it may be left out");
  compile_app->add_option("--target", compile.targets, "What to write: glsl, cpp, spirv")
      ->delimiter(',')
      ->check(CLI::IsMember({"glsl", "cpp", "spirv"}))
      ->capture_default_str();
  compile_app->add_option("--division", compile.division, "How the GLSL divides: native or exact")
      ->check(division_names)
      ->capture_default_str();
  add_precision(*compile_app, compile.precision);
  compile_app->add_option(
      "--dump-after", compile.dump_after,
      "Print what a stage made: document, graph, typed, lower, a pass, or `help` for the list");

  RenderArguments render;
  std::string render_size;
  CLI::App* render_app = app.add_subcommand("render", "Render a scene to an image");
  render_app->add_option("SCENE", render.scene, "A scene document")->required();
  render_app
      ->add_option("-o,--output", render.output,
                   "FILE.png (encoded, 8 bits) or FILE.exr (linear, with depth)")
      ->required();
  render_app
      ->add_option(
          "--backend", render.backend,
          "cpu, vulkan, interpreter or reference (the graph as authored, in high precision, up to 256x256)")
      ->check(backend_names)
      ->capture_default_str();
  render_app->add_option("--size", render_size, "Size in pixels instead of the scene's")->check(size_text);
  render_app->add_flag("--stats", render.stats,
                       "Say what was drawn, what was skipped and why, and what each step took");
  add_fail_on_nan(*render_app, render.fail_on_nan);
  add_precision(*render_app, render.precision);
  add_changes(*render_app, render.changes);
  add_choice(*render_app, render.choice);

  VerifyArguments verify;
  std::vector<std::string> verify_sizes;
  CLI::App* verify_app =
      app.add_subcommand("verify", "Render scenes on several backends and compare every bit");
  verify_app->add_option("SCENE", verify.scenes, "Scene documents")->required();
  verify_app
      ->add_option("--backends", verify.backends, "Backends to compare with the first, separated by commas")
      ->delimiter(',')
      ->check(compared_names)
      ->capture_default_str();
  verify_app->add_option("--size", verify_sizes, "Sizes instead of the scene's, separated by commas")
      ->delimiter(',')
      ->check(size_text);
  verify_app
      ->add_option("--lanes", verify.lanes,
                   "Lane counts of the cpu backend, each compared, separated by commas")
      ->delimiter(',')
      ->check(lane_names);
  verify_app->add_option("--report", verify.report,
                         "Where images differ, write both and a heat map to this folder");
  CLI::Option* golden = verify_app->add_option("--golden", verify.golden,
                                               "A file of recorded hashes, of each scene at its own size");
  golden->excludes(verify_app->get_option("--size"));
  verify_app->add_flag("--update", verify.update, "Record the hashes in the golden file instead");
  add_fail_on_nan(*verify_app, verify.fail_on_nan);
  add_precision(*verify_app, verify.precision);
  add_changes(*verify_app, verify.changes);
  add_choice(*verify_app, verify.choice, false);

  EvalArguments eval;
  CLI::App* eval_app = app.add_subcommand("eval", "Evaluate a function document over a table");
  eval_app->add_option("FUNCTION", eval.function, "A function document")->required();
  eval_app
      ->add_option("--inputs", eval.inputs,
                   "A CSV file: a column an input; of vectors l.x l.y l.z, of colours c.r c.g c.b too")
      ->required();
  eval_app->add_option("-o,--output", eval.output, "The CSV file to write")->capture_default_str();
  eval_app
      ->add_option("--backend", eval.backend,
                   "cpu, vulkan, interpreter (hex floats) or reference (the graph as authored: 40 digits)")
      ->check(backend_names)
      ->capture_default_str();
  add_precision(*eval_app, eval.precision);
  add_choice(*eval_app, eval.choice);

  CheckArguments check;
  CLI::App* check_app = app.add_subcommand(
      "check", "Prove that documents give finite numbers for all inputs they allow, and bound their error");
  check_app->add_option("DOCUMENT", check.documents, "Function, effect and post documents")->required();
  check_app->add_option("-o,--output", check.output,
                        "Write the counterexamples of a function to this CSV file, as a table for `eval`");
  std::vector<std::string> ranges;
  check_app
      ->add_option("--where", ranges,
                   "Only inputs that lie so; also of the scalar product or clamp that a node gives")
      ->check(range_text);
  add_precision(*check_app, check.precision);

  FormatArguments format;
  CLI::App* format_app = app.add_subcommand("fmt", "Bring documents into canonical layout, in place");
  format_app->add_option("DOCUMENT", format.documents, "Documents; - reads stdin and writes stdout")
      ->required();
  format_app->add_flag("--check", format.check, "Change nothing; list what is not canonical and end with 1");

  DrawArguments draw;
  CLI::App* draw_app = app.add_subcommand("draw", "Draw a graph as a picture, by Graphviz");
  draw_app->add_option("GRAPH", draw.graph, "A function, effect or post document")->required();
  draw_app->add_option("-o,--output", draw.output, "FILE.svg, FILE.png or FILE.dot")->required();
  draw_app->add_option("--depth", draw.depth, "How deep called functions are drawn inside each other")
      ->check(CLI::Range(0, 16))
      ->capture_default_str();

  BenchArguments bench;
  CLI::App* bench_app = app.add_subcommand(
      "bench", "Measure run time against error: forms, precisions, lane counts, vulkan and GLSL's built-ins");
  bench_app->add_option("-o,--output", bench.output,
                        "A folder for bench.csv, bench.json, bench.gp and bench.svg (by gnuplot)");
  bench_app->add_option("--only", bench.only, "Only effects, functions and scenes with this in their names");
  bench_app->add_flag("--quick", bench.quick, "Few rows and repetitions: a look, not a measurement");
  bench_app->add_flag("--no-picture", bench.without_picture, "The tables alone: gnuplot is not needed");
  bench_app->add_flag("--no-vulkan", bench.without_vulkan, "The cpu alone");
  bench_app
      ->add_option("--lanes", bench.lanes, "Lane counts of the cpu backend (default: all of the machine)")
      ->delimiter(',')
      ->check(lane_names);
  add_choice(*bench_app, bench.choice, false);

  CacheArguments cache;
  CLI::App* cache_app =
      app.add_subcommand("cache", "Tell where compiled C++ is kept, and how much of it there is");
  cache_app->add_flag("--clear", cache.clear,
                      "Delete all that is kept; it is compiled again when it is needed");

  DevicesArguments devices;
  CLI::App* devices_app =
      app.add_subcommand("devices", "List Vulkan devices and what the probe finds on each");
  devices_app->add_option("--device", devices.choice.device, "Only this device");

  NodesArguments nodes;
  CLI::App* nodes_app = app.add_subcommand("nodes", "List the nodes of the language and the functions of the library, or tell all of one");
  CLI::Option* node = nodes_app->add_option("NAME", nodes.name, "A node: its ports, domain, cost and error; a function by its library name: its ports and ranges; a function of expressions: its arguments");
  nodes_app->add_flag("--markdown", nodes.markdown, "All nodes as the tables of graphs/README.md")
      ->excludes(node);

  CLI::App* schema_app =
      app.add_subcommand("schema", "Print the JSON Schema (draft-07) of all documents, for editors");

  try {
    app.parse(argc, argv);
    if (compile_app->parsed() && compile.output.empty() && compile.dump_after.empty())
      throw CLI::RequiredError("--output");
  } catch (const CLI::ParseError& error) {
    // CLI11's own codes are for its own kinds of error; ours are documented.
    exit = app.exit(error) == 0 ? Exit::success : Exit::failure;
    if (exit == Exit::failure && app.get_subcommands().empty())
      std::cerr << "The subcommands are: " << subcommand_names(app) << "\n"
                << near_subcommand(app, argc, argv);
    return std::nullopt;
  }
  if (app.get_subcommands().empty()) {
    std::cerr << "one of the subcommands is needed: " << subcommand_names(app) << "\n"
              << "Run with --help for more information.\n";
    exit = Exit::failure;
    return std::nullopt;
  }
  parsed.common.json = diagnostics == "json";
  parsed.common.quiet |= parsed.common.json;
  for (const std::string& warning : warnings) {
    if (warning == "error")
      parsed.common.warnings_as_errors = true;
    else
      parsed.common.disabled.push_back(warning.substr(3));
  }
  if (!render_size.empty()) {
    render.size.emplace();
    parse_size(render_size, *render.size);
  }
  for (const std::string& text : verify_sizes) parse_size(text, verify.sizes.emplace_back());
  if (compile_app->parsed()) parsed.compile = compile;
  if (render_app->parsed()) parsed.render = render;
  if (verify_app->parsed()) parsed.verify = verify;
  if (eval_app->parsed()) parsed.eval = eval;
  for (const std::string& range : ranges) check.where.push_back(*parse_range(range));
  if (check_app->parsed()) parsed.check = check;
  if (format_app->parsed()) parsed.format = format;
  if (draw_app->parsed()) parsed.draw = draw;
  if (bench_app->parsed()) parsed.bench = bench;
  if (cache_app->parsed()) parsed.cache = cache;
  if (devices_app->parsed()) parsed.devices = devices;
  if (nodes_app->parsed()) parsed.nodes = nodes;
  if (schema_app->parsed()) parsed.schema.emplace();
  return parsed;
}

}  // namespace isoshade::cli
