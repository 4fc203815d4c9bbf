// SPDX-License-Identifier: Apache-2.0
// Passes of effects as IR: what shade asks for, and loops over lights.
#include "compiler/ir/printer.h"
#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

std::string effect(const std::string& nodes, const std::string& color = "color") {
  return R"({"isoshade": 1, "effect": "e", "parameters": {
    "tint": {"type": "color3", "value": [1, 1, 1]}, "alpha": {"type": "color4", "value": [1, 1, 1, 1]},
    "unused": {"type": "float", "value": 1}, "count": {"type": "integer", "value": 1}},
"nodes": {
)" + nodes +
         "\n},\n\"passes\": [{\"name\": \"p\", \"color\": \"" + color + "\"}]}";
}

/// Gives light_at a body: light i shines with color (2^i, 10 * 2^i, 0) along (0, i, 1).
void define_lights(ir::Module& module) {
  const uint32_t light_at = module.find(interface::names::light_at);
  ASSERT_NE(light_at, ir::none);
  ASSERT_TRUE(module.functions[light_at].is_declaration());
  ir::Builder b(module, light_at);
  const ir::ValueId index = b.op(ir::Opcode::itof, {b.parameter(0)});
  const ir::ValueId power = functions::call_library(b, "exp2", std::array{index}).front();
  const ir::ValueId ten = b.op(ir::Opcode::fmul, {power, b.constant(10.0f)});
  const ir::ValueId direction = b.construct(std::array{b.constant(0.0f), index, b.constant(1.0f)});
  const ir::ValueId color = b.construct(std::array{power, ten, b.constant(0.0f)});
  b.finish(std::array{direction, color});
}

/// The colour of a surface point whose parameters are all `value` floats, lit by `lights`.
std::vector<float> shade(ir::Module module, std::vector<float> arguments, int lights) {
  define_lights(module);
  arguments.push_back(std::bit_cast<float>(lights));
  return Program(std::move(module))(arguments);
}

