// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "runtime/bench/frames.h"

namespace isoshade::bench {

namespace {

struct Step {
  const char* name;
  double FramePoint::*seconds;
  const char* color;
};
constexpr std::array steps{Step{"plan", &FramePoint::plan, "#8d6bb1"}, Step{"vertices", &FramePoint::vertices, "#3f8f5b"},
                           Step{"clip", &FramePoint::clip, "#d9a521"}, Step{"draw", &FramePoint::draw, "#1f4e9c"},
                           Step{"posts", &FramePoint::posts, "#b3541e"}};

constexpr double milliseconds = 1e3;

/// The size at which scenes are compared: 1024, or the largest.
int compared_size(const FrameReport& report) {
  int largest = 0;
  for (const FramePoint& p : report.points) {
    if (p.size == 1024) return p.size;
    largest = std::max(largest, p.size);
  }
  return largest;
}

int most_threads(const FrameReport& report) {
  int most = 0;
  for (const FramePoint& p : report.points)
    if (p.backend == "cpu") most = std::max(most, p.threads);
  return most;
}

/// Without the mesh, in the order of the report.
std::vector<std::string> scenes_of(const FrameReport& report) {
  std::vector<std::string> names;
  for (const FramePoint& p : report.points)
    if (p.scene != "mesh" && std::ranges::find(names, p.scene) == names.end()) names.push_back(p.scene);
  return names;
}

class Plot {
 public:
  explicit Plot(const FrameReport& report)
      : report_(report), size_(compared_size(report)), threads_(most_threads(report)), scenes_(scenes_of(report)) {}

  std::string text(const std::string& output) {
    std::string path;
    for (const char c : output) path += (c == '"' || c == '\\' ? "\\" : "") + std::string(1, c);
    text_ = fmt::format(
        "set terminal svg size 1200,{} font \"sans-serif,14\" background \"white\"\nset output \"{}\"\n"
        "set multiplot\nset tics nomirror\nset border 3\nset grid back lc rgb \"#dddddd\"\n",
        bars_height() + 400, path);
    const double split = 400.0 / (bars_height() + 400);
    text_ += fmt::format("set origin 0,{}\nset size 1,{}\n", split, 1 - split);
    bars();
    const std::array width{0.34, 0.33, 0.33};
    double x = 0;
    for (size_t i = 0; i < width.size(); ++i) {
      text_ += fmt::format("unset label\nunset object\nset autoscale\nset yrange [*:*] noreverse\nset ytics auto\nset origin {},0\nset size {},{}\n", x, width[i], split);
      x += width[i];
      if (i == 0) by_threads();
      if (i == 1) by_triangles();
      if (i == 2) by_size();
    }
    return text_ + "unset multiplot\n";
  }

 private:
  int bars_height() const { return 90 + 34 * static_cast<int>(scenes_.size()); }

  const FramePoint* find(const std::string& scene, const std::string& backend, int size) const {
    for (const FramePoint& p : report_.points)
      if (p.scene == scene && p.backend == backend && p.size == size && (backend != "cpu" || p.threads == threads_)) return &p;
    return nullptr;
  }

  /// Bars of the cpu, by step, one for each scene, and the ratio of vulkan's time to it.
  void bars() {
    std::string objects, tics;
    double longest = 0;
    for (size_t i = 0; i < scenes_.size(); ++i) {
      const FramePoint* cpu = find(scenes_[i], "cpu", size_);
      tics += fmt::format("{}\"{}\" {}", i ? ", " : "", scenes_[i], i);
      if (cpu == nullptr) continue;
      double x = 0;
      for (const Step& step : steps) {
        const double width = cpu->*step.seconds * milliseconds;
        objects += fmt::format("set object rectangle from {},{} to {},{} fc rgb \"{}\" fs solid noborder\n", x,
                               static_cast<double>(i) - 0.33, x + width, static_cast<double>(i) + 0.33, step.color);
        x += width;
      }
      longest = std::max(longest, x);
      const FramePoint* vulkan = find(scenes_[i], "vulkan", size_);
      objects += fmt::format("set label \"{:.1f} ms{}\" at {},{} left offset 0.5,0 noenhanced\n", x,
                             vulkan != nullptr ? fmt::format(", vulkan {:.1f} times that", vulkan->whole / cpu->whole) : "", x, i);
    }
    double key = 0;
    for (const Step& step : steps) {
      objects += fmt::format(
          "set object rectangle from graph {},1.02 to graph {},1.05 noclip fc rgb \"{}\" fs solid noborder\n"
          "set label \"{}\" at graph {},1.035 left\n", key, key + 0.02, step.color, step.name, key + 0.026);
      key += 0.12;
    }
    text_ += objects + fmt::format(
        "set title \"A frame of {0}x{0} on the cpu, {1} threads, by step\" offset 0,1.2\nset xlabel \"ms\"\nset lmargin 22\n"
        "set ytics ({2}) noenhanced\nset xrange [0:{3}]\nset yrange [{4}:-0.7]\nset key off\nplot NaN\n"
        "unset lmargin\nset tmargin 3\n", size_, threads_, tics, longest * 1.35 + 0.01, static_cast<double>(scenes_.size()) - 0.3);
  }

