// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <fmt/format.h>

#include "runtime/bench/measure.h"

namespace isoshade::bench {

namespace {

constexpr int columns = 3;

/// The hollow gnuplot mark of a precision; the next number is the filled mark of the same shape.
struct Mark {
  const char* precision;
  int shape;
};
constexpr Mark marks[] = {{"fast", 8}, {"default", 6}, {"precise", 4}, {"built-ins", 2}, {"peer", 1}};

/// The lanes to plot: the last of the cpu, which are the fastest.
std::string drawn_lanes(const Report& report) {
  std::string lanes;
  for (const Point& point : report.points)
    if (point.backend == "cpu") lanes = point.lanes;
  return lanes;
}

/// A logarithmic axis cannot show an error of 0.
double error_of(const Point& point) { return std::max(point.max_ulp, 0.1); }

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

class Plot {
 public:
  explicit Plot(const Report& report) : report_(report), lanes_(drawn_lanes(report)) {
    for (const Point& point : report.points)
      if (std::ranges::find(effects_, point.effect) == effects_.end()) effects_.push_back(point.effect);
  }

  std::string text(const std::string& output) {
    const int rows = static_cast<int>(effects_.size() + columns) / columns;  // one more panel for the key
    text_ = fmt::format(
        "set terminal svg size {},{} font \"sans-serif,14\" background \"white\"\nset output {}\n"
        "set multiplot layout {},{} title \"Time against error; below and to the left is better\"\n"
        "set logscale xy\nset grid back lc rgb \"#dddddd\"\nset format y \"10^{{%T}}\"\nset key off\n"
        "set tics nomirror\nset border 3\nset style fill transparent solid 0.1\n",
        columns * 400, rows * 320 + 40, quoted(output), rows, columns);
    for (size_t i = 0; i < effects_.size(); ++i) panel(effects_[i], i);
    key();
    return text_ + "unset multiplot\n";
  }

 private:
  /// Omits points whose time is too short to measure.
  std::vector<const Point*> points_of(const std::string& effect, bool vulkan) const {
    std::vector<const Point*> points;
    for (const Point& point : report_.points)
      if (point.effect == effect && time_of(point) > 0 &&
          (vulkan ? point.backend == "vulkan" || point.backend == forward_backend : point.lanes == lanes_ || point.precision == "peer"))
        points.push_back(&point);
    return points;
  }

  /// What a panel shows.
  struct Area {
    double earliest, latest, lowest, highest;
    std::string unit;
  };
  Area area_of(const std::string& effect) const {
    Area area{1e300, 0, 1e300, 0, "ns per evaluation, without transfer"};
    for (const bool vulkan : {false, true})
      for (const Point* point : points_of(effect, vulkan)) {
        area.earliest = std::min(area.earliest, time_of(*point) / 1.5);
        area.latest = std::max(area.latest, time_of(*point) * 2.5);  // with room for a label
        area.lowest = std::min(area.lowest, error_of(*point) / 3);
        area.highest = std::max(area.highest, error_of(*point) * 6);
        if (point->form == "scene") area.unit = "ns per pixel";
      }
    if (area.latest == 0) return {0.1, 1, 0.1, 1, area.unit};
    return area;
  }

  void add_series(const std::string& data, const std::string& style) {
    const std::string name = fmt::format("$d{}", series_++);
    blocks_ += name + " << EOD\n" + data + "EOD\n";
    plots_.push_back(name + " " + style);
  }