TEST(LowerEffect, TakesOnlyTheInputsItUses) {
  FrontEnd front_end;
  EXPECT_EQ(
      ir::print(front_end.lower(effect(R"("n": {"type": "normal"},
"uv": {"type": "texcoord"},
"nx": {"type": "multiply", "in1": "n.x", "in2": "uv.y"},
"color": {"type": "multiply", "in1": "tint", "in2": "nx"})"))),
      R"(func @shade(%surface.normal: vec3, %surface.texcoord: vec2, %parameters.tint: vec3 uniform least 0xff7fffff most 0x7f7fffff) -> (color: vec4) from "test.json" {
  %3 = extract %surface.normal, 0  ; nx:7
  %4 = extract %surface.texcoord, 1  ; nx:7
  %nx = fmul %3, %4  ; nx:7
  %6: vec3 = construct %nx, %nx, %nx  ; color:8
  %color: vec3 = fmul %parameters.tint, %6  ; color:8
  %8 = extract %color, 0
  %9 = extract %color, 1
  %10 = extract %color, 2
  %11 = constant float 0x3f800000  # 1
  %12: vec4 = construct %8, %9, %10, %11
  return %12
}
)");
}

TEST(LowerEffect, EmitsDerivativeOps) {
  FrontEnd front_end;
  const ir::Module module = front_end.lower(effect(R"("uv": {"type": "texcoord"},
"slope": {"type": "ddy", "in": "uv.x"}, "width": {"type": "fwidth", "in": "uv.y"},
"color": {"type": "add", "in1": "slope", "in2": "width"})"));
  const std::string text = ir::print(module);
  EXPECT_TRUE(ir::asks_for_derivatives(module));
  for (const char* made : {"%slope = ddy %", " = ddx %", " = ddy %", "%width = fadd %"})
    EXPECT_NE(text.find(made), std::string::npos) << made << "\n" << text;
}

TEST(LowerEffect, ReturnsColor4AsIsAndFloatAsGrey) {
  FrontEnd front_end;
  Program whole(front_end.lower(effect("", "alpha")));
  EXPECT_EQ(whole({1, 2, 3, 4}), (std::vector<float>{1, 2, 3, 4}));
  Program grey(front_end.lower(effect("", "alpha.g")));
  EXPECT_EQ(grey({1, 2, 3, 4}), (std::vector<float>{2, 2, 2, 1}));
}

TEST(LowerEffect, LightLoopHoldsOnlyLightDependentNodes) {
  FrontEnd front_end;
  const ir::Module module = front_end.lower(effect(R"("n": {"type": "normal"},
"l": {"type": "lightdirection"},
"facing": {"type": "dotproduct", "in1": "n", "in2": "l"},
"tint2": {"type": "multiply", "in1": "tint", "in2": "tint"},
"light": {"type": "lightcolor"},
"lit": {"type": "multiply", "in1": "light", "in2": "facing"},
"tinted": {"type": "multiply", "in1": "lit", "in2": "tint2"},
"sum": {"type": "sum_lights", "in": "tinted"},
"color": {"type": "add", "in1": "sum", "in2": "tint2"})"));
  const std::string text = ir::print(module, module.functions[module.find("shade")]);
  const size_t loop = text.find("= loop"), end = text.find("  }");
  const auto within = [&](const char* node) {
    const size_t at = text.find(node);
    return at > loop && at < end;
  };
  EXPECT_FALSE(within("%tint2: vec3 = fmul")) << text;
  EXPECT_FALSE(within("%color: vec3 = fadd")) << text;
  for (const char* node : {"call @light_at(", "%facing = call", "%lit: vec3 = fmul", "%tinted: vec3 = fmul"})
    EXPECT_TRUE(within(node)) << node << "\n" << text;
  // Two lights: position is asked for by light_at alone.
  EXPECT_EQ(shade(module, {9, 9, 9, /* normal */ 0, 1, 2, /* tint */ 1, 2, 3}, 2),
            (std::vector<float>{1 * 2 + 2 * 3 + 1, 4 * (10 * 2 + 20 * 3) + 4, 9, 1}));
  EXPECT_EQ(shade(module, {9, 9, 9, 0, 1, 2, 1, 2, 3}, 0), (std::vector<float>{1, 4, 9, 1}));
}

TEST(LowerEffect, SumsMayShareNodesAndNest) {
  FrontEnd front_end;
  const ir::Module module = front_end.lower(effect(R"("light": {"type": "lightcolor"},
    "half": {"type": "multiply", "in1": "light", "in2": 0.5},
    "a": {"type": "sum_lights", "in": "half"}, "b": {"type": "sum_lights", "in": "light"},
    "ab": {"type": "add", "in1": "a", "in2": "b"},
    "lit": {"type": "multiply", "in1": "half", "in2": "ab"}, "c": {"type": "sum_lights", "in": "lit"},
    "three": {"type": "constant", "value": 1}, "d": {"type": "sum_lights", "in": "three"},
    "color": {"type": "add", "in1": "c", "in2": "d"})"));
  // Three lights: a = 3.5, b = 7, c = (0.5 + 1 + 2) * 10.5, d = 3.
  EXPECT_EQ(shade(module, {0, 0, 0}, 3), (std::vector<float>{36.75f + 3, 3675 + 3, 3, 1}));
}

TEST(LowerEffect, SumStartsFromPositiveZero) {
  FrontEnd front_end;
  const ir::Module module = front_end.lower(effect(R"("light": {"type": "lightcolor"},
    "minus": {"type": "multiply", "in1": "light", "in2": -1}, "sum": {"type": "sum_lights", "in": "minus"},
    "inverse": {"type": "divide", "in1": 1, "in2": "sum"}, "color": {"type": "convert", "in": "inverse", "to": "color4"})"));
  // Blue is -0 for each light.
  EXPECT_GT(shade(module, {0, 0, 0}, 1)[2], 0.0f);
}

TEST(LowerEffect, LowersTheRequestedPass) {
  FrontEnd front_end;
  const auto graph = front_end.check(R"({"isoshade": 1, "effect": "e", "parameters": {
    "a": {"type": "color3", "value": [1, 1, 1]}, "b": {"type": "color3", "value": [1, 1, 1]}},
    "passes": [{"name": "p", "color": "a"}, {"name": "q", "color": "b"}]})");
  ASSERT_NE(graph, nullptr) << front_end.diagnostics.text();
  EXPECT_EQ(lower::lower(*graph, {.pass = 0}).module.functions[0].parameters[0].name, "a");
  EXPECT_EQ(lower::lower(*graph, {.pass = 1}).module.functions[0].parameters[0].name, "b");
}

TEST(LowerEffect, PositionIsASeparateFunctionWithOnlyItsInputs) {
  FrontEnd front_end;
  const auto graph = front_end.check(R"({"isoshade": 1, "effect": "e", "parameters": {
    "tint": {"type": "color3", "value": [1, 1, 1]}, "width": {"type": "float", "value": 1}},
    "nodes": {"p": {"type": "position"}, "n": {"type": "outlinenormal"}, "s": {"type": "pixelsize"},
              "far": {"type": "multiply", "in1": "width", "in2": "s"},
              "way": {"type": "multiply", "in1": "n", "in2": "far"}, "moved": {"type": "add", "in1": "p", "in2": "way"}},
    "passes": [{"name": "p", "color": "tint"}, {"name": "q", "color": "tint", "position": "moved"}]})");
  ASSERT_NE(graph, nullptr) << front_end.diagnostics.text();
  EXPECT_EQ(graph->position_of(0), nullptr);
  const auto [module, interface] = lower::lower(*graph, {.pass = 1, .part = lower::PassPart::position});
  const ir::Function& move_vertex = module.functions.at(interface.entry);
  std::string parameters;
  for (const ir::Parameter& parameter : move_vertex.parameters)
    parameters += parameter.group + "." + parameter.name + " ";
  EXPECT_EQ(parameters, "surface.position surface.outline_normal surface.pixel_size parameters.width ");
  Program program(module);
  EXPECT_EQ(program({1, 2, 3, /* normal */ 0, 1, 0, /* pixel */ 0.5, /* width */ 4}),
            (std::vector<float>{1, 4, 3}));
  EXPECT_EQ(lower::lower(*graph, {.pass = 1}).module.functions[0].parameters.size(), 1u);
}

}  // namespace
}  // namespace isoshade
