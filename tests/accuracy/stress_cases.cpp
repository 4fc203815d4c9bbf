// SPDX-License-Identifier: Apache-2.0
#include "tests/accuracy/stress_cases.h"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "compiler/support/parse_number.h"

namespace isoshade::accuracy {

using reference::Real;

namespace {

constexpr double largest = std::numeric_limits<float>::max();

float number(const nlohmann::json& json) {
  const auto value = support::parse_float(json.get<std::string>());
  EXPECT_TRUE(value) << json;
  return value.value_or(0);
}

Case read_case(const std::string& line) {
  const auto json = nlohmann::json::parse(line);
  Case made;
  made.id = json.at("id");
  for (const auto& [name, value] : json.at("in").items()) {
    std::vector<float>& components = made.inputs[name];
    std::string text;
    for (const auto& component : value.is_array() ? value : nlohmann::json::array({value})) {
      components.push_back(number(component));
      text += (text.empty() ? "" : " ") + component.get<std::string>();
    }
    made.inputs_text += (made.inputs_text.empty() ? "" : ", ") + (name + " = " + text);
  }
  const auto& accept = json.at("accept");
  if (json.contains("ref")) made.wanted.emplace_back(json.at("ref").get<std::string>());
  for (const char* key : {"equal", "near"})
    if (accept.contains(key))
      for (const double value : accept.at(key)) made.wanted.emplace_back(value);
  if (accept.contains("ulp")) made.ulp = accept.at("ulp").get<double>();
  if (accept.contains("abs")) made.absolute = accept.at("abs").get<double>();
  if (accept.contains("within")) {
    made.low = accept.at("within")[0];
    made.high = accept.at("within")[1].is_string() ? largest : accept.at("within")[1].get<double>();
  }
  return made;
}

/// The unit in the last place of a float of this size; of denormals that of the least.
Real last_place(const Real& wanted) {
  if (wanted == 0) return 0x1p-149;
  const auto exponent = static_cast<double>(floor(log2(abs(wanted))));
  return std::ldexp(1.0, static_cast<int>(std::max(exponent, -126.0)) - 23);
}

void judge(Outcome& outcome) {
  const Case& made = *outcome.made;
  outcome.accepted = true;
  const size_t count = std::max<size_t>(1, made.wanted.size());
  for (size_t i = 0; i < count; ++i) {
    const float given = outcome.results[i];
    if (!std::isfinite(given)) {
      outcome.error = INFINITY;
      outcome.accepted = false;
      return;
    }
    if (made.wanted.empty()) {
      outcome.accepted &= given >= made.low && given <= made.high;
      continue;
    }
    const Real off = abs(Real(given) - made.wanted[i]);
    const Real unit = made.ulp ? last_place(made.wanted[i]) : Real(1);
    const Real flushed = made.ulp || made.absolute ? 0x1p-126 : 0.0;  // denormals are zeros
    const Real allowed = unit * made.ulp.value_or(made.absolute.value_or(0)) + flushed;
    outcome.accepted &= off <= allowed;
    if (off > flushed) outcome.error = std::max(outcome.error, static_cast<double>(off / unit));
  }
}

std::vector<float> fed(const Case& made, const std::vector<std::string>& feeds) {
  std::vector<float> inputs;
  for (const std::string& feed : feeds) {
    const size_t star = feed.find('*');
    const std::string name = feed.substr(0, star);
    const std::vector<float> value =
        name[0] == '=' ? std::vector{std::stof(name.substr(1))} : made.inputs.at(name);
    const int copies = star == std::string::npos ? 1 : std::stoi(feed.substr(star + 1));
    for (int i = 0; i < copies; ++i) inputs.insert(inputs.end(), value.begin(), value.end());
  }
  return inputs;
}

}  // namespace

const std::vector<Case>& cases() {
  static const std::vector<Case> all = [] {
    std::vector<Case> read;
    std::ifstream file(ISOSHADE_ACCURACY_DATA "/stress_cases.jsonl");
    for (std::string line; std::getline(file, line);) read.push_back(read_case(line));
    return read;
  }();
  return all;
}

const std::vector<Form>& library_forms() {
  static const std::vector<Form> all = {
      {"ggx_d", Subject::document("library/brdf/ggx_d"), {"r", "N"}},
      {"schlick", Subject::document("library/brdf/schlick_f"), {"R*3", "c"}},
      {"specular_vec", Subject::document("library/brdf/cook_torrance"), {"n", "l", "v", "r", "R*3"}},
      {"fog_density",
       Subject::document("library/fog/height_density"),
       {"cam_y", "z", "ray_y", "H_begin", "H_end", "fogDensity"}},
      {"depth_reversed", Subject::document("library/depth/from_reversed"), {"d", "near", "far"}},
      {"depth_standard", Subject::document("library/depth/from_standard"), {"d", "near", "far"}},
      {"depth_inf_reversed", Subject::document("library/depth/from_infinite_reversed"), {"d", "near"}},
      {"toon_spec", Subject::document("library/toon/highlight"), {"spec", "scale", "w", "least_scale"}},
      {"outline_normal", Subject::expression({"n:vector3"}, "normalize(vector3(n.x, n.y, -1))"), {"n"}},
      {"normalize_x", Subject::expression({"v:vector3"}, "normalize(v)"), {"v"}},
      {"mix", Subject::row("mix", 3), {"a", "b", "t"}},
      {"srgb_decode", Subject::row("srgb_decode", 1), {"c"}},
      {"srgb_encode", Subject::row("srgb_encode", 1), {"c"}},
      {"aces", Subject::document("library/tonemap/aces"), {"x*3"}, 3},
      {"rcp", Subject::expression({"x"}, "1 / x"), {"x"}},
      {"rsqrt", Subject::row("rsqrt", 1), {"x"}},
      {"sqrt", Subject::expression({"x"}, "sqrt(x)"), {"x"}},
      {"exp2", Subject::row("exp2", 1), {"x"}},
      {"log2", Subject::row("log2", 1), {"x"}},
      {"pow", Subject::row("pow", 2), {"x", "y"}},
      {"sin", Subject::row("sin", 1), {"x"}},
      {"cos", Subject::row("cos", 1), {"x"}},
      {"atan2", Subject::row("atan2", 2), {"x", "y"}},
  };
  return all;
}

const std::vector<Form>& source_forms() {
  static const std::vector<Form> all = {
      {"ggx_d", Subject::document("source_forms/ggx_d"), {"r", "N"}},
      {"schlick", Subject::document("source_forms/schlick_f"), {"R*3", "c"}},
      {"specular_vec",
       Subject::document("source_forms/cook_torrance"),
       {"n", "l", "v", "r", "R*3", "=0*3", "=1*3", "=1*3"}},
      {"fog_density",
       Subject::document("source_forms/fog_density"),
       {"cam_y", "z", "ray_y", "H_begin", "H_end", "fogDensity"}},
      {"depth_standard", Subject::document("source_forms/depth_standard"), {"d", "near", "far"}},
      {"toon_spec", Subject::document("source_forms/toon_highlight"), {"spec", "scale", "w", "least_scale"}},
      {"outline_normal",
       Subject::expression({"n:vector3"},
                           "vector3(n.x, n.y, -1) / vector3(sqrt(dot(vector3(n.x, n.y, -1), "
                           "vector3(n.x, n.y, -1))))"),
       {"n"}},
      {"normalize_x", Subject::expression({"v:vector3"}, "v / vector3(sqrt(dot(v, v)))"), {"v"}},
      {"mix", Subject::document("source_forms/mix"), {"a", "b", "t"}},
      {"aces", Subject::expression({"x"}, "(x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14)"), {"x"}},
  };
  return all;
}

std::vector<Outcome> outcomes(const Form& form) {
  std::vector<Outcome> all;
  std::vector<float> inputs;
  for (const Case& made : cases()) {
    if (made.id.substr(0, made.id.rfind('-')) != form.group) continue;
    all.push_back({&made, {}, 0, false});
    const std::vector<float> row = fed(made, form.feeds);
    EXPECT_EQ(row.size(), form.subject.inputs()) << made.id;
    inputs.insert(inputs.end(), row.begin(), row.end());
  }
  const std::vector<float> results = form.subject(inputs);
  const size_t width = form.subject.results();
  for (size_t i = 0; i < all.size(); ++i) {
    const auto first = results.begin() + static_cast<ptrdiff_t>(i * width + form.result);
    all[i].results.assign(first, results.begin() + static_cast<ptrdiff_t>((i + 1) * width));
    judge(all[i]);
  }
  return all;
}

}  // namespace isoshade::accuracy
