// SPDX-License-Identifier: Apache-2.0
#include "runtime/cli/frame_times.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

namespace isoshade::cli {
namespace {

using nlohmann::ordered_json;

struct StepRow {
  std::string_view name, doc;
};
#define ISOSHADE_STEP(name, doc) {#name, doc},
constexpr StepRow rows[] = {ISOSHADE_STEPS(ISOSHADE_STEP)};
#undef ISOSHADE_STEP
static_assert(std::size(rows) == step_count);

/// Of all frames but the first, in milliseconds.
struct Spread {
  double lower = 0, median = 0, upper = 0;
};

/// Between the values at the places on both sides of it, in proportion.
double quantile(const std::vector<double>& sorted, double share) {
  const double place = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<size_t>(place);
  const size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (sorted[above] - sorted[below]) * (place - static_cast<double>(below));
}

std::optional<Spread> spread_of(const Measured& measured, Step step) {
  std::vector<double> times;
  for (size_t i = 1; i < measured.frames.size(); ++i) times.push_back(1e3 * measured.frames[i][step]);
  if (times.empty()) return std::nullopt;
  std::ranges::sort(times);
  return Spread{quantile(times, 0.25), quantile(times, 0.5), quantile(times, 0.75)};
}

std::string line(const char* format, auto... values) {
  char buffer[160];
  std::snprintf(buffer, sizeof buffer, format, values...);
  return buffer;
}

}  // namespace

std::string text(const Measured& measured) {
  const size_t others = measured.frames.size() - 1;
  std::string text = line("times of %zu frames of %d x %d with %d samples a pixel, on %d threads, in ms\n",
                          measured.frames.size(), measured.width, measured.height, measured.samples, measured.threads);
  text += others == 0 ? line("%-10s%10s\n", "", "first")
                      : line("%-10s%10s%10s%10s%10s%10s\n", "", "first", "median", "quartile", "quartile", "between");
  for (size_t s = 0; s < step_count; ++s) {
    const auto step = static_cast<Step>(s);
    text += line("%-10s%10.2f", std::string(rows[s].name).c_str(), 1e3 * measured.frames[0][step]);
    if (const auto spread = spread_of(measured, step))
      text += line("%10.2f%10.2f%10.2f%10.2f", spread->median, spread->lower, spread->upper,
                   spread->upper - spread->lower);
    text += "\n";
  }
  if (measured.kept_views > 0)
    text += line("kept      %lld of %zu frames, and %lld of %lld views, as they were\n",
                 static_cast<long long>(measured.kept_frames), measured.frames.size(),
                 static_cast<long long>(measured.kept_views), static_cast<long long>(measured.views));
  return text;
}

std::string json(const Measured& measured) {
  ordered_json steps;
  for (size_t s = 0; s < step_count; ++s) {
    const auto step = static_cast<Step>(s);
    ordered_json row{{"first", 1e3 * measured.frames[0][step]}};
    if (const auto spread = spread_of(measured, step)) {
      row["median"] = spread->median;
      row["lower_quartile"] = spread->lower;
      row["upper_quartile"] = spread->upper;
    }
    for (const StepTimes& frame : measured.frames) row["frames"].push_back(1e3 * frame[step]);
    steps[std::string(rows[s].name)] = std::move(row);
  }
  ordered_json skips = ordered_json::array();
  for (const render::Skipped& skipped : measured.skipped) {
    ordered_json row{{"what", skipped.what}, {"why", skipped.reason}};
    if (skipped.skip) row["skip"] = std::string(interface::name(*skipped.skip));
    if (!skipped.of.empty()) row["of"] = skipped.of;
    const std::pair<const char*, int64_t> saved[] = {
        {"operations", skipped.operations}, {"pixels", skipped.pixels}, {"bytes", skipped.bytes}};
    for (const auto& [name, count] : saved)
      if (count != 0) row[name] = count;
    skips.push_back(std::move(row));
  }
  const ordered_json all{{"isoshade_frame_times", 1},       {"scene", measured.scene},   {"backend", measured.backend},
                         {"threads", measured.threads},     {"width", measured.width},   {"height", measured.height},
                         {"samples", measured.samples},     {"frames", measured.frames.size()},
                         {"kept_frames", measured.kept_frames}, {"views", measured.views}, {"kept_views", measured.kept_views},
                         {"milliseconds", std::move(steps)}, {"skipped", std::move(skips)}};
  return all.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string measured_schema() {
  const auto whole = [](const char* doc, int least) {
    return ordered_json{{"type", "integer"}, {"minimum", least}, {"description", doc}};
  };
  const auto text = [](const char* doc) { return ordered_json{{"type", "string"}, {"description", doc}}; };
  const auto time = [](const char* doc) {
    return ordered_json{{"type", "number"}, {"minimum", 0}, {"description", doc}};
  };
  const auto object = [](ordered_json properties, const std::vector<std::string>& optional = {}) {
    ordered_json required = ordered_json::array();
    for (const auto& [name, property] : properties.items())
      if (std::ranges::find(optional, name) == optional.end()) required.push_back(name);
    return ordered_json{{"type", "object"},
                        {"additionalProperties", false},
                        {"required", std::move(required)},
                        {"properties", std::move(properties)}};
  };
  ordered_json step = object({{"first", time("the first frame")},
                              {"median", time("of all other frames")},
                              {"lower_quartile", time("of all other frames")},
                              {"upper_quartile", time("of all other frames")},
                              {"frames", {{"type", "array"}, {"minItems", 1}, {"items", time("a frame")}}}},
                             {"median", "lower_quartile", "upper_quartile"});
  ordered_json steps;
  for (const StepRow& row : rows)
    steps[std::string(row.name)] = {{"description", row.doc}, {"allOf", {{{"$ref", "#/definitions/step"}}}}};
  ordered_json names = ordered_json::array();
  for (const interface::SkipRow& row : interface::skip_rows) names.push_back(std::string(row.name));
  ordered_json skipped = object(
      {{"what", text("what was left out")},
       {"why", text("why that changes no bit")},
       {"skip", {{"enum", std::move(names)}, {"description", "what `--no-skip` takes; absent if the document itself asks for it"}}},
       {"of", text("the object, light, effect or image that it belongs to")},
       {"operations", whole("that each pixel is spared, or each draw if it has no pixels", 1)},
       {"pixels", whole("that are not computed", 1)},
       {"bytes", whole("that are not stored", 1)}},
      {"skip", "of", "operations", "pixels", "bytes"});
  ordered_json schema{{"$schema", "http://json-schema.org/draft-07/schema#"},
                      {"title", "the times of frames, as `isoshade render --frames --stats-json` writes them"}};
  schema.update(object({{"isoshade_frame_times", {{"const", 1}, {"description", "the version of this format"}}},
                        {"scene", text("the document")},
                        {"backend", text("device or compiler, lanes, division")},
                        {"threads", whole("of the host", 1)},
                        {"width", whole("of the picture, in pixels", 1)},
                        {"height", whole("of the picture, in pixels", 1)},
                        {"samples", whole("per pixel", 1)},
                        {"frames", whole("how many were rendered", 1)},
                        {"kept_frames", whole("frames that were as the one before, and not drawn", 0)},
                        {"views", whole("pictures and shadow maps of all frames", 1)},
                        {"kept_views", whole("of these, those that were not drawn again", 0)},
                        {"milliseconds", object(std::move(steps))},
                        {"skipped",
                         {{"type", "array"},
                          {"description", "what the first frame left out without changing a bit"},
                          {"items", std::move(skipped)}}}}));
  schema["definitions"] = {{"step", std::move(step)}};
  return schema.dump(2) + "\n";
}

}  // namespace isoshade::cli
