// SPDX-License-Identifier: Apache-2.0
#include "backends/vulkan/probe.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "backends/vulkan/device.h"
#include "backends/vulkan/limits.h"
#include "backends/vulkan/probe_parts.h"

namespace isoshade::vulkan {

namespace {

std::string hex(int32_t bits) {
  constexpr char digits[] = "0123456789abcdef";
  std::string text = "0x";
  for (int shift = 28; shift >= 0; shift -= 4) text += digits[static_cast<uint32_t>(bits) >> shift & 15];
  return text;
}

/// Compares a table word by word; one check a topic.
void compare_words(std::string_view stage, std::span<const Operands> rows, std::span<const int32_t> expected,
                   std::span<const int32_t> seen, Probe& probe) {
  const std::span<const Topic> topics = word_topics();
  struct Tally {
    size_t wrong = 0;
    size_t first = 0;  ///< word
  };
  std::array<Tally, topic_count> tallies;
  for (size_t i = 0; i < expected.size(); ++i) {
    if (expected[i] == seen[i]) continue;
    Tally& tally = tallies[static_cast<size_t>(topics[i % topics.size()])];
    if (tally.wrong++ == 0) tally.first = i;
  }
  for (int t = 0; t < topic_count; ++t) {
    const auto topic = static_cast<Topic>(t);
    const Tally& tally = tallies[static_cast<size_t>(t)];
    Check check{std::string(name(topic)) + " (" + std::string(stage) + ")", tally.wrong == 0,
                std::to_string(rows.size()) + " rows, every bit as expected"};
    if (tally.wrong != 0) {
      const Operands& row = rows[tally.first / topics.size()];
      check.detail = std::to_string(tally.wrong) + " results differ in " + std::to_string(rows.size()) +
                     " rows; the first: " + std::string(word_name(tally.first % topics.size())) + " of " +
                     hex(row.a) + ", " + hex(row.b) + ", " + hex(row.c) + " is " + hex(seen[tally.first]) +
                     ", not " + hex(expected[tally.first]);
    }
    if (topic == Topic::division && !check.passed) {
      // No failure: the exact lowering needs only what the other topics show.
      probe.division = driver::Division::exact;
      check.passed = true;
      check.detail = "not rounded correctly, so computed exactly instead; " + check.detail;
    }
    probe.checks.push_back(std::move(check));
  }
}

bool probe_arithmetic(Device& device, Probe& probe, support::Diagnostics& diagnostics) {
  const std::vector<Operands> rows = probe_operands();
  const size_t words = word_topics().size();
  const auto attachments = static_cast<uint32_t>((words + 3) / 4);
  const auto fragment =
      device.pipeline({Output::words, attachments, full_screen_vertex(), probe_fragment_glsl()}, diagnostics);
  const auto vertex = device.pipeline({Output::buffer, 0, probe_vertex_glsl(), {}}, diagnostics);
  if (!fragment || !vertex) return false;

  const std::vector<int32_t> expected = expected_words(rows);
  std::vector<int32_t> seen(expected.size());
  device.upload(lower::FrameBuffer::inputs, rows.data(), rows.size() * sizeof(Operands));
  device.run_table(*fragment, attachments, rows.size(), words, seen);
  compare_words("fragment", rows, expected, seen, probe);
  device.run_vertices(
      std::array{Call{
          .pipeline = *vertex, .vertex_count = static_cast<uint32_t>(rows.size()), .scissor = {0, 0, 1, 1}}},
      seen);
  compare_words("vertex", rows, expected, seen, probe);
  if (!device.computes()) return true;
  const auto compute = device.pipeline({Output::row, 0, probe_compute_glsl(), {}}, diagnostics);
  if (!compute) return false;
  device.run_vertices(
      std::array{Call{.pipeline = *compute, .vertex_count = static_cast<uint32_t>(rows.size())}}, seen);
  compare_words("compute", rows, expected, seen, probe);
  return true;
}

bool same_bits(const float* a, const float* b, size_t count) {
  return std::memcmp(a, b, count * sizeof(float)) == 0;
}

void compare_images(const backends::Image& expected, const backends::Image& seen, size_t triangles,
                    const std::string& where, Probe& probe) {
  size_t depths = 0, colors = 0;
  for (size_t i = 0; i < expected.depth.size(); ++i) {
    depths += same_bits(&expected.depth[i], &seen.depth[i], 1) ? 0 : 1;
    colors += same_bits(&expected.rgba[4 * i], &seen.rgba[4 * i], 4) ? 0 : 1;
  }
  const auto check = [&](std::string name, size_t wrong) {
    const std::string of =
        std::to_string(expected.depth.size()) + " pixels of " + std::to_string(triangles) + " triangles";
    probe.checks.push_back(
        {std::move(name) + " (" + where + ")", wrong == 0,
         wrong == 0 ? of + ", every bit as expected" : std::to_string(wrong) + " differ of " + of});
  };
  check("coverage and depth", depths);
  check("visible triangles and colors", colors);
}

/// All of the frame; and its further half, as frames of several samples a pixel are drawn part by part.
std::vector<Window> probed_parts(const CoverageScene& scene) {
  const Window whole{0, 0, scene.width, scene.height};
  const bool along_y = scene.height > scene.width;
  const int length = (along_y ? scene.height : scene.width) / (2 * cell_size) * cell_size;
  Window half = whole;
  (along_y ? half.y : half.x) = length;
  (along_y ? half.height : half.width) -= length;
  return {whole, half};
}

bool lies_in(const Window& rect, const Window& part) {
  return rect.x >= part.x && rect.y >= part.y && rect.x + rect.width <= part.x + part.width &&
         rect.y + rect.height <= part.y + part.height;
}

backends::Image cut(const backends::Image& image, const Window& part) {
  backends::Image result;
  result.resize(part.width, part.height);
  for (int y = 0; y < part.height; ++y) {
    const auto from = static_cast<ptrdiff_t>(part.y + y) * image.width + part.x;
    const auto to = static_cast<ptrdiff_t>(y) * part.width;
    std::copy_n(image.rgba.begin() + 4 * from, 4 * part.width, result.rgba.begin() + 4 * to);
    std::copy_n(image.depth.begin() + from, part.width, result.depth.begin() + to);
  }
  return result;
}

bool probe_coverage(Device& device, Probe& probe, support::Diagnostics& diagnostics) {
  const auto visibility =
      device.pipeline({Output::visibility, 1, triangle_vertex(), coverage_visibility_glsl()}, diagnostics);
  const auto color =
      device.pipeline({Output::color, 1, full_screen_vertex(), coverage_color_glsl()}, diagnostics);
  if (!visibility || !color) return false;

  const float background[4] = {-0.0f, 0.1f, -65504.0f, 1e-30f};
  for (const bool along_y : {false, true}) {
    const CoverageScene scene = coverage_scene(device.max_frame_side(), along_y);
    const backends::Image expected = expected_image(scene, background);
    device.upload(lower::FrameBuffer::triangles, scene.triangles.data(),
                  scene.triangles.size() * sizeof(int32_t));
    device.upload(lower::FrameBuffer::inputs, scene.values.data(), scene.values.size() * sizeof(int32_t));
    for (const Window& part : probed_parts(scene)) {
      std::vector<Call> calls;
      size_t triangles = 0;
      for (const Cell& cell : scene.cells) {
        if (!lies_in(cell.area, part)) continue;
        calls.push_back({.pipeline = *visibility,
                         .push = {.width = scene.width},
                         .first_vertex = 3 * cell.first,
                         .vertex_count = 3 * cell.count,
                         .scissor = cell.area});
        triangles += cell.count;
      }
      const Call shade{.pipeline = *color, .push = {.width = scene.width}, .scissor = part};
      backends::Image image;
      image.resize(part.width, part.height);
      device.render(calls, {&shade, 1}, {}, background, part, image);
      const bool whole = image.depth.size() == expected.depth.size();
      const std::string where = std::string("along ") + (along_y ? "y" : "x") + (whole ? "" : ", a part");
      compare_images(cut(expected, part), image, triangles, where, probe);
    }
  }
  return true;
}

}  // namespace

std::optional<Probe> run_probe(Device& device, support::Diagnostics& diagnostics) {
  Probe probe;
  probe.division = driver::Division::native;
  if (!probe_arithmetic(device, probe, diagnostics) || !probe_coverage(device, probe, diagnostics))
    return std::nullopt;
  return probe;
}

std::string to_text(const Probe& probe) {
  std::string text = "division " + std::string(driver::name(probe.division)) + "\n";
  for (const Check& check : probe.checks) text += check.name + "\t" + check.detail + "\n";
  return text;
}

std::optional<Probe> probe_from_text(std::string_view text) {
  Probe probe;
  bool is_first = true;
  while (!text.empty()) {
    const size_t end = text.find('\n');
    if (end == std::string_view::npos) return std::nullopt;
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end + 1);
    if (is_first) {
      for (const driver::Division division : {driver::Division::native, driver::Division::exact}) {
        if (line != "division " + std::string(driver::name(division))) continue;
        probe.division = division;
        is_first = false;
      }
      if (is_first) return std::nullopt;
      continue;
    }
    const size_t tab = line.find('\t');
    if (tab == 0 || tab == std::string_view::npos) return std::nullopt;
    probe.checks.push_back({std::string(line.substr(0, tab)), true, std::string(line.substr(tab + 1))});
  }
  return probe.checks.empty() ? std::nullopt : std::optional(std::move(probe));
}

void report_unproven(const Probe& probe, const std::string& device, support::Diagnostics& diagnostics) {
  support::Diagnostic* report = nullptr;
  for (const Check& check : probe.checks) {
    if (check.passed) continue;
    const std::string failure = "fails the check \"" + check.name + "\": " + check.detail;
    if (report == nullptr)
      report = &diagnostics.report(support::Id::unproven_device,
                                   device + " " + failure + "; its images cannot be claimed to be identical");
    else
      report->note("it also " + failure);
  }
  if (report != nullptr) report->suggest("choose another device");
}

}  // namespace isoshade::vulkan
