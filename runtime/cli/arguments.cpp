// SPDX-License-Identifier: Apache-2.0
#include "runtime/cli/arguments.h"

#include <algorithm>

#include <CLI/CLI.hpp>
#include <iostream>
#include <isoshade/version.h>
#include <map>

#include "compiler/support/diagnostics.h"
#include "compiler/support/parse_number.h"
#include "compiler/targets/targets.h"
#include "runtime/cli/argument_texts.h"
#include "runtime/cli/options.h"

namespace isoshade::cli {

namespace {

constexpr const char* footer =
    "Exit codes: 0 success (verify: identical), 1 different (verify, fmt --check), not proved (check) or not\n"
    "finite (--fail-on-nan), 2 error.\n"
    "The options of `isoshade --help` may come before or after the subcommand.\n"
    "\"-\" is standard input or output. Errors go to standard error.";

std::string subcommand_names(const CLI::App& app) {
  std::string names;
  for (const CLI::App* subcommand : app.get_subcommands(nullptr))
    names += (names.empty() ? "" : ", ") + subcommand->get_name();
  return names;
}

/// "Did you mean ...?" for a misspelt subcommand; empty if no name is close.
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

/// The names of all targets, and each with what it is.
static std::pair<std::vector<std::string>, std::string> target_texts() {
  std::vector<std::string> names;
  std::string docs;
  const auto add = [&](std::string_view name, std::string_view doc) {
    names.emplace_back(name);
    docs.append(docs.empty() ? "" : ", ").append(name).append(" (").append(doc).append(")");
  };
  for (const emit::Target* target : targets::all()) {
    add(target->name, target->doc);
    if (target->binary != nullptr) add(target->binary->name, target->binary->doc);
  }
  return {names, docs};
}

std::optional<Arguments> parse_arguments(int argc, char** argv, int& exit) {
  CLI::App app(
      "Compiles shader graphs to GLSL and C++, renders scenes with both, and proves the images identical.",
      "isoshade");
  app.footer(footer);
  app.set_version_flag("--version", "isoshade " ISOSHADE_VERSION);
  app.require_subcommand(0, 1);  // so that CLI11 names an unknown word; the case of no subcommand is handled below
  app.fallthrough();

  Arguments parsed;
  app.add_flag("-q,--quiet", parsed.common.quiet, "Print only results, warnings and errors");
  std::string diagnostics = "text";
  app.add_option("--diagnostics", diagnostics, "Format of errors and warnings: text or json")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
  std::vector<std::string> warnings;
  app.add_option("-W", warnings, "-Werror: treat warnings as errors; -Wno-ID: disable the warning with this id")
      ->check(warning_text)
      ->expected(1)
      ->take_all();
  app.add_flag("--allow-outside", parsed.common.allow_outside,
               "Let documents name files outside of their folder and the library");
  app.add_option_function<std::string>(
         "--build-timeout",
         [&parsed](const std::string& text) {
           parsed.common.build_timeout = support::Seconds(*support::parse_float_in_range(text));
         },
         "Time limit for each run of a C++ compiler, Graphviz or gnuplot")
      ->check(limit_text)
      ->default_str("120");
  app.add_option("--library", parsed.common.library, "Folder of the library's function documents")
      ->envname("ISOSHADE_LIBRARY")
      ->check(CLI::ExistingDirectory);

  CompileArguments compile;
  CLI::App* compile_app =
      app.add_subcommand("compile", "Write the programs of a graph as GLSL, C++ or SPIR-V, with reflection");
  compile_app->add_option("GRAPH", compile.graph, "A function, effect or post document")->required();
  compile_app->add_option("-o,--output", compile.output,
                          "Folder to write to; optional with --dump-after");
  const auto [target_names, target_docs] = target_texts();
  compile_app->add_option("--target", compile.targets, "Languages to write, separated by commas: " + target_docs)
      ->delimiter(',')
      ->check(CLI::IsMember(target_names))
      ->default_str("glsl,cpp");
  static const std::map<std::string, Wrapper> wrappers{
      {"none", Wrapper::none}, {"isoshade", Wrapper::isoshade}, {"forward", Wrapper::forward}};
  compile_app
      ->add_option("--wrapper", compile.wrapper,
                   "What stands around the functions: none (for programs of your own), isoshade (the stages that "
                   "`render` runs) or forward (an ordinary vertex and fragment shader, outside the contract)")
      ->transform(CLI::CheckedTransformer(wrappers).description("{none,isoshade,forward}"))
      ->type_name("TEXT")
      ->default_str("none");
  static const std::map<std::string, bool> samplings{{"fetch", false}, {"samplers", true}};
  compile_app
      ->add_option("--sampling", compile.hardware_samplers,
                   "How a forward shader reads images: fetch (isoshade's own filters) or samplers (the hardware's)")
      ->transform(CLI::CheckedTransformer(samplings).description("{fetch,samplers}"))
      ->type_name("TEXT")
      ->default_str("fetch");
  compile_app->add_option("--prefix", compile.prefix,
                          "What names begin with, the namespace in C++; the document's name if not given");
  compile_app
      ->add_option("--set", compile.settings,
                   "Compile for one value of a parameter of an effect or post: PARAMETER=VALUE. The code for other values is "
                   "left out; the struct of parameters keeps its fields, which nothing reads")
      ->take_all();
  compile_app->add_flag("--check", compile.check, "Add what `isoshade check` finds to the reflection; may take seconds");
  compile_app->add_option("--division", compile.division, "Division in the GLSL: native or exact")
      ->check(division_names)
      ->capture_default_str();
  add_precision(*compile_app, compile.precision);
  compile_app->add_option("--depfile", compile.depfile,
                          "File for a rule of make or ninja that names all files that were read; other files whose "
                          "bytes would stay the same are then left as they are");
  compile_app->add_flag("--no-lanes", compile.without_lanes,
                        "Leave out the headers of isoshade/lanes, which are installed with isoshade");
  compile_app->add_option(
      "--dump-after", compile.dump_after,
      "Print the result of a stage: document, graph, typed, lower or a pass; `help` lists them");
  compile_app->add_flag("--explain", compile.explain,
                        "Print which nodes are computed, with their operations, which became constant and which are left out; "
                        "with --set what the values save. Needs no -o");

  RenderArguments render;
  std::string render_size;
  std::string render_frames;
  CLI::App* render_app = app.add_subcommand("render", "Render a scene to an image");
  render_app->add_option("SCENE", render.scene, "A scene document")->required();
  render_app->add_option(
      "-o,--output", render.output,
      "FILE.png, FILE.jpg or FILE.ppm (encoded, 8 bits), FILE.exr (linear floats, with depth) or FILE.pfm "
      "(linear floats of the colors). With --frames a name with a field for the number, frame_%04d.png, or one "
      "FILE.apng or FILE.gif, or - for all frames one after the other; without -o --frames only measures, which "
      "needs --stats or --stats-json");
  add_output_choice(*render_app, render.output_choice, true);
  render_app
      ->add_option(
          "--backend", render.backend,
          "cpu, vulkan, interpreter or reference (the graph as authored in 57 digits, up to 256x256 pixels)")
      ->check(backend_names)
      ->capture_default_str();
  render_app->add_option("--size", render_size, "Size in pixels, instead of the scene's")->check(size_text);
  render_app->add_flag("--stats", render.stats,
                       "Report what was drawn, what was skipped and why, and the time of each step; with --frames that of "
                       "the first frame, and a table of the times of all");
  add_fail_on_nan(*render_app, render.fail_on_nan);
  add_no_skip(*render_app, render.skips);
  add_precision(*render_app, render.precision);
  add_changes(*render_app, render.changes);
  CLI::Option* frames_option =
      render_app
          ->add_option("--frames", render_frames,
                       "Render an animation: COUNT frames at equal steps of time, the first and the last included; a COUNT "
                       "alone renders all frames at the scene's time")
          ->check(frames_text)
          ->excludes(render_app->get_option("--time"));
  render_app->add_flag("--turntable", render.turntable, "Turn the camera once about its target over the frames")
      ->needs(frames_option);
  render_app
      ->add_option("--stats-json", render.stats_json,
                   "With --frames: FILE for the time of each step of each frame as JSON; - is standard output")
      ->needs(frames_option);
  add_lanes(*render_app, render.choice);
  add_choice(*render_app, render.choice);

  SheetArguments sheet;
  std::string sheet_size;
  std::vector<std::string> varied;
  CLI::App* sheet_app = app.add_subcommand("sheet", "Render a scene with several values of one or two parameters, side by side");
  sheet_app->add_option("SCENE", sheet.scene, "A scene document")->required();
  sheet_app
      ->add_option("--vary", varied,
                   "NAME=FROM:TO:COUNT, or NAME=VALUE;VALUE;..., with a NAME as for --set; once for columns, twice for "
                   "columns and rows")
      ->check(varied_text)
      ->take_all()
      ->expected(1)
      ->required();
  sheet_app->add_option("-o,--output", sheet.output, "FILE.png, FILE.jpg or FILE.ppm")->required();
  add_output_choice(*sheet_app, sheet.output_choice, false);
  sheet_app->add_option("--backend", sheet.backend, "cpu, vulkan or interpreter")
      ->check(compared_names)
      ->capture_default_str();
  sheet_app->add_option("--size", sheet_size, "Size of each picture (default: 240 pixels wide, in the scene's shape)")
      ->check(size_text);
  add_precision(*sheet_app, sheet.precision);
  add_changes(*sheet_app, sheet.changes);
  add_lanes(*sheet_app, sheet.choice);
  add_choice(*sheet_app, sheet.choice);

  VerifyArguments verify;
  std::vector<std::string> verify_sizes;
  CLI::App* verify_app =
      app.add_subcommand("verify", "Render scenes on several backends and compare every bit");
  verify_app->add_option("SCENE", verify.scenes, "Scene documents")->required();
  verify_app
      ->add_option("--backends", verify.backends, "Backends, separated by commas; each is compared with the first")
      ->delimiter(',')
      ->check(compared_names)
      ->capture_default_str();
  verify_app->add_option("--size", verify_sizes, "Sizes, separated by commas, instead of the scene's")
      ->delimiter(',')
      ->check(size_text);
  verify_app
      ->add_option("--lanes", verify.lanes,
                   "Lane counts, separated by commas; the cpu backend is compared at each")
      ->delimiter(',')
      ->check(lane_names);
  verify_app->add_option("--report", verify.report,
                         "Folder for both images and a heat map where they differ");
  CLI::Option* golden = verify_app->add_option("--golden", verify.golden,
                                               "File of recorded hashes, one for each scene at its own size");
  golden->excludes(verify_app->get_option("--size"));
  verify_app->add_flag("--update", verify.update, "Record the hashes in the golden file instead of comparing");
  add_fail_on_nan(*verify_app, verify.fail_on_nan);
  add_no_skip(*verify_app, verify.skips);
  add_precision(*verify_app, verify.precision);
  add_changes(*verify_app, verify.changes);
  add_choice(*verify_app, verify.choice);

  EvalArguments eval;
  CLI::App* eval_app = app.add_subcommand("eval", "Evaluate a function document for each row of a table");
  eval_app->add_option("FUNCTION", eval.function, "A function document")->required();
  eval_app
      ->add_option("--inputs", eval.inputs,
                   "CSV file with a column for each input; for vectors l.x l.y l.z, for colours also c.r c.g c.b")
      ->required();
  eval_app->add_option("-o,--output", eval.output, "CSV file to write")->capture_default_str();
  eval_app
      ->add_option("--backend", eval.backend,
                   "cpu, vulkan, interpreter (hexadecimal floats) or reference (the graph as authored; 40 digits)")
      ->check(backend_names)
      ->capture_default_str();
  add_precision(*eval_app, eval.precision);
  add_lanes(*eval_app, eval.choice);
  add_choice(*eval_app, eval.choice);

  CheckArguments check;
  CLI::App* check_app = app.add_subcommand(
      "check", "Prove that results are finite for all inputs a document allows, and bound their errors");
  check_app->add_option("DOCUMENT", check.documents, "Function, effect and post documents")->required();
  check_app->add_option("-o,--output", check.output,
                        "CSV file for the counterexamples of a function, as a table for `eval`");
  std::vector<std::string> ranges;
  check_app
      ->add_option("--where", ranges,
                   "Restrict an input, or the scalar product or clamp that a node computes; may be repeated")
      ->check(range_text);
  check_app
      ->add_option("--set", check.settings, "Prove an effect or post for one value of a parameter: PARAMETER=VALUE, as for compile")
      ->take_all();
  add_precision(*check_app, check.precision);

  FormatArguments format;
  CLI::App* format_app = app.add_subcommand("fmt", "Format documents, in place");
  format_app->add_option("DOCUMENT", format.documents, "Documents; - reads stdin and writes stdout")
      ->required();
  format_app->add_flag("--check", format.check, "Change nothing; list files that are not formatted and exit with 1 if there are any");

  DrawArguments draw;
  CLI::App* draw_app = app.add_subcommand("draw", "Draw a graph as a diagram, using Graphviz");
  draw_app->add_option("GRAPH", draw.graph, "A function, effect or post document")->required();
  draw_app->add_option("-o,--output", draw.output, "FILE.svg, FILE.png or FILE.dot")->required();
  draw_app->add_option("--set", draw.settings, "With --after-specialisation: PARAMETER=VALUE, as for compile")->take_all();
  draw_app->add_flag("--after-specialisation", draw.after_specialisation,
                     "Draw nodes grey that nothing computes once the graph is compiled, for the values of --set");
  draw_app->add_option("--depth", draw.depth, "Levels of called functions to draw")
      ->check(CLI::Range(0, 16))
      ->capture_default_str();

  PageArguments page;
  CLI::App* page_app = app.add_subcommand(
      "page", "Write a scene as one HTML page: WebGL2 draws it, and a panel changes its parameters");
  page_app->add_option("SCENE", page.scene, "A scene document")->required();
  page_app->add_option("-o,--output", page.output, "FILE.html")->required();
  add_precision(*page_app, page.precision);
  add_changes(*page_app, page.changes);
  add_lanes(*page_app, page.choice);
  add_choice(*page_app, page.choice, false);

  BenchArguments bench;
  CLI::App* bench_app = app.add_subcommand(
      "bench",
      "Measure run time and error: formulas, precisions, lane counts, Vulkan, GLSL's built-ins, scalar C++, and scenes also by an "
      "ordinary forward renderer; or frames");
  bench_app->add_option("-o,--output", bench.output,
                        "Folder for bench.csv, bench.json, bench.md, bench.gp and bench.svg (drawn by gnuplot)");
  bench_app->add_option("--only", bench.only, "Only effects, functions and scenes whose names contain this");
  bench_app->add_flag("--frames", bench.frames,
                      "Measure frames by step instead: all scenes and a mesh of 1 thousand to 1 million triangles, each number of "
                      "threads (or that of --threads); writes frames.csv, .json, .gp and .svg");
  bench_app->add_option("--sizes", bench.sizes, "Sides of square frames, separated by commas (default: 256,512,1024,2048,4096)")
      ->delimiter(',')
      ->check(CLI::Range(16, 8192));
  bench_app->add_option("--repetitions", bench.repetitions, "How often each thing is timed (default: 31; of frames 9)")
      ->check(CLI::Range(1, 1000));
  bench_app->add_flag("--quick", bench.quick, "Few rows and repetitions, small frames: a rough look, not a measurement");
  bench_app->add_flag("--no-picture", bench.without_picture, "Write only the tables; gnuplot is not needed");
  bench_app->add_flag("--no-vulkan", bench.without_vulkan, "Measure only the cpu backend");
  bench_app
      ->add_option("--lanes", bench.lanes, "Lane counts of the cpu backend, separated by commas (default: all that the machine has)")
      ->delimiter(',')
      ->check(lane_names);
  add_choice(*bench_app, bench.choice);

  CacheArguments cache;
  CLI::App* cache_app =
      app.add_subcommand("cache", "Print the folder of the cache, its size and what it holds");
  cache_app->add_flag("--clear", cache.clear,
                      "Delete all entries; they are made again when needed");

  DevicesArguments devices;
  CLI::App* devices_app =
      app.add_subcommand("devices", "List the Vulkan devices and the result of each probe check");
  devices_app->add_option("--device", devices.choice.device, "Only this device");
  devices_app->add_flag("--probe", devices.probe, "Run the probe even where the cache has its result");

  NodesArguments nodes;
  CLI::App* nodes_app = app.add_subcommand(
      "nodes", "List the nodes of the language and the functions of the library, or describe one");
  CLI::Option* node = nodes_app->add_option("NAME", nodes.name,
                                               "A node (prints ports, domain, cost and error), a library function "
                                               "(ports and ranges) or a function of expressions (arguments)");
  nodes_app->add_flag("--markdown", nodes.markdown, "List all as the tables of graphs/README.md")
      ->excludes(node);

  SchemaArguments schema;
  CLI::App* schema_app =
      app.add_subcommand("schema", "Print the JSON Schema (draft-07) of all documents, for editors");
  schema_app->add_flag("--reflection", schema.reflection, "The schema of what `compile` writes as NAME.json");
  schema_app->add_flag("--stats", schema.stats, "The schema of what `render --frames --stats-json` writes")
      ->excludes(schema_app->get_option("--reflection"));
  schema_app
      ->add_flag("--markdown", schema.markdown,
                 "Print the keys of scenes, or of reflections, as the tables of graphs/README.md instead")
      ->excludes(schema_app->get_option("--stats"));

  try {
    std::vector<std::string> last_to_first = with_skip_names(argc, argv);
    std::ranges::reverse(last_to_first);
    app.parse(std::move(last_to_first));
    if (compile_app->parsed() && compile.output.empty() && compile.dump_after.empty() && !compile.explain)
      throw CLI::RequiredError("--output");
    const bool measures = !render_frames.empty() && (render.stats || !render.stats_json.empty());
    if (render_app->parsed() && render.output.empty() && !measures)
      throw CLI::RequiredError(render_frames.empty() ? "--output" : "--output, --stats or --stats-json");
    if (varied.size() > 2) throw CLI::ValidationError("--vary", "a sheet has columns and rows; give --vary at most twice");
  } catch (const CLI::ParseError& error) {
    // CLI11 has an exit code for each kind of error; isoshade documents a single one.
    exit = app.exit(error) == 0 ? Exit::success : Exit::failure;
    if (exit == Exit::failure && app.get_subcommands().empty())
      std::cerr << "The subcommands are: " << subcommand_names(app) << "\n"
                << near_subcommand(app, argc, argv);
    return std::nullopt;
  }
  if (app.get_subcommands().empty()) {
    std::cerr << "a subcommand is required: " << subcommand_names(app) << "\n"
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
  if (!render_size.empty()) render.size = parse_size(render_size);
  if (!render_frames.empty()) render.frames = parse_frames(render_frames);
  if (!sheet_size.empty()) sheet.size = parse_size(sheet_size);
  for (const std::string& text : varied) sheet.axes.push_back(*parse_varied(text));
  for (const std::string& text : verify_sizes) verify.sizes.push_back(*parse_size(text));
  if (compile_app->parsed()) parsed.compile = compile;
  if (render_app->parsed()) parsed.render = render;
  if (sheet_app->parsed()) parsed.sheet = sheet;
  if (verify_app->parsed()) parsed.verify = verify;
  if (eval_app->parsed()) parsed.eval = eval;
  for (const std::string& range : ranges) check.where.push_back(*parse_range(range));
  if (check_app->parsed()) parsed.check = check;
  if (format_app->parsed()) parsed.format = format;
  if (draw_app->parsed()) parsed.draw = draw;
  if (page_app->parsed()) parsed.page = page;
  if (bench_app->parsed()) parsed.bench = bench;
  if (cache_app->parsed()) parsed.cache = cache;
  if (devices_app->parsed()) parsed.devices = devices;
  if (nodes_app->parsed()) parsed.nodes = nodes;
  if (schema_app->parsed()) parsed.schema = schema;
  return parsed;
}

}  // namespace isoshade::cli
