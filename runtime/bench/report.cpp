// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "runtime/bench/measure.h"

namespace isoshade::bench {

namespace {

/// A column of the tables: calls visit(name, value) for each.
template <class Visit>
void for_each_column(const Point& p, const Visit& visit) {
  visit("effect", p.effect);
  visit("form", p.form);
  visit("precision", p.precision);
  visit("backend", p.backend);
  visit("lanes", p.lanes);
  visit("compute", p.compute);
  visit("compute_spread", p.compute_spread);
  visit("evaluation", p.evaluation);
  visit("making", p.making);
  visit("nanoseconds", p.nanoseconds);
  visit("spread", p.spread);
  visit("transfer", p.transfer);
  visit("cycles", p.cycles);
  visit("port_cycles", p.port_cycles);
  visit("simulated_cycles", p.simulated_cycles);
  visit("spills", p.spills);
  visit("busiest", p.busiest);
  visit("max_ulp", p.max_ulp);
  visit("mean_ulp", p.mean_ulp);
  visit("max_absolute", p.max_absolute);
  visit("identical", p.identical);
}

std::string cell(const std::string& text) { return text; }
std::string cell(double number) { return fmt::format("{:.5g}", number); }
std::string cell(bool value) { return value ? "yes" : "no"; }

}  // namespace

std::string csv_text(const Report& report) {
  std::string text;
  for_each_column(Point(), [&](const char* name, const auto&) { text += (text.empty() ? "" : ",") + std::string(name); });
  text += '\n';
  for (const Point& p : report.points) {
    bool first = true;
    for_each_column(p, [&](const char*, const auto& value) {
      text += (first ? "" : ",") + cell(value);
      first = false;
    });
    text += '\n';
  }
  return text;
}

std::string json_text(const Report& report) {
  using nlohmann::ordered_json;
  ordered_json points = ordered_json::array();
  for (const Point& p : report.points) {
    ordered_json& made = points.emplace_back();
    for_each_column(p, [&](const char* name, const auto& value) { made[name] = value; });
  }
  const ordered_json whole{{"machines", report.machines}, {"gigahertz", report.gigahertz}, {"notes", report.notes}, {"points", points}};
  return whole.dump(1) + "\n";
}

std::vector<const Point*> pareto_front(const std::vector<const Point*>& points) {
  std::vector<const Point*> front = points;
  std::ranges::sort(front, [](const Point* a, const Point* b) {
    return std::pair(time_of(*a), a->max_ulp) < std::pair(time_of(*b), b->max_ulp);
  });
  double least = no_digit * 2;
  std::erase_if(front, [&](const Point* point) {
    if (point->max_ulp >= least) return true;
    least = point->max_ulp;
    return false;
  });
  return front;
}

std::string summary(const Report& report) {
  std::string text = fmt::format("{:<15} {:<9} {:<10} {:<14} {:>9} {:>8} {:>9} {:>9} {:>6} {:>11} {:>10}  {}\n", "effect",
                                 "form", "precision", "backend", "ns", "spread", "with I/O", "I/O", "ports", "max ULP",
                                 "mean ULP", "bits");
  for (const Point& p : report.points) {
    const bool is_scene = p.form == "scene";
    const auto number = [&](double value) { return is_scene ? std::string() : fmt::format("{:.3g}", value); };
    const std::string ports = p.cycles > 0 ? fmt::format("{:.0f} %", 100 * p.port_cycles / p.cycles) : "";
    text += fmt::format("{:<15} {:<9} {:<10} {:<14} {:>9.3g} {:>8.2g} {:>9} {:>9} {:>6} {:>11.4g} {:>10.3g}  {}\n", p.effect,
                        p.form, p.precision, p.lanes.empty() ? p.backend : p.backend + "-" + p.lanes,
                        time_of(p), is_scene ? p.spread : p.compute_spread, number(p.nanoseconds), number(p.transfer),
                        ports, p.max_ulp, p.mean_ulp, p.identical ? "identical" : "differ");
  }
  for (const std::string& note : report.notes) text += "note: " + note + "\n";
  return text;
}

std::string ratios_text(const Report& report) {
  std::string lanes;
  for (const Point& p : report.points)
    if (p.backend == "cpu") lanes = p.lanes;
  const auto find = [&](const Point& like, const std::string& backend, const std::string& precision,
                        const std::string& its_lanes) -> const Point* {
    for (const Point& p : report.points)
      if (p.effect == like.effect && p.form == like.form && p.backend == backend && p.precision == precision &&
          p.lanes == its_lanes)
        return &p;
    return nullptr;
  };
  std::string text = fmt::format(
      "| cpu, {} lanes | compute, ns | transfer, ns | of the port bound | busiest | GLM / ours | its max ULP / ours | SPIRV-Cross / ours "
      "| one lane / ours | Vulkan / ours | built-ins / Vulkan |\n|---|---|---|---|---|---|---|---|---|---|---|\n", lanes);
  for (const Point& p : report.points) {
    if (p.backend != "cpu" || p.lanes != lanes || p.form != "library" || p.precision != "default" || p.compute <= 0)
      continue;
    // No ratio of a time that the clock cannot tell from none.
    const auto is_measured = [](const Point* point) { return point != nullptr && point->compute > point->compute_spread; };
    const auto ratio = [&](const Point* other, const Point* base) {
      return is_measured(other) && is_measured(base) ? fmt::format("{:.2g}", other->compute / base->compute)
                                                     : std::string("-");
    };
    const Point* glm = find(p, "glm", "peer", "1");
    const Point* vulkan = find(p, "vulkan", "default", "");
    Point source = p;
    source.form = "source";  // the built-ins are those of the source's formula
    text += fmt::format("| {} | {:.2f} | {:.2f} | {} | {} | {} | {} | {} | {} | {} | {} |\n", p.effect, p.compute, p.transfer,
                        p.cycles > 0 ? fmt::format("{:.0f} %", 100 * p.port_cycles / p.cycles) : "-",
                        p.busiest.empty() ? "-" : p.busiest, ratio(glm, &p),
                        glm != nullptr ? fmt::format("{:.3g} / {:.3g}", glm->max_ulp, p.max_ulp) : "-",
                        ratio(find(p, "spirv-cross", "peer", "1"), &p), ratio(find(p, "cpu", "default", "1"), &p),
                        ratio(vulkan, &p),
                        ratio(find(source, "vulkan", "built-ins", ""), find(source, "vulkan", "default", "")));
  }
  return text;
}

}  // namespace isoshade::bench