  void panel(const std::string& effect, size_t index) {
    blocks_.clear();
    plots_.clear();
    const Area area = area_of(effect);
    for (const bool vulkan : {false, true}) {
      const std::vector<const Point*> points = points_of(effect, vulkan);
      const char* color = vulkan ? "#b3541e" : "#1f4e9c";
      std::vector<const Point*> ours;
      for (const Point* point : points)
        if (!is_foreign(point->precision)) ours.push_back(point);
      if (ours.empty()) continue;
      // What lies beyond the front is beaten by some point.
      std::string corners, front;
      double error = area.highest;
      for (const Point* point : pareto_front(ours)) {
        for (const double y : {error, error_of(*point)}) corners += fmt::format("{} {}\n", time_of(*point), y);
        error = error_of(*point);
      }
      front = corners + fmt::format("{} {}\n", area.latest, error);
      add_series(front + fmt::format("{} {}\n", area.latest, area.highest),
                 fmt::format("with filledcurves closed fc rgb \"{}\" fs transparent solid 0.10 noborder", color));
      add_series(front, fmt::format("with lines lc rgb \"{}\" lw 3 dt {}", color, vulkan ? 2 : 1));
      for (const Mark& mark : marks) {
        std::string data, letters;
        for (const Point* point : points) {
          if (point->precision != mark.precision) continue;
          data += fmt::format("{} {}\n", time_of(*point), error_of(*point));
          if (point->precision == "peer" || point->backend == forward_backend)
            letters += fmt::format("{} {} {}\n", time_of(*point), error_of(*point), point->backend);
          else if (point->form == "source") letters += fmt::format("{} {} s\n", time_of(*point), error_of(*point));
        }
        const bool foreign = is_foreign(mark.precision);
        const int shape = mark.shape + (vulkan || foreign ? 0 : 1);
        if (!data.empty())
          add_series(data, fmt::format("with points pt {} ps 1.5 lw 2 lc rgb \"{}\"", shape,
                                       foreign ? "#333333" : color));
        if (!letters.empty())
          add_series(letters, "with labels left offset 0.8,0.5 font \",11\" textcolor rgb \"#333333\"");
      }
    }
    text_ +=
        blocks_ + fmt::format("set title {} noenhanced\nset xrange [{}:{}]\nset yrange [{}:{}]\nset xlabel \"{}\"\nset ylabel \"{}\"\n",
                              quoted(effect), area.earliest, area.latest, area.lowest, area.highest, area.unit, index % columns == 0 ? "largest error, ULP" : "");
    if (plots_.empty()) plots_.push_back("NaN");
    text_ += "plot ";
    for (size_t i = 0; i < plots_.size(); ++i) text_ += (i ? ", \\\n  " : "") + plots_[i];
    text_ += "\n";
  }

  /// A panel without axes that shows each mark with its meaning.
  void key() {
    text_ +=
        "unset logscale\nunset tics\nunset border\nunset grid\nset title \"\"\nset xlabel \"\"\nset ylabel "
        "\"\"\n"
        "set xrange [0:1]\nset yrange [0:1]\n";
    std::string marks_text, labels;
    const auto line = [&](double y, const std::string& text) {
      labels += fmt::format("set label {} at 0.22,{} left noenhanced\n", quoted(text), y);
    };
    std::string plots;
    const auto mark = [&](double x, double y, int shape, const char* color) {
      const std::string name = fmt::format("$k{}", series_++);
      marks_text += fmt::format("{} << EOD\n{} {}\nEOD\n", name, x, y);
      plots += fmt::format("{}{} with points pt {} ps 1.1 lw 1.5 lc rgb \"{}\"",
                           plots.empty() ? "" : ", \\\n  ", name, shape, color);
    };
    const auto rule = [&](double y, int dash, const char* color) {
      const std::string name = fmt::format("$k{}", series_++);
      marks_text += fmt::format("{} << EOD\n0.02 {}\n0.18 {}\nEOD\n", name, y, y);
      plots += fmt::format(", \\\n  {} with lines lw 1.5 dt {} lc rgb \"{}\"", name, dash, color);
    };
    double y = 0.95;
    for (const Mark& m : marks) {
      const std::string_view precision = m.precision;
      if (!is_foreign(precision)) mark(0.06, y, m.shape + 1, "#1f4e9c");
      mark(0.14, y, m.shape, is_foreign(precision) ? "#333333" : "#b3541e");
      line(y, precision == "built-ins" ? "GLSL's built-ins on vulkan (bits differ)"
              : precision == "peer"    ? "scalar C++ of others (bits differ)"
                                       : "precision " + std::string(precision));
      y -= 0.11;
    }
    line(y, "filled: cpu, lanes " + lanes_);
    line(y -= 0.11, "hollow: vulkan");
    labels += fmt::format("set label \"s\" at 0.1,{} center font \",10\"\n", y -= 0.11);
    line(y, "formula of the source");
    rule(y -= 0.11, 1, "#1f4e9c");
    line(y, "front, cpu");
    rule(y -= 0.11, 2, "#b3541e");
    line(y, "front, vulkan");
    text_ += marks_text + labels + "plot " + plots + "\n";
  }

  const Report& report_;
  std::string lanes_;
  std::vector<std::string> effects_;
  std::string text_, blocks_;
  std::vector<std::string> plots_;
  int series_ = 0;
};

}  // namespace

std::string gnuplot_text(const Report& report, const std::string& output) {
  return Plot(report).text(output);
}

}  // namespace isoshade::bench
