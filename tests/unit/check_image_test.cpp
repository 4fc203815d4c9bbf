// SPDX-License-Identifier: Apache-2.0
// What documents may say of images.
#include "compiler/lower/image_slots.h"
#include "tests/unit/front_end.h"

namespace isoshade {
namespace {

std::string messages_of(const std::string& text) { return FrontEnd().messages(text); }

std::string effect(const std::string& nodes, const std::string& color = "color") {
  return R"({"isoshade": 1, "effect": "e", "parameters": {
    "map": {"type": "filename", "value": "a.png"}, "tint": {"type": "color3", "value": [1, 1, 1]}},
"nodes": {
)" + nodes +
         "\n},\n\"passes\": [{\"name\": \"p\", \"color\": \"" + color + "\"}]}";
}

std::string image(const std::string& ports) {
  return effect("\"color\": {\"type\": \"image\", " + ports + "}");
}

TEST(CheckImage, FileIsALiteralOrALink) {
  FrontEnd front_end;
  EXPECT_NE(front_end.check(image(R"("file": "b.png")")), nullptr) << front_end.diagnostics.text();
  EXPECT_NE(front_end.check(image(R"("file": {"link": "map"})")), nullptr) << front_end.diagnostics.text();
  EXPECT_NE(messages_of(image(R"("file": 3)")).find("error[wrong-type]"), std::string::npos);
  EXPECT_NE(messages_of(image(R"("file": {"link": "tint"})")).find("error[type-mismatch]"),
            std::string::npos);
  EXPECT_NE(messages_of(image(R"("file": {"link": "none"})")).find("error[unknown-node]"), std::string::npos);
  EXPECT_NE(messages_of(image(R"("filtertype": "linear")")).find("error[missing-port]"), std::string::npos);
}

TEST(CheckImage, RejectsParameterNamesAsPaths) {
  const std::string text = messages_of(image(R"("file": "map")"));
  EXPECT_NE(text.find("write {\"link\": \"map\"}"), std::string::npos) << text;
  EXPECT_EQ(messages_of(image(R"("file": "./map")")), "");
  EXPECT_EQ(messages_of(image(R"("file": "tint")")), "");
}

TEST(CheckImage, RejectsArithmeticOnFileNames) {
  EXPECT_NE(messages_of(effect(R"("color": {"type": "multiply", "in1": "tint", "in2": "map"})"))
                .find("error[type-mismatch]"),
            std::string::npos);
  EXPECT_NE(messages_of(effect(R"("n": {"type": "normal"})", "map")).find("error[type-mismatch]"),
            std::string::npos);
}

TEST(CheckImage, RejectsCubicFilterAndListsTheFilters) {
  const std::string text = messages_of(image(R"("file": "b.png", "filtertype": "cubic")"));
  EXPECT_NE(text.find("\"filtertype\" of \"image\" cannot be \"cubic\""), std::string::npos) << text;
  EXPECT_NE(text.find("\"trilinear\""), std::string::npos) << text;
}

std::string chosen(const std::string& parameter, const std::string& ports) {
  return R"({"isoshade": 1, "effect": "e", "parameters": {"mode": )" + parameter +
         R"(, "tint": {"type": "color3", "value": [1, 1, 1]}}, "nodes": {"color": {"type": "image", "file": "a.png", )" + ports +
         R"(}}, "passes": [{"name": "p", "color": "color"}]})";
}

TEST(CheckImage, ParametersWithTheNamesOfItsChoicesMayChoose) {
  const std::string modes = R"({"type": "integer", "enum": ["periodic", "clamp"], "value": "clamp"})";
  FrontEnd front_end;
  const auto typed = front_end.check(chosen(modes, R"("uaddressmode": {"link": "mode"})"));
  ASSERT_NE(typed, nullptr) << front_end.diagnostics.text();
  const lower::Sampling sampling = lower::image_slots(*typed).slots.at(0).samplings.at(0);
  EXPECT_EQ(sampling.u, nodes::AddressMode::clamp);
  EXPECT_EQ(sampling.u_input, 0u);
  EXPECT_EQ(sampling.v_input, ir::none);
  EXPECT_EQ(sampling.filter_input, ir::none);
  const std::string wrong = "takes a link only to a parameter with an \"enum\" of its choices";
  for (const char* parameter :
       {R"({"type": "integer", "enum": ["clamp", "periodic"], "value": 0})", R"({"type": "integer", "value": 0})",
        R"({"type": "float", "value": 0})",
        R"({"type": "integer", "enum": ["periodic", "clamp", "mirror", "constant", "more"], "value": 0})"})
    EXPECT_NE(messages_of(chosen(parameter, R"("vaddressmode": {"link": "mode"})")).find(wrong), std::string::npos)
        << parameter;
  EXPECT_NE(messages_of(chosen(modes, R"("filtertype": {"link": "mode"})")).find(wrong), std::string::npos);
  EXPECT_NE(messages_of(chosen(modes, R"("filtertype": {"link": "tint"})")).find(wrong), std::string::npos);
  EXPECT_NE(messages_of(chosen(modes, R"("filtertype": {"link": "none"})")).find("error[unknown-node]"),
            std::string::npos);
  EXPECT_NE(messages_of(chosen(modes, R"("colorspace": {"link": "mode"})")).find("error[not-literal]"),
            std::string::npos);
}

TEST(CheckImage, FiltersThatMayBecomeTrilinearNeedMipLevels) {
  FrontEnd front_end;
  for (const bool mips : {false, true}) {
    const std::string filters = mips ? R"("closest", "linear", "trilinear")" : R"("closest", "linear")";
    const auto typed = front_end.check(chosen(R"({"type": "integer", "enum": [)" + filters + R"(], "value": 0})",
                                              R"("filtertype": {"link": "mode"})"));
    ASSERT_NE(typed, nullptr) << front_end.diagnostics.text();
    EXPECT_EQ(lower::image_slots(*typed).slots.at(0).mips, mips);
  }
}

std::string painted(const std::string& file) {
  return R"({"isoshade": 1, "function": "painted", "inputs": {"map": {"type": "filename"},
    "decal": {"type": "filename", "value": "decal.png"}}, "nodes": {
"i": {"type": "image", "file": )" +
         file + R"json(}, "d": {"type": "image", "file": {"link": "decal"}, "to": "vector3"},
"sum": {"type": "expression", "code": "i + color3(d)", "i": "i", "d": "d"}}, "outputs": {"out": "sum"}})json";
}

