// SPDX-License-Identifier: Apache-2.0
// What random documents are made of beside the node table: ranges, and the documents of the library.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "compiler/check/stage_needs.h"
#include "compiler/graph/graph.h"
#include "tests/unit/front_end.h"

namespace isoshade::accuracy {

using graph::Type;

struct Range {
  double lo, hi;
};

/// What a port is given so that its node has a chance to be proved: divisors that are not 0, bases that are positive.
struct Tame {
  std::string_view row;
  size_t port;
  Range range;
};
inline constexpr Tame tame_ports[] = {
    {"divide", 1, {0.1, 10}},      {"/", 1, {0.1, 10}},          {"modulo", 1, {0.25, 4}},
    {"mod", 1, {0.25, 4}},         {"power", 0, {0.001, 10}},    {"power", 1, {-8, 8}},
    {"pow", 0, {0.001, 10}},       {"pow", 1, {-8, 8}},          {"safepower", 0, {0.001, 10}},
    {"safepower", 1, {-8, 8}},     {"sqrt", 0, {0, 1000}},       {"rsqrt", 0, {1e-6, 1e6}},
    {"ln", 0, {1e-6, 1e6}},        {"log", 0, {1e-6, 1e6}},      {"log2", 0, {1e-6, 1e6}},
    {"asin", 0, {-1, 1}},          {"acos", 0, {-1, 1}},         {"exp", 0, {-87, 80}},
    {"exp2", 0, {-126, 120}},      {"remap", 1, {0, 0.4}},       {"remap", 2, {0.6, 1}},
    {"smoothstep", 1, {0, 0.4}},   {"smoothstep", 2, {0.6, 1}},  {"fractal3d", 2, {1.5, 3}},
    {"fractal3d", 3, {0, 1}},      {"normalize", 0, {0.1, 10}},  {"worleynoise2d", 1, {0, 1}},
    {"tan", 0, {-1.5, 1.5}},       {"rotate2d", 1, {-720, 720}}, {"place2d", 2, {0.1, 10}},
    {"srgb_decode", 0, {0, 1}},    {"srgb_encode", 0, {0, 1}},   {"convert", 0, {-1000, 1000}},
    {"integer", 0, {-1000, 1000}},
};

inline constexpr Range ranges[] = {{0, 1},          {0, 1},        {-1, 1},        {0.1, 10},
                                   {-10, 10},       {0, 1000},     {1e-3, 1},      {1e-38, 1e-30},
                                   {-1e-37, 1e-37}, {1e18, 1e19},  {0.999, 1.01},  {0.00001, 0.001},
                                   {-100, -0.01},   {-8192, 8192}, {0.5, 2},       {2, 2},
                                   {0, 0},          {1e30, 3e38},  {-1e-20, 1e-20}};

/// An output of a library document's, and its ports.
struct Callee {
  std::string name;
  std::vector<graph::Input> inputs;
  std::vector<std::pair<std::string, Type>> outputs;
};

inline const std::vector<Callee>& callees(const std::string& library) {
  static const std::vector<Callee> all = [&] {
    namespace fs = std::filesystem;
    std::vector<Callee> found;
    for (const auto& file : fs::recursive_directory_iterator(library)) {
      if (file.path().extension() != ".json") continue;
      FrontEnd front_end(library);
      const auto graph = front_end.check_file(file.path().string());
      if (graph == nullptr || !check::stands_alone(*graph, front_end.diagnostics)) continue;
      Callee callee{fs::relative(file.path(), library).replace_extension().string(), graph->graph.inputs, {}};
      for (size_t i = 0; i < graph->outputs.size(); ++i)
        callee.outputs.emplace_back(graph->graph.outputs[i].name, graph->outputs[i].needed);
      const bool any = std::ranges::any_of(callee.inputs, [](const graph::Input& i) { return i.any; });
      if (!any) found.push_back(std::move(callee));
    }
    std::ranges::sort(found, {}, &Callee::name);
    return found;
  }();
  return all;
}

}  // namespace isoshade::accuracy
