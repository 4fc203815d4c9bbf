// SPDX-License-Identifier: Apache-2.0
#include "tests/accuracy/stress_comparison.h"

#include <bit>
#include <cstdio>

#include "tests/accuracy/property.h"
#include "tests/accuracy/subject.h"

namespace isoshade::accuracy {
namespace {

std::string text(double x) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.3g", x);
  return buffer;
}

Comparison missed_ends() {
  Random random;
  std::vector<float> inputs;
  for (int i = 0; i < 100000; ++i)
    inputs.insert(inputs.end(),
                  {static_cast<float>(random.between(-1, 1)), static_cast<float>(random.between(-1, 1)), 1});
  const auto misses = [&](const Subject& mix) {
    const std::vector<float> results = mix(inputs);
    int count = 0;
    for (size_t i = 0; i < results.size(); ++i) count += results[i] != inputs[3 * i + 1] ? 1 : 0;
    return std::to_string(count);
  };
  return {"mix: of 100,000 random end values, those not reached at t = 1", misses(Subject::row("mix", 3)),
          misses(Subject::document("source_forms/mix"))};
}

Comparison small_angles() {
  // Without functions of libm, which round otherwise elsewhere.
  std::vector<float> inputs;
  for (double tangent = 1e-6; tangent < 1e-3; tangent *= 1.007) {
    const double cosine = 1 / std::sqrt(1 + tangent * tangent);
    inputs.insert(inputs.end(),
                  {0, 0, 1, static_cast<float>(tangent * cosine), 0, static_cast<float>(cosine)});
  }
  const auto worst = [&](const Subject& form) {
    const std::vector<float> results = form(inputs);
    double error = 0;
    for (size_t i = 0; i < results.size(); ++i) {
      const double exact = std::atan2(double{inputs[6 * i + 3]}, double{inputs[6 * i + 5]});
      error = std::max(error, std::abs(results[i] - exact) / exact);
    }
    return text(error);
  };
  return {"angles from 1e-6 to 1e-3: largest relative error",
          worst(Subject::document("library/geometry/angle_between")),
          worst(Subject::document("source_forms/angle_between"))};
}

Comparison swapped_directions() {
  Random random;
  std::vector<float> straight, swapped;
  int count = 0;
  while (count < 100000) {
    const std::array<float, 3> l = random.direction(), v = random.direction();
    if (l[2] <= 0 || v[2] <= 0) continue;
    ++count;
    for (auto [inputs, first, second] : {std::tuple{&straight, &l, &v}, std::tuple{&swapped, &v, &l}}) {
      inputs->insert(inputs->end(), {0, 0, 1});
      inputs->insert(inputs->end(), first->begin(), first->end());
      inputs->insert(inputs->end(), second->begin(), second->end());
      inputs->insert(inputs->end(), {0.1f, 0.04f, 0.04f, 0.04f});
    }
  }
  const auto differing = [&](const Subject& brdf) {
    // The source's form has a diffuse part too: of nothing here.
    const auto complete = [&](const std::vector<float>& inputs) {
      std::vector<float> out;
      for (size_t i = 0; i < inputs.size(); i += 13) {
        out.insert(out.end(), inputs.begin() + static_cast<ptrdiff_t>(i),
                   inputs.begin() + static_cast<ptrdiff_t>(i + 13));
        for (size_t k = 13; k < brdf.inputs(); ++k) out.push_back(k < 16 ? 0.0f : 1.0f);
      }
      return out;
    };
    const std::vector<float> a = brdf(complete(straight)), b = brdf(complete(swapped));
    int count = 0;
    for (size_t i = 0; i < a.size(); i += brdf.results())
      count += std::bit_cast<uint32_t>(a[i]) != std::bit_cast<uint32_t>(b[i]) ? 1 : 0;
    return std::to_string(count);
  };
  return {
      "Cook-Torrance: of 100,000 pairs of directions, those where swapping light and viewer changes the "
      "result",
      differing(Subject::document("library/brdf/cook_torrance")),
      differing(Subject::document("source_forms/cook_torrance"))};
}

Comparison vectors_not_unit() {
  Random random;
  std::vector<float> inputs;
  for (int i = 0; i < 25000; ++i)
    for (const float c : random.direction()) inputs.push_back(std::ldexp(c, i % 250 - 124));
  const auto failing = [&](const Subject& normalize) {
    const std::vector<float> results = normalize(inputs);
    int count = 0;
    for (size_t i = 0; i < results.size(); i += 3) {
      const double square = double{results[i]} * results[i] + double{results[i + 1]} * results[i + 1] +
                            double{results[i + 2]} * results[i + 2];
      count += std::abs(std::sqrt(square) - 1) <= 0x1p-22 ? 0 : 1;
    }
    return std::to_string(count);
  };
  return {
      "normalize: of 25,000 vectors of lengths from 2^-124 to 2^125, those whose result does not have "
      "length 1",
      failing(Subject::expression({"v:vector3"}, "normalize(v)")),
      failing(Subject::expression({"v:vector3"}, "v / vector3(sqrt(dot(v, v)))"))};
}

Comparison distances_far_away() {
  const auto worst = [](const Subject& to_depth, const Subject& from_depth) {
    std::vector<float> distances, inputs, depths;
    for (double z = 0.1; z < 1000; z *= 1.0001) {
      distances.push_back(static_cast<float>(z));
      inputs.insert(inputs.end(), {distances.back(), 0.1f});
    }
    for (const float depth : to_depth(inputs)) {
      depths.insert(depths.end(), {depth, 0.1f});
      if (from_depth.inputs() == 3) depths.push_back(1000);
    }
    const std::vector<float> back = from_depth(depths);
    double error = 0;
    for (size_t i = 0; i < back.size(); ++i)
      error = std::max(error, std::abs(double{back[i]} - distances[i]) / distances[i]);
    return text(error);
  };
  return {
      "distances from 0.1 to 1000, converted to a depth and back: largest relative error (library: reversed "
      "depth; source: depth from 0 to 1)",
      worst(Subject::expression({"z", "near"}, "near / z"),
            Subject::document("library/depth/from_infinite_reversed")),
      worst(Subject::expression({"z", "near"}, "(1 / z - 1 / near) / (0.001 - 1 / near)"),
            Subject::document("source_forms/depth_standard"))};
}

}  // namespace

std::vector<Comparison> comparisons() {
  return {missed_ends(), small_angles(), swapped_directions(), vectors_not_unit(), distances_far_away()};
}

}  // namespace isoshade::accuracy