TEST(CheckImage, FunctionsTakeImagesAsInputs) {
  FrontEnd front_end;
  front_end.library.add("library/painted.json", painted(R"({"link": "map"})"));
  for (const char* ports : {R"("map": {"link": "map"})", R"("map": "b.png", "decal": {"link": "map"})"})
    EXPECT_NE(front_end.check(effect(R"("color": {"type": "painted", )" + std::string(ports) + "}")), nullptr)
        << front_end.diagnostics.text();
  const auto error = [](const std::string& ports) {
    FrontEnd other;
    other.library.add("library/painted.json", painted(R"({"link": "map"})"));
    return other.messages(effect(R"("color": {"type": "painted", )" + ports + "}"));
  };
  EXPECT_NE(error(R"("map": "map")").find("write {\"link\": \"map\"}"), std::string::npos);
  EXPECT_NE(error(R"("map": {"link": "tint"})").find("error[type-mismatch]: \"map\" of \"painted\" takes filename"),
            std::string::npos);
  EXPECT_NE(error(R"("map": 3)").find("error[wrong-type]"), std::string::npos);
  EXPECT_NE(error(R"("decal": "b.png")").find("error[missing-port]"), std::string::npos);
  FrontEnd in_function;
  in_function.library.add("library/painted.json", painted("\"map\""));
  EXPECT_NE(in_function.messages(effect(R"("color": {"type": "painted", "map": "b.png"})"))
                .find("is a path, but \"map\" is an input"),
            std::string::npos)
      << in_function.diagnostics.text();
}

TEST(CheckImage, RejectsFilenamesAsOutputsOfFunctions) {
  EXPECT_NE(messages_of(R"({"isoshade": 1, "function": "f", "inputs": {"map": {"type": "filename"}},
    "outputs": {"out": "map"}})")
                .find("error[type-mismatch]: an output cannot be filename"),
            std::string::npos);
}

