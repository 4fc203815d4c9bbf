// SPDX-License-Identifier: Apache-2.0
// Posts as IR: what post_process asks for, and what it reads by functions without bodies.
#include <set>

#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

/// The parameters of post_process, in order.
std::string parameters_of(const std::string& nodes) {
  FrontEnd front_end;
  const ir::Module module = front_end.lower(R"({"isoshade": 1, "post": "p", "images": ["glow", "unused"],
    "parameters": {"tint": {"type": "color4", "value": [1, 1, 1, 1]}, "unused": {"type": "float", "value": 1}},
    "nodes": {)" + nodes + R"(}, "outputs": {"color": "color"}})");
  std::string list;
  for (const ir::Parameter& parameter : module.functions[module.find(interface::names::post_process)].parameters)
    list += (list.empty() ? "" : " ") + parameter.group + "." + parameter.name;
  return list;
}

TEST(LowerPost, TakesOnlyTheInputsItUses) {
  EXPECT_EQ(parameters_of(
                R"("c": {"type": "scenecolor"}, "color": {"type": "multiply", "in1": "c", "in2": "tint"})"),
            "screen.color_x screen.color_y parameters.tint");
  EXPECT_EQ(parameters_of(R"("i": {"type": "tapindex"}, "c": {"type": "scenecolor", "offsetx": "i"},
    "color": {"type": "sum_taps", "in": "c", "first": -2, "last": 2})"),
            "screen.color_x screen.color_y sizes.color_width sizes.color_height taps.color");
  EXPECT_EQ(parameters_of(R"("color": {"type": "scenecolor", "image": "glow", "filter": "linear"})"),
            "screen.image_glow_x screen.image_glow_y screen.image_glow_inside sizes.image_glow_width "
            "sizes.image_glow_height");
  EXPECT_EQ(parameters_of(R"("d": {"type": "scenedepth"}, "color": {"type": "constant", "value": "d"})"),
            "screen.depth_x screen.depth_y");
  EXPECT_EQ(
      parameters_of(R"("d": {"type": "scenedepth"}, "color": {"type": "constant", "value": "d.linear"})"),
      "screen.depth_x screen.depth_y camera.depth_numerator camera.depth_denominator");
  EXPECT_EQ(parameters_of(R"("p": {"type": "worldposition", "space": "camera"},
    "color": {"type": "convert", "in": "p", "to": "color3"})"),
            "screen.view_ray screen.relative_origin screen.depth_x screen.depth_y camera.depth_numerator "
            "camera.depth_denominator");
}

TEST(LowerPost, TellsWhetherPixelsOfOneColorAndDepthBecomeTheSame) {
  const auto is = [](const std::string& nodes) {
    FrontEnd front_end;
    const auto graph = front_end.check(R"({"isoshade": 1, "post": "p", "images": ["glow"],
      "nodes": {"s": {"type": "scenecolor"}, )" + nodes + R"(}, "outputs": {"color": "color"}})");
    EXPECT_NE(graph, nullptr) << front_end.diagnostics.text();
    if (graph == nullptr) return std::string();
    const lower::Lowered lowered = lower::lower(*graph);
    if (!lower::is_pointwise(lowered)) return std::string("reads others");
    return std::string(lower::ignores_place(lowered) ? "same" : "by place");
  };
  const auto added = [](const std::string& node, const std::string& part) {
    return "\"n\": {\"type\": " + node + R"json(}, "color": {"type": "expression", "code": "s * ()json" + part +
           R"json()", "s": "s", "n": "n"})json";
  };
  EXPECT_EQ(is(added(R"("time")", "n")), "same");
  EXPECT_EQ(is(added(R"("scenedepth")", "n")), "same");
  EXPECT_EQ(is(added(R"("cameraposition")", "n.x")), "same");
  EXPECT_EQ(is(added(R"("viewray")", "n.x")), "by place");
  EXPECT_EQ(is(added(R"("worldposition")", "n.x")), "by place");
  EXPECT_EQ(is(added(R"("screencoord")", "n.x")), "by place");
  EXPECT_EQ(is(added(R"("scenecolor", "offsetx": 1)", "n.r")), "reads others");
  EXPECT_EQ(is(added(R"("scenecolor", "image": "glow")", "n.r")), "reads others");
}

TEST(LowerPost, ReservesItsOwnNames) {
  // Functions of documents that are called as what surrounds a post.
  FrontEnd front_end;
  std::string nodes, last = "s.r";
  for (const char* name :
       {"color_at", "depth_at", "edge_clamp", "post_process", "post", "under", "image_glow_at"}) {
    front_end.library.add(
        "library/" + std::string(name) + ".json",
        R"({"isoshade": 1, "function": ")" + std::string(name) +
            R"(", "inputs": {"x": {"type": "float"}}, "nodes": {"n": {"type": "sin", "in": "x"}},
                              "outputs": {"out": "n"}})");
    nodes += ", \"n_" + std::string(name) + R"(": {"type": ")" + name + R"(", "x": ")" + last + "\"}";
    last = "n_" + std::string(name);
  }
  const ir::Module module = front_end.lower(
      R"({"isoshade": 1, "post": "p", "images": ["glow"], "nodes": {"s": {"type": "scenecolor", "offsetx": 1},
      "d": {"type": "scenedepth", "offsetx": 1}, "g": {"type": "scenecolor", "image": "glow"})" +
      nodes + R"(, "a": {"type": "multiply", "in1": "g", "in2": "d"},
      "color": {"type": "multiply", "in1": "a", "in2": ")" +
      last + R"("}}, "outputs": {"color": "color"}})");
  std::set<std::string> names;
  for (const ir::Function& function : module.functions)
    EXPECT_TRUE(names.insert(function.name).second) << function.name;
  for (const char* name : {"color_at", "depth_at", "image_glow_at"}) {
    const uint32_t found = module.find(name);
    ASSERT_NE(found, ir::none) << name;
    EXPECT_TRUE(module.functions[found].is_declaration()) << name;
  }
}

}  // namespace
}  // namespace isoshade