  struct Line {
    std::string name, data;
  };
  void lines(const std::vector<Line>& lines, const std::string& title, const std::string& x, const std::string& y,
             bool logarithmic = true) {
    std::string plots;
    for (const Line& line : lines) {
      const std::string block = fmt::format("$l{}", series_++);
      text_ += block + " << EOD\n" + line.data + "EOD\n";
      plots += fmt::format("{}{} with linespoints pt 7 ps 0.8 lw 2 title \"{}\"", plots.empty() ? "" : ", ", block, line.name);
    }
    text_ += fmt::format("set title \"{}\" offset 0,0\nset xlabel \"{}\"\nset ylabel \"{}\"\nset key top left noenhanced font \",11\"\n{}", title, x, y,
                         logarithmic ? "set logscale xy\n" : "set xrange [0:*]\nset yrange [0:*]\n");
    text_ += lines.empty() ? "" : "plot " + plots + "\n";
    text_ += "unset logscale\n";
  }

  /// The scenes with the longest frames, of which lines are drawn.
  std::vector<std::string> longest_scenes() const {
    std::vector<std::string> names = scenes_;
    std::ranges::stable_sort(names, [&](const std::string& a, const std::string& b) {
      const FramePoint *first = find(a, "cpu", size_), *second = find(b, "cpu", size_);
      return first != nullptr && second != nullptr && first->whole > second->whole;
    });
    if (names.size() > 5) names.resize(5);
    return names;
  }

  void by_threads() {
    std::vector<Line> all;
    for (const std::string& scene : longest_scenes()) {
      Line line{scene, ""};
      double one = 0;
      for (const FramePoint& p : report_.points) {
        if (p.scene != scene || p.backend != "cpu" || p.size != size_) continue;
        if (one == 0) one = p.whole * p.threads;
        line.data += fmt::format("{} {}\n", p.threads, one / p.whole);
      }
      all.push_back(std::move(line));
    }
    lines(all, "Threads", "threads", "times as fast as one", false);
  }

  void by_triangles() {
    std::vector<Line> all;
    for (const char* backend : {"cpu", "vulkan"}) {
      Line line{backend, ""};
      for (const FramePoint& p : report_.points)
        if (p.scene == "mesh" && p.backend == backend && (p.backend != "cpu" || p.threads == threads_))
          line.data += fmt::format("{} {}\n", p.triangles, p.whole * milliseconds);
      if (!line.data.empty()) all.push_back(std::move(line));
    }
    lines(all, "A ball of many triangles", "triangles", "ms");
  }

  void by_size() {
    std::vector<Line> all;
    for (const std::string& scene : longest_scenes()) {
      Line line{scene, ""};
      for (const FramePoint& p : report_.points)
        if (p.scene == scene && p.backend == "cpu" && p.threads == threads_)
          line.data += fmt::format("{} {}\n", p.size, p.whole * 1e9 / (static_cast<double>(p.size) * p.size));
      all.push_back(std::move(line));
    }
    lines(all, "Size", "side of the frame, pixels", "ns per pixel");
  }

  const FrameReport& report_;
  int size_, threads_;
  std::vector<std::string> scenes_;
  std::string text_;
  int series_ = 0;
};

}  // namespace

std::string csv_text(const FrameReport& report) {
  std::string text = "scene,size,backend,threads,triangles,plan_ms,vertices_ms,clip_ms,draw_ms,posts_ms,whole_ms,spread_ms\n";
  for (const FramePoint& p : report.points) {
    text += fmt::format("{},{},{},{},{}", p.scene, p.size, p.backend, p.threads, p.triangles);
    for (const Step& step : steps) text += fmt::format(",{:.4g}", p.*step.seconds * milliseconds);
    text += fmt::format(",{:.4g},{:.2g}\n", p.whole * milliseconds, p.spread * milliseconds);
  }
  return text;
}

std::string json_text(const FrameReport& report) {
  using nlohmann::ordered_json;
  ordered_json points = ordered_json::array();
  for (const FramePoint& p : report.points) {
    ordered_json& made = points.emplace_back();
    made = {{"scene", p.scene}, {"size", p.size}, {"backend", p.backend}, {"threads", p.threads}, {"triangles", p.triangles}};
    for (const Step& step : steps) made[std::string(step.name) + "_ms"] = p.*step.seconds * milliseconds;
    made["whole_ms"] = p.whole * milliseconds;
    made["spread_ms"] = p.spread * milliseconds;
  }
  const ordered_json whole{{"machines", report.machines}, {"points", points}};
  return whole.dump(1) + "\n";
}

std::string summary(const FrameReport& report) {
  std::string text = fmt::format("{:<22} {:>5} {:<7} {:>7} {:>9}", "scene, ms", "size", "backend", "threads", "triangles");
  for (const Step& step : steps) text += fmt::format(" {:>8}", step.name);
  text += fmt::format(" {:>8} {:>7}\n", "whole", "spread");
  for (const FramePoint& p : report.points) {
    text += fmt::format("{:<22} {:>5} {:<7} {:>7} {:>9}", p.scene, p.size, p.backend, p.threads, p.triangles);
    for (const Step& step : steps) text += fmt::format(" {:>8.3g}", p.*step.seconds * milliseconds);
    text += fmt::format(" {:>8.3g} {:>7.2g}\n", p.whole * milliseconds, p.spread * milliseconds);
  }
  return text;
}

std::string gnuplot_text(const FrameReport& report, const std::string& output) { return Plot(report).text(output); }

}  // namespace isoshade::bench
