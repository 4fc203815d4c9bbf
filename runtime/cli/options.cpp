// SPDX-License-Identifier: Apache-2.0
#include "runtime/cli/options.h"

#include "compiler/driver/program.h"
#include "compiler/support/diagnostics.h"
#include "compiler/support/parse_number.h"
#include "runtime/cli/argument_texts.h"
#include "runtime/scene/image_file.h"

namespace isoshade::cli {

const CLI::Validator size_text(
    [](std::string& text) {
      return parse_size(text) ? std::string()
                              : "\"" + text + "\" is not a size: write WxH, from 1x1 to 8192x8192";
    },
    "WxH");

const CLI::Validator range_text(
    [](std::string& text) {
      return parse_range(text) ? std::string()
                               : "\"" + text + "\" is not a range: write NAME=MIN:MAX, for example roughness=0.1:1";
    },
    "NAME=MIN:MAX");

const CLI::Validator varied_text(
    [](std::string& text) {
      return parse_varied(text) ? std::string()
                                : "\"" + text + "\" is not a parameter with values: write NAME=FROM:TO:COUNT, for "
                                  "example roughness=0.1:1:5, or NAME=VALUE;VALUE;..., at most 64";
    },
    "NAME=FROM:TO:COUNT");

/// CLI::Range also accepts text that is not a number.
const CLI::Validator time_text(
    [](std::string& text) {
      const auto time = support::parse_float_in_range(text);
      return time && *time >= -1e9f && *time <= 1e9f ? std::string()
                                                     : "\"" + text + "\" is not a number from -1e9 to 1e9";
    },
    "SECONDS");

const CLI::Validator frames_text(
    [](std::string& text) {
      return parse_frames(text) ? std::string()
                                : "\"" + text +
                                      "\" does not tell the frames: write FIRST:LAST:COUNT, two times in seconds and how "
                                      "many frames, for example 0:2:48, or only COUNT";
    },
    "FIRST:LAST:COUNT|COUNT");

const CLI::Validator limit_text(
    [](std::string& text) {
      const auto limit = support::parse_float_in_range(text);
      return limit && *limit >= 0.001f && *limit <= 86400
                 ? std::string()
                 : "\"" + text + "\" is not a number of seconds from 0.001 to 86400";
    },
    "SECONDS");

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
const CLI::Validator compared_names(
    [](std::string& name) -> std::string {
      if (name != "reference") return backend_names(name);
      return "the reference does not round, so its bits differ from every other backend; use it with `render` or `eval`";
    },
    "cpu,vulkan,interpreter");
const CLI::IsMember lane_names({"1", "4", "8", "16", "8x2", "16x2"});
const CLI::IsMember division_names(driver::division_names);

void add_fail_on_nan(CLI::App& app, bool& fail) {
  app.add_flag("--fail-on-nan", fail, "Exit with 1 if a pixel is infinite or NaN, before or after the posts");
}

void add_precision(CLI::App& app, functions::Tier& precision) {
  const auto choose = [&precision](const std::string& name) { precision = *functions::find_tier(name); };
  app.add_option_function<std::string>(
         "--precision", choose,
         "Precision of functions: fast, default or precise; all backends compute the same bits in each")
      ->check(CLI::IsMember({"fast", "default", "precise"}))
      ->default_str("default");
}

void add_lanes(CLI::App& app, BackendChoice& choice) {
  app.add_option("--lanes", choice.lanes, "Lanes of the cpu backend (default: the widest that the machine has)")
      ->check(lane_names);
}

void add_choice(CLI::App& app, BackendChoice& choice, bool has_vulkan) {
  app.add_option("--threads", choice.threads, "Threads of the cpu backend and for writing files (default: one for each core)")
      ->check(CLI::Range(1, 1024));
  app.add_option("--cxx", choice.compiler, "Compiler for generated C++ (default: $ISOSHADE_CXX, c++, g++, clang++)");
  if (!has_vulkan) return;
  app.add_option("--device", choice.device, "Vulkan device: part of its name, or its number in `isoshade devices`");
  app.add_option("--division", choice.division, "Division on vulkan: native or exact (default: as the probe decides)")
      ->check(division_names);
}

void add_output_choice(CLI::App& app, OutputChoice& choice, bool with_floats) {
  std::vector<std::string> formats, compressions;
  for (const scene::ImageFormat& format : scene::image_formats())
    if (format.write_bytes != nullptr || (with_floats && format.write_floats != nullptr))
      formats.emplace_back(format.name);
  app.add_option("--format", choice.format,
                 "Format of the output, if its name does not tell; `-o -` writes to standard output, by default a PNG")
      ->check(CLI::IsMember(formats));
  app.add_option("--quality", choice.quality, "Quality of a JPEG (default: 90); from 90 on, colors have the full resolution")
      ->check(CLI::Range(1, 100));
  if (!with_floats) return;
  for (const auto& [name, compression] : scene::lossless_compressions) compressions.emplace_back(name);
  app.add_option("--compression", choice.compression, "Compression of an EXR file, all without loss (default: zip)")
      ->check(CLI::IsMember(compressions));
}

namespace {

constexpr std::string_view all_skips = "all";

/// The skips that a list names; nothing if one of the names is of none.
std::optional<std::vector<interface::Skip>> parse_skips(const std::string& names) {
  std::vector<interface::Skip> found;
  for (size_t begin = 0; begin <= names.size();) {
    const size_t end = std::min(names.find(',', begin), names.size());
    const std::string name = names.substr(begin, end - begin);
    begin = end + 1;
    if (const auto skip = interface::find_skip(name)) {
      found.push_back(*skip);
    } else if (name == all_skips) {
      for (size_t i = 0; i < interface::skip_count; ++i) found.push_back(static_cast<interface::Skip>(i));
    } else {
      return std::nullopt;
    }
  }
  return found;
}

const CLI::Validator skip_names_text(
    [](std::string& names) -> std::string {
      if (parse_skips(names)) return "";
      std::string known(all_skips);
      for (const interface::SkipRow& row : interface::skip_rows) known += ", " + std::string(row.name);
      return "\"" + names + "\" is not a list of skips; they are " + known;
    },
    "NAME,...");

}  // namespace

void add_no_skip(CLI::App& app, interface::Skips& skips) {
  const auto leave_out = [&skips](const std::vector<std::string>& lists) {
    for (const std::string& names : lists) {
      const auto found = parse_skips(names);
      for (const interface::Skip skip : *found) skips.set(skip, false);
    }
  };
  std::string help = "Do not skip, for comparison: the image has the same bits, later. Without a name: all of";
  for (const interface::SkipRow& row : interface::skip_rows)
    help += (&row == interface::skip_rows ? " " : ", ") + std::string(row.name);
  app.add_option_function<std::vector<std::string>>("--no-skip", leave_out, help)
      ->check(skip_names_text)
      ->expected(1)
      ->allow_extra_args(false)
      ->take_all();
}

std::vector<std::string> with_skip_names(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  // A misspelt name is still taken for one, and not for the scene: that is a path.
  const auto may_be_names = [](const std::string& text) {
    return text.find_first_not_of("abcdefghijklmnopqrstuvwxyz,") == std::string::npos;
  };
  for (size_t i = arguments.size(); i-- > 0;)
    if (arguments[i] == "--no-skip" && (i + 1 == arguments.size() || !may_be_names(arguments[i + 1])))
      arguments.insert(arguments.begin() + static_cast<std::ptrdiff_t>(i) + 1, std::string(all_skips));
  return arguments;
}

void add_changes(CLI::App& app, SceneChanges& changes) {
  app.add_option("--set", changes.settings,
                 "Override a parameter: NAME.PARAMETER=VALUE, or PARAMETER=VALUE if only one has it; or a value of the "
                 "camera, a light or the environment: camera.fov, sun.intensity, environment.rotate")
      ->take_all();
  app.add_option("--mesh", changes.mesh,
                 "glTF file (.gltf, .glb) to show instead of the scene's own, or of the mesh of its only object");
  app.add_option("--time", changes.time, "Value of the node `time` in seconds, instead of the scene's")
      ->check(time_text);
  app.add_option("--samples", changes.samples,
                 "Samples per pixel: 1, 4 or 16, instead of the scene's")
      ->check(CLI::IsMember({"1", "4", "16"}));
}

}  // namespace isoshade::cli