TEST(CheckImage, RejectsSecondDerivativesAsTexcoordsWithMips) {
  FrontEnd front_end;
  const std::string of_image = R"("i": {"type": "image", "file": "a.png", "filtertype": "trilinear"},
"color": {"type": "ddx", "in": "i"})";
  EXPECT_NE(front_end.check(effect(of_image)), nullptr) << front_end.diagnostics.text();
  const std::string of_derivative = R"("v": {"type": "fwidth", "in": "uv"}, "uv": {"type": "texcoord"},
"w": {"type": "ddx", "in": "v"}, "color": {"type": "image", "file": "a.png", "texcoord": "w", "filtertype": ")";
  EXPECT_NE(messages_of(effect(of_derivative + "trilinear\"}")).find("error[third-derivative]"),
            std::string::npos);
  EXPECT_NE(front_end.check(effect(of_derivative + "linear\"}")), nullptr) << front_end.diagnostics.text();
}

TEST(ImageSlots, AreOnePerFileAndDecoding) {
  FrontEnd front_end;
  const auto typed = front_end.check(effect(R"json("a": {"type": "image", "file": {"link": "map"}},
"b": {"type": "image", "file": {"link": "map"}, "filtertype": "trilinear"},
"c": {"type": "image", "file": {"link": "map"}, "to": "vector3"},
"d": {"type": "image", "file": "d.png", "colorspace": "srgb", "to": "float"},
"unused": {"type": "image", "file": "e.png"},
"color": {"type": "expression", "code": "a * b * d * color3(c.x, c.y, c.z)", "a": "a", "b": "b", "c": "c", "d": "d"})json"));
  ASSERT_NE(typed, nullptr) << front_end.diagnostics.text();
  const auto slots = lower::image_slots(*typed).slots;
  ASSERT_EQ(slots.size(), 3u);
  EXPECT_EQ(slots[0].name, "map");
  EXPECT_EQ(slots[0].path, "a.png");
  EXPECT_EQ(slots[0].decoding, lower::Decoding::srgb_if_bytes);
  EXPECT_TRUE(slots[0].mips);
  EXPECT_EQ(slots[1].name, "map_");
  EXPECT_EQ(slots[1].decoding, lower::Decoding::linear);
  EXPECT_EQ(slots[2].name, "d");
  EXPECT_EQ(slots[2].parameter, "");
  EXPECT_EQ(slots[2].decoding, lower::Decoding::srgb);
}

TEST(ImageSlots, OfFunctionsAreThoseOfTheirCallers) {
  FrontEnd front_end;
  front_end.library.add("library/paint/painted.json", painted(R"({"link": "map"})"));
  const auto typed = front_end.check(effect(R"json("own": {"type": "image", "file": {"link": "map"}, "filtertype": "trilinear"},
"a": {"type": "paint/painted", "map": {"link": "map"}},
"b": {"type": "paint/painted", "map": "b.png"},
"c": {"type": "paint/painted", "map": "b.png", "decal": "decal.png"},
"color": {"type": "expression", "code": "own * a * b * c", "own": "own", "a": "a", "b": "b", "c": "c"})json"));
  ASSERT_NE(typed, nullptr) << front_end.diagnostics.text();
  const auto slots = lower::image_slots(*typed).slots;
  ASSERT_EQ(slots.size(), 4u);
  EXPECT_EQ(slots[0].name, "map") << "shared with the image of the effect";
  EXPECT_TRUE(slots[0].mips);
  EXPECT_EQ(slots[0].samplings.size(), 2u);
  EXPECT_EQ(slots[1].name, "a_decal");
  EXPECT_EQ(slots[1].path, "decal.png");
  EXPECT_EQ(slots[1].place.file->path(), "library/paint/painted.json") << "the default of the function";
  EXPECT_EQ(slots[2].name, "b_map");
  EXPECT_EQ(slots[2].place.file->path(), "test.json");
  EXPECT_EQ(slots[3].name, "c_decal") << "a path is relative to the document that gives it";
  EXPECT_EQ(slots[3].place.file->path(), "test.json");
}

}  // namespace
}  // namespace isoshade
