// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "runtime/bench/measure.h"

namespace isoshade::bench {

std::string csv_text(const Report& report) {
  std::string text =
      "effect,form,precision,backend,lanes,nanoseconds,spread,transfer,max_ulp,mean_ulp,max_absolute,"
      "identical\n";
  for (const Point& p : report.points)
    text += fmt::format("{},{},{},{},{},{:.4g},{:.2g},{:.4g},{:.5g},{:.4g},{:.4g},{}\n", p.effect, p.form,
                        p.precision, p.backend, p.lanes, p.nanoseconds, p.spread, p.transfer, p.max_ulp,
                        p.mean_ulp, p.max_absolute, p.identical ? "yes" : "no");
  return text;
}

std::string json_text(const Report& report) {
  using nlohmann::ordered_json;
  ordered_json points = ordered_json::array();
  for (const Point& p : report.points)
    points.push_back({{"effect", p.effect},
                      {"form", p.form},
                      {"precision", p.precision},
                      {"backend", p.backend},
                      {"lanes", p.lanes},
                      {"nanoseconds", p.nanoseconds},
                      {"spread", p.spread},
                      {"transfer", p.transfer},
                      {"max_ulp", p.max_ulp},
                      {"mean_ulp", p.mean_ulp},
                      {"max_absolute", p.max_absolute},
                      {"identical", p.identical}});
  return ordered_json{{"machines", report.machines}, {"points", points}}.dump(1) + "\n";
}

std::vector<const Point*> pareto_front(const std::vector<const Point*>& points) {
  std::vector<const Point*> front = points;
  std::ranges::sort(front, [](const Point* a, const Point* b) {
    return std::pair(a->nanoseconds, a->max_ulp) < std::pair(b->nanoseconds, b->max_ulp);
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
  std::string text =
      fmt::format("{:<15} {:<9} {:<10} {:<12} {:>9} {:>8} {:>11} {:>10}  {}\n", "effect", "form", "precision",
                  "backend", "ns", "spread", "max ULP", "mean ULP", "bits");
  for (const Point& p : report.points)
    text += fmt::format("{:<15} {:<9} {:<10} {:<12} {:>9.3g} {:>8.2g} {:>11.4g} {:>10.3g}  {}\n", p.effect,
                        p.form, p.precision, p.lanes.empty() ? p.backend : p.backend + "-" + p.lanes,
                        p.nanoseconds, p.spread, p.max_ulp, p.mean_ulp, p.identical ? "identical" : "differ");
  return text;
}

}  // namespace isoshade::bench
