// SPDX-License-Identifier: Apache-2.0
#include "runtime/render/stats.h"

#include <fmt/format.h>

namespace isoshade::render {

namespace {

/// `what` without the name.
std::string without_name(const Skipped& skipped) {
  const std::string end = " of " + skipped.of;
  return skipped.of.empty() ? skipped.what : skipped.what.substr(0, skipped.what.size() - end.size());
}

std::string saved(const Skipped& sum) {
  std::string text;
  const auto add = [&](int64_t count, std::string_view unit) {
    if (count != 0) text += fmt::format("{}{} {}", text.empty() ? " (saves " : ", ", count, unit);
  };
  add(sum.operations, "operations");
  add(sum.pixels, "pixels");
  add(sum.bytes, "bytes");
  return text.empty() ? "" : text + ")";
}

/// A line for all that differ in their names alone.
std::string text_of_skips(const std::vector<Skipped>& skips) {
  constexpr size_t most_names = 4;
  std::string text;
  std::vector<bool> told(skips.size());
  for (size_t i = 0; i < skips.size(); ++i) {
    if (told[i]) continue;
    Skipped sum = skips[i];
    const std::string what = without_name(sum);
    std::string names = sum.of;
    size_t count = 1;
    for (size_t j = i + 1; j < skips.size(); ++j) {
      const Skipped& other = skips[j];
      const bool is_alike = !sum.of.empty() && !other.of.empty() && other.skip == sum.skip && other.reason == sum.reason &&
                            without_name(other) == what;
      if (!is_alike) continue;
      told[j] = true;
      sum.operations += other.operations;
      sum.pixels += other.pixels;
      sum.bytes += other.bytes;
      if (++count <= most_names) names += ", " + other.of;
    }
    if (count > most_names) names += ", ...";
    const std::string object = count == 1 ? sum.what : fmt::format("{} of {} ({})", what, count, names);
    text += fmt::format("skipped:  {}: {}{}\n", object, sum.reason, saved(sum));
  }
  return text;
}

}  // namespace

std::string text(const PlanStats& stats) {
  const std::string textures = stats.textures == 0
                                   ? ""
                                   : fmt::format("textures: {} stored with {} texels in {} bytes\n",
                                                 stats.textures, stats.texels, stats.texture_bytes);
  const std::string environment =
      stats.environment ? fmt::format("environment: maps {} in {:.1f} ms\n",
                                      stats.environment_kept     ? "kept"
                                      : stats.environment_cached ? "found in the cache"
                                                                 : "computed",
                                      1e3 * stats.environment_seconds)
                        : "";
  std::string text = fmt::format(
      "scene:    {} objects, {} draws, {} lights\n"
      "meshes:   {} stored with {} vertices; {} vertices and {} triangles are drawn\n"
      "effects:  {} compiled into {} programs in {:.1f} ms\n"
      "{}{}"
      "plan:     {:.1f} ms\n",
      stats.copies, stats.draws, stats.lights, stats.meshes, stats.mesh_vertices, stats.vertices,
      stats.triangles, stats.effects, stats.programs, 1e3 * stats.compile_seconds, textures, environment,
      1e3 * stats.plan_seconds);
  if (stats.repeated > 0)
    text += fmt::format("repeats:  {} passes over copies in {} draws\n", stats.repeated, stats.repetitions);
  if (stats.posts > 0)
    text += fmt::format("posts:    {}{}\n", stats.posts,
                        stats.sample_posts > 0 ? fmt::format(", {} for each sample", stats.sample_posts) : "");
  if (stats.left_out_lights > 0) text += fmt::format("lights:   {} left out of sums\n", stats.left_out_lights);
  return text + text_of_skips(stats.in_programs) + text_of_skips(stats.skips);
}

std::string text(const DrawStats& stats) {
  std::string text = fmt::format(
      "build:    {:.1f} ms\n"
      "vertices: {:.1f} ms\n"
      "clip:     {:.1f} ms; leaves {} triangles, makes {} vertices\n"
      "draw:     {:.1f} ms\n",
      1e3 * stats.build_seconds, 1e3 * stats.transform_seconds, 1e3 * stats.clip_seconds, stats.triangles,
      stats.made_vertices, 1e3 * stats.draw_seconds);
  if (stats.samples > 1)
    text += fmt::format("samples:  {} a pixel\n", stats.samples);
  if (stats.kept_views > 0)
    text += fmt::format("kept:     {} of {} views{}\n", stats.kept_views, stats.views,
                        stats.is_kept ? ", and the whole frame" : "");
  if (stats.kept_images > 0)
    text += fmt::format("posts:    {:.1f} ms; {} run with what is before them; at most {} images at a time\n",
                        1e3 * stats.post_seconds, stats.fused_posts, stats.kept_images);
  std::string steps;
  for (const backends::DeviceStep& step : stats.device)
    if (step.seconds > 0) steps += fmt::format("{}{} {:.2f}", steps.empty() ? "" : ", ", step.name, 1e3 * step.seconds);
  if (!steps.empty()) text += "device:   " + steps + " ms by its clock\n";
  return text + text_of_skips(stats.skips);
}

}  // namespace isoshade::render
