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

namespace {

/// The point of the same effect and form with these; null if there is none.
const Point* find(const Report& report, const Point& like, std::string_view backend, std::string_view precision,
                  std::string_view lanes) {
  const auto found = std::ranges::find_if(report.points, [&](const Point& p) {
    return p.effect == like.effect && p.form == like.form && p.backend == backend && p.precision == precision &&
           p.lanes == lanes;
  });
  return found != report.points.end() ? &*found : nullptr;
}

/// The scenes that an ordinary renderer drew, too; empty if there are none.
std::string scene_ratios_text(const Report& report, const std::string& lanes) {
  std::string rows;
  for (const Point& forward : report.points) {
    if (forward.backend != forward_backend) continue;
    const Point* cpu = find(report, forward, "cpu", "default", lanes);
    const Point* vulkan = find(report, forward, "vulkan", "default", "");
    if (cpu == nullptr || vulkan == nullptr) continue;
    rows += fmt::format("| {} | {:.0f} | {:.0f} | {:.0f} | {:.2f} | {:.2g} / {:.2g} |\n", forward.effect, cpu->nanoseconds,
                        vulkan->nanoseconds, forward.nanoseconds, forward.nanoseconds / vulkan->nanoseconds,
                        forward.mean_ulp, vulkan->mean_ulp);
  }
  if (rows.empty()) return "";
  return fmt::format("\n| ns a pixel | cpu, {} lanes | Vulkan | forward, built-ins | forward / Vulkan | its mean ULP / ours |\n"
                     "|---|---|---|---|---|---|\n", lanes) + rows;
}

}  // namespace

std::string ratios_text(const Report& report) {
  std::string lanes;
  for (const Point& p : report.points)
    if (p.backend == "cpu") lanes = p.lanes;
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
    const Point* glm = find(report, p, "glm", "peer", "1");
    const Point* vulkan = find(report, p, "vulkan", "default", "");
    Point source = p;
    source.form = "source";  // the built-ins are those of the source's formula
    text += fmt::format("| {} | {:.2f} | {:.2f} | {} | {} | {} | {} | {} | {} | {} | {} |\n", p.effect, p.compute, p.transfer,
                        p.cycles > 0 ? fmt::format("{:.0f} %", 100 * p.port_cycles / p.cycles) : "-",
                        p.busiest.empty() ? "-" : p.busiest, ratio(glm, &p),
                        glm != nullptr ? fmt::format("{:.3g} / {:.3g}", glm->max_ulp, p.max_ulp) : "-",
                        ratio(find(report, p, "spirv-cross", "peer", "1"), &p), ratio(find(report, p, "cpu", "default", "1"), &p),
                        ratio(vulkan, &p),
                        ratio(find(report, source, "vulkan", "built-ins", ""), find(report, source, "vulkan", "default", "")));
  }
  return text + scene_ratios_text(report, lanes);
}

}  // namespace isoshade::bench
