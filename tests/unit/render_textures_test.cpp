// SPDX-License-Identifier: Apache-2.0
// Which textures a scene loads, and what it says of those that it cannot.
#include <algorithm>
#include <fstream>

#include "compiler/functions/environment.h"
#include "compiler/lower/frame_layout.h"
#include "runtime/render/textures.h"
#include "tests/unit/gltf_files.h"
#include "tests/unit/image_files.h"
#include "tests/unit/texture_scenes.h"

namespace isoshade {
namespace {

namespace word = lower::texture_word;

TEST_F(Textures, AreUprightWithTheOriginAtTheUpperLeft) {
  const auto made = plan(square("shown"));
  ASSERT_TRUE(made) << diagnostics_.text();
  EXPECT_EQ(draw(*made), picture().texels);
}

TEST_F(Textures, MapsOfTheEnvironmentStandBehindTexturesInTheFrame) {
  const auto without = plan(square("shown"));
  ASSERT_TRUE(without) << diagnostics_.text();
  options_.cache = path("cache");
  const auto made = plan(square("shown") + R"(, "environment": {"file": "a.png", "rotate": 5})");
  ASSERT_TRUE(made) << diagnostics_.text();
  const std::vector<int32_t>& records = made->frame.textures;
  const auto first = static_cast<size_t>(made->frame.frame[lower::frame_word::environment]);
  EXPECT_EQ(first * word::stride, without->frame.textures.size());
  ASSERT_EQ(records.size() - first * word::stride, (functions::environment_levels + 1u) * word::stride);
  const int32_t* const mirror = &records[first * word::stride];
  EXPECT_EQ(mirror[word::width], functions::environment_side + 2);
  EXPECT_EQ(mirror[word::table], -1);
  EXPECT_FALSE(made->stats.environment_cached);
  EXPECT_TRUE(plan(square("shown") + R"(, "environment": {"file": "a.png", "rotate": 5})")->stats.environment_cached);
}

TEST_F(Textures, AnEnvironmentMustBeAnImageInTheFoldersOfTheScene) {
  options_.cache = path("cache");
  const auto says = [&](const std::string& file, support::Id id) {
    EXPECT_FALSE(plan(square("shown") + R"(, "environment": {"file": ")" + file + "\"}"));
    ASSERT_EQ(diagnostics_.error_count(), 1u) << diagnostics_.text();
    EXPECT_EQ(diagnostics_.all()[0].id, id) << diagnostics_.text();
  };
  says("missing.hdr", support::Id::missing_file);
  says("bad.png", support::Id::bad_image);
  says("../a.png", support::Id::outside_reference);
}

TEST_F(Textures, TrilinearSelectsTheMipLevelByPixelSize) {
  const auto made = plan(square("small"), 2);
  ASSERT_TRUE(made) << diagnostics_.text();
  EXPECT_EQ(draw(*made), as_bytes(scene::half_size(picture())));
  const auto whole = plan(square("small"), 1);
  ASSERT_TRUE(whole) << diagnostics_.text();
  // Of the half that is not yet rounded to bytes.
  EXPECT_EQ(draw(*whole), as_bytes(scene::half_size(scene::half_size(picture()))));
  const auto large = plan(square("small", R"("tiles": 0.25)"), 4);
  ASSERT_TRUE(large) << diagnostics_.text();
  // The last pixel is 3/8 of the way from the first texel to the next.
  const std::vector<float> texels = picture().texels;
  const double expected =
      0.625 * (0.625 * texels[0] + 0.375 * texels[4]) + 0.375 * (0.625 * texels[16] + 0.375 * texels[20]);
  EXPECT_NEAR(draw(*large)[60], expected, 1e-6);
}

TEST_F(Textures, DerivativesAreTheSlopesBetweenTexels) {
  for (const char* filter : {"closest", "linear", "trilinear"}) {
    folder_.write("slope.json", R"({"isoshade": 1, "effect": "slope",
      "nodes": {"uv": {"type": "texcoord"}, "at": {"type": "multiply", "in1": "uv", "in2": 0.25},
        "picture": {"type": "image", "file": "a.png", "texcoord": "at", "colorspace": "linear",
                    "uaddressmode": "clamp", "vaddressmode": "clamp", "filtertype": ")" +
                                    std::string(filter) + R"("},
        "x": {"type": "ddx", "in": "picture"}, "y": {"type": "ddy", "in": "picture"},
        "both": {"type": "combine3", "in1": "x.r", "in2": "y.r", "to": "color3"}},
      "passes": [{"name": "base", "color": "both"}]})");
    const auto made = plan(square("slope"));
    ASSERT_TRUE(made) << diagnostics_.text();
    const std::vector<float> texels = picture().texels, slopes = draw(*made);
    // A pixel is a quarter of a texel wide. In the upper row and left column the next texel is that beyond the edge.
    const bool flat = filter == std::string("closest");
    const double across = flat ? 0 : 0.25 * (texels[4] - texels[0]);
    const double down = flat ? 0 : 0.25 * (texels[16] - texels[0]);
    EXPECT_NEAR(slopes[4 * 3], across, 1e-6) << filter;
    EXPECT_NEAR(slopes[4 * 3 + 1], 0, 1e-6) << filter;
    EXPECT_NEAR(slopes[4 * 12], 0, 1e-6) << filter;
    EXPECT_NEAR(slopes[4 * 12 + 1], down, 1e-6) << filter;
  }
}

TEST_F(Textures, AreThoseOfTheMaterialOfAGltf) {
  const std::string png = scene::png(1, 1, std::vector<uint8_t>{51, 102, 255, 255});
  folder_.write("m.glb", testing::textured_glb(png));
  folder_.write("pbr.json", R"({"isoshade": 1, "effect": "pbr", "parameters": {
    "base_color": {"type": "color3", "value": [1, 1, 1]}, "base_color_texture": {"type": "filename", "value": ""}},
    "nodes": {"map": {"type": "image", "file": {"link": "base_color_texture"}, "colorspace": "linear"},
      "color": {"type": "multiply", "in1": "base_color", "in2": "map"}},
    "passes": [{"name": "base", "color": "color", "cull": "none"}]})");
  const std::string members =
      R"("camera": {"type": "orthographic", "position": [0.5, 0.5, 5], "target": [0.5, 0.5, 0],
    "height": 1}, "objects": {"m": {"mesh": {"type": "gltf", "file": "m.glb"}, "effect": "pbr.json"PARAMETERS}})";
  const auto with = [&](const std::string& parameters) {
    std::string text = members;
    return text.replace(text.find("PARAMETERS"), 10, parameters);
  };
  const auto made = plan(with(""), 2);
  ASSERT_TRUE(made) << diagnostics_.text();
  const std::vector<float> shown = draw(*made);
  EXPECT_EQ(shown[0], 0.5f * 0.2f);
  EXPECT_EQ(shown[1], 0.25f * 0.4f);
  // What the object says goes before it.
  const auto other = plan(with(R"(, "parameters": {"base_color_texture": "a.png"})"), 2);
  ASSERT_TRUE(other) << diagnostics_.text();
  EXPECT_NE(draw(*other)[0], shown[0]);
}

TEST_F(Textures, ColoursOfAGltfAreSrgbAtAnyBitDepth) {
  using testing::png_file;
  folder_.write("pbr.json", R"({"isoshade": 1, "effect": "pbr", "parameters": {
    "base_color_texture": {"type": "filename", "value": ""}},
    "nodes": {"map": {"type": "image", "file": {"link": "base_color_texture"}}},
    "passes": [{"name": "base", "color": "map", "cull": "none"}]})");
  const auto shown = [&](const std::string& png, const std::string& parameters) {
    folder_.write("m.glb", testing::textured_glb(png));
    const auto made = plan(
        R"("camera": {"type": "orthographic", "position": [0.5, 0.5, 5], "target": [0.5, 0.5, 0], "height": 1},
        "objects": {"m": {"mesh": {"type": "gltf", "file": "m.glb"}, "effect": "pbr.json", "parameters": {)" +
            parameters + "}}}",
        2);
    EXPECT_TRUE(made) << diagnostics_.text();
    return made ? draw(*made) : std::vector<float>(4);
  };
  const std::string deep = png_file(1, 1, 16, 2, {std::string("\x80\x80\x33\x33\0\0", 6)});
  const std::vector<float> bytes = shown(png_file(1, 1, 8, 2, {std::string("\x80\x33\0", 3)}), "");
  EXPECT_NEAR(bytes[0], 0.2159, 1e-4);
  EXPECT_EQ(shown(deep, ""), bytes);
  // A file that the object names is read as such files are.
  folder_.write("deep.png", deep);
  EXPECT_EQ(shown(deep, R"("base_color_texture": "deep.png")")[0], static_cast<float>(0x8080) / 65535.0f);
}

TEST_F(Textures, MaterialsChooseWhereAndHowTheyAreRead) {
  folder_.write("pbr.json", R"json({"isoshade": 1, "effect": "pbr", "parameters": {
    "base_color_texture": {"type": "filename", "value": ""},
    "base_color_texture_u": {"type": "vector3", "value": [1, 0, 0]},
    "base_color_texture_v": {"type": "vector3", "value": [0, 1, 0]},
    "base_color_texture_wrap_u": {"type": "integer", "enum": ["periodic", "clamp", "mirror"], "value": 0},
    "base_color_texture_filter": {"type": "integer", "enum": ["closest", "linear", "trilinear"], "value": 2}},
    "nodes": {"uv": {"type": "texcoord"}, "at": {"type": "expression",
      "code": "vector2(dot(u, p), dot(v, p))", "u": "base_color_texture_u", "v": "base_color_texture_v", "p": "place"},
      "place": {"type": "combine3", "in1": "uv.x", "in2": "uv.y", "in3": 1},
      "map": {"type": "image", "file": {"link": "base_color_texture"}, "colorspace": "linear", "texcoord": "at",
        "uaddressmode": {"link": "base_color_texture_wrap_u"}, "filtertype": {"link": "base_color_texture_filter"}}},
    "passes": [{"name": "base", "color": "map", "cull": "none"}]})json");
  // Red to the left, black to the right; what is seen of red at 1/4 and 3/4.
  const std::string png = testing::png_file(2, 1, 8, 2, {std::string("\xff\0\0\0\0\0", 6)});
  const auto shown = [&](const std::string& transform, const std::string& sampler) {
    folder_.write("m.glb", testing::textured_glb(
                               png, R"({"index": 0, "extensions": {"KHR_texture_transform": )" + transform + "}}", sampler));
    const auto made = plan(
        R"("camera": {"type": "orthographic", "position": [0.5, 0.5, 5], "target": [0.5, 0.5, 0], "height": 1},
        "objects": {"m": {"mesh": {"type": "gltf", "file": "m.glb"}, "effect": "pbr.json"}})",
        2);
    EXPECT_TRUE(made) << diagnostics_.text();
    const std::vector<float> pixels = made ? draw(*made) : std::vector<float>(16);
    return std::pair{pixels[0], pixels[4]};
  };
  using Pair = std::pair<float, float>;
  EXPECT_EQ(shown("{}", "{}"), (Pair{1, 0}));
  EXPECT_EQ(shown(R"({"offset": [0.5, 0]})", "{}"), (Pair{0, 1}));
  EXPECT_EQ(shown(R"({"offset": [0.5, 0]})", R"({"wrapS": 33071})"), (Pair{0, 0}));
  EXPECT_EQ(shown(R"({"offset": [-1, 0]})", R"({"wrapS": 33648})"), (Pair{0, 1}));
  EXPECT_EQ(shown(R"({"offset": [0.25, 0]})", R"({"magFilter": 9729, "minFilter": 9729})"), (Pair{0.5f, 0.5f}));
  EXPECT_EQ(shown(R"({"offset": [0.125, 0]})", R"({"magFilter": 9728})"), (Pair{1, 0}));
}

TEST_F(Textures, WithoutAFileHaveTheDefault) {
  const auto made = plan(square("shown", R"("map": "")"));
  ASSERT_TRUE(made) << diagnostics_.text();
  EXPECT_EQ(draw(*made)[5], 0.25f);
  EXPECT_TRUE(made->frame.texels.empty());
  EXPECT_TRUE(made->frame.texel_bytes.empty());
  EXPECT_TRUE(made->frame.textures.empty());
  EXPECT_EQ(made->stats.textures, 0);
  EXPECT_EQ(render::text(made->stats).find("textures:"), std::string::npos);
}

TEST_F(Textures, UnusedImagesAreNotLoaded) {
  const auto made = plan(square("plain"));  // its default is missing
  ASSERT_TRUE(made) << diagnostics_.text();
  EXPECT_TRUE(made->frame.texels.empty());
  EXPECT_TRUE(made->frame.texel_bytes.empty());
  EXPECT_NE(
      render::text(made->stats).find("skipped:  the images of map of the effect plain: no pass reads them"),
      std::string::npos);
}

TEST_F(Textures, AreStoredOnceWithMipsIfAnyUseNeedsThem) {
  const auto made = plan(R"("objects": {"a": {"mesh": "box", "effect": "shown.json"},
    "b": {"mesh": "box", "effect": "small.json", "parameters": {"map": "./a.png"}}})");
  ASSERT_TRUE(made) << diagnostics_.text();
  EXPECT_EQ(made->stats.textures, 1);
  EXPECT_EQ(made->stats.texels, 16 + 4 + 1);
  EXPECT_EQ(made->frame.texel_bytes.size(), size_t{1 + 16 + 4 + 1});
  EXPECT_EQ(made->frame.texels.size(), size_t{2} * lower::byte_table::size);
  EXPECT_EQ(made->frame.textures.size(), size_t{3} * word::stride);
  EXPECT_EQ(made->frame.textures[word::smaller], 2);
}

TEST_F(Textures, OfBytesAndOfFloatsGiveTheSamePixels) {
  scene::FileImage image = *scene::read_image(path("a.png"), diagnostics_);
  image.rgba = scene::numbers_of(image);
  image.depth.resize(16);
  folder_.write("a.exr", scene::exr(image.view()));
  for (const char* effect : {"shown", "linear"}) {
    folder_.write("linear.json",
                  Textures::effect("linear", R"("colorspace": "linear", "filtertype": "linear")"));
    const auto bytes = plan(square(effect, R"("tiles": 1.7)"), 8);
    ASSERT_TRUE(bytes) << diagnostics_.text();
    const std::vector<float> shown = draw(*bytes);
    const auto floats = plan(square(effect, R"("tiles": 1.7, "map": "a.exr")"), 8);
    ASSERT_TRUE(floats) << diagnostics_.text();
    EXPECT_EQ(floats->frame.texels.size(), size_t{4 * 16});
    EXPECT_EQ(draw(*floats), shown);
  }
}

TEST_F(Textures, AreRefusedBeforeDecompressionIfTooLarge) {
  const auto refusal = [&](const std::string& name, int64_t room, bool mips) {
    diagnostics_ = support::Diagnostics();
    render::TextureStore store(nullptr, workers_, room);
    backends::Frame frame;
    EXPECT_FALSE(store.find({path(name), nullptr, {}}, lower::Decoding::linear, mips, diagnostics_) &&
                 store.store(frame, diagnostics_));
    return diagnostics_.text();
  };
  const auto expect_limit = [&](const std::string& name, int64_t bytes, bool mips) {
    // What follows the header is no image: with room enough it is unpacked, and that is seen.
    EXPECT_NE(refusal(name, bytes, mips).find("error[bad-image]"), std::string::npos) << diagnostics_.text();
    const std::string text = refusal(name, bytes - 1, mips);
    EXPECT_NE(text.find("error[too-large]"), std::string::npos) << text;
    EXPECT_NE(text.find(std::to_string(bytes) + " bytes; at most " + std::to_string(bytes - 1)),
              std::string::npos)
        << text;
  };
  folder_.write("bytes.png", testing::png_file(4096, 8192, 8, 6, {""}));
  folder_.write("words.png", testing::png_file(4096, 8192, 16, 6, {""}));
  folder_.write("floats.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8192 +X 4096\n");
  expect_limit("bytes.png", int64_t{4} * 4096 * 8192, false);
  // 4096 x 8192, 2048 x 4096, ... 1 x 2, and 1 x 1.
  expect_limit("bytes.png", int64_t{4} * (2 * ((int64_t{1} << 26) - 1) / 3 + 1), true);
  expect_limit("words.png", int64_t{16} * 4096 * 8192, false);
  expect_limit("floats.hdr", int64_t{16} * 4096 * 8192, false);
}

TEST_F(Textures, AreRefusedIfTheirMipsDoNotFit) {
  for (const int64_t room : {4 * 16, 4 * 20, 4 * 21}) {
    diagnostics_ = support::Diagnostics();
    render::TextureStore store(nullptr, workers_, room);
    const render::ImageSource source{path("a.png"), nullptr, {}};
    EXPECT_EQ(store.find(source, lower::Decoding::linear, false, diagnostics_), 0);
    EXPECT_EQ(store.find(source, lower::Decoding::linear, true, diagnostics_).has_value(), room == 4 * 21);
    EXPECT_EQ(diagnostics_.has_errors(), room != 4 * 21);
    // Decoded in another way it is a texture of its own.
    EXPECT_FALSE(store.find(source, lower::Decoding::srgb, false, diagnostics_));
  }
}

TEST_F(Textures, ImageDocumentsThatDoNotFitAreErrors) {
  folder_.write("half.png", scene::png(2, 2, std::vector<uint8_t>(16)));
  folder_.write("strip.png", scene::png(4, 8, std::vector<uint8_t>(128)));
  folder_.write("a.exr", scene::exr({4, 4, std::vector<float>(64, 0.5f), std::vector<float>(16)}));
  const auto message = [&](const std::string& text) {
    folder_.write("image.json", text);
    EXPECT_FALSE(plan(square("shown", R"("map": "image.json")"))) << text;
    return diagnostics_.text();
  };
  const auto expect = [&](const std::string& layers, const std::string& error) {
    const std::string text = message(R"({"isoshade": 1, "image": "image", "layers": )" + layers + "}");
    EXPECT_NE(text.find(error), std::string::npos) << layers << "\n" << text;
    EXPECT_NE(text.find("image.json:1:"), std::string::npos) << "no place in the document: " << text;
  };
  expect("[]", "error[out-of-range]: an image has 1 to 64 layers");
  expect(R"([{"file": "a.png", "count": 65}])", "error[out-of-range]");
  expect(R"([{"file": "strip.png", "count": 2}, {"file": "a.png", "count": 63}])", "error[out-of-range]: an image has");
  expect(R"([{"count": 2}])", "error[missing-key]");
  expect(R"([{"file": "a.png", "levels": ["a.png"]}])", "both a \"file\" and \"levels\"");
  expect(R"([{"levels": []}])", "error[out-of-range]: \"levels\" lists 0 files");
  expect(R"([{"levels": ["a.png", 3]}])", "error[wrong-type]: the path of an image file is needed here");
  expect(R"([{"file": "image.json"}])", "error[wrong-kind]: an image document names image files");
  expect(R"([{"file": "a.png", "size": 4}])", "error[unknown-key]");
  expect(R"([{"file": "missing.png"}])", "missing.png");
  expect(R"([{"file": "../outside.png"}])", "error[outside-reference]");
  expect(R"([{"file": "bad.png"}])", "error[bad-image]");
  expect(R"([{"file": "a.png"}, {"file": "half.png"}])", "is 2 x 2; as level 0 of 1 layer it must be 4 x 4");
  expect(R"([{"levels": ["a.png", "a.png"]}])", "is 4 x 4; as level 1 of 1 layer it must be 2 x 2");
  expect(R"([{"file": "a.png", "count": 3}])", "is 4 x 4; as level 0 of 3 layers it must be 4 x 3");
  expect(R"([{"file": "a.png"}, {"file": "a.exr"}])", "another number of bits per channel than");
  const std::string other = message(R"({"isoshade": 1, "function": "f", "outputs": {}})");
  EXPECT_NE(other.find("is not an image, but a document of the kind function"), std::string::npos) << other;
}

TEST_F(Textures, IntegersThatRecordsCannotHoldAreErrors) {
  folder_.write("layered.json", R"({"isoshade": 1, "effect": "layered", "parameters": {"n": {"type": "integer", "value": 0}},
    "nodes": {"picture": {"type": "image", "file": "a.png", "layer": "n"}}, "passes": [{"name": "base", "color": "picture"}]})");
  EXPECT_TRUE(plan(square("layered", R"("n": 16777216)"))) << diagnostics_.text();
  for (const char* number : {"16777217", "-16777217", "2147483647"}) {
    EXPECT_FALSE(plan(square("layered", R"("n": )" + std::string(number)))) << number;
    EXPECT_NE(diagnostics_.text().find("error[out-of-range]: the integer parameter \"n\""), std::string::npos)
        << diagnostics_.text();
  }
}

TEST_F(Textures, LayersCountInTheLimits) {
  folder_.write("strip.png", scene::png(4, 8, std::vector<uint8_t>(128)));
  folder_.write("strip.json", R"({"isoshade": 1, "image": "s", "layers": [{"file": "strip.png", "count": 2}]})");
  for (const int64_t room : {4 * 41, 4 * 42}) {
    diagnostics_ = support::Diagnostics();
    render::TextureStore store(nullptr, workers_, room);
    EXPECT_EQ(store.find({path("strip.json"), nullptr, {}}, lower::Decoding::linear, true, diagnostics_).has_value(),
              room == 4 * 42)
        << diagnostics_.text();
  }
}

TEST_F(Textures, VaryAlongGrids) {
  const auto made = plan(R"("objects": {"a": {"mesh": "box", "effect": "shown.json",
    "repeat": [{"count": 2, "step": [0.1, 0, 0], "parameters": {"map": {"values": ["", "a.png"]}}}]}})");
  ASSERT_TRUE(made) << diagnostics_.text();
  const auto image = [&](size_t draw) {
    return made->frame.objects[static_cast<size_t>(made->frame.picture().draws[draw].object) +
                               lower::object_word::parameters + 1];
  };
  EXPECT_EQ(image(0), -1.0f);
  EXPECT_EQ(image(1), 0.0f);
}

TEST_F(Textures, UnreadableFilesAreReportedWhereTheyAreNamed) {
  struct Case {
    std::string parameters, message;
  };
  for (const Case& wrong : {Case{R"("map": "none.png")", "error[missing-file]"},
                            {R"("map": "bad.png")", "error[bad-image]"},
                            {R"("map": "shown.json")", "error[wrong-kind]"},
                            {R"("map": "none.json")", "error[missing-file]"},
                            {R"("map": ".")", "error[unreadable-file]"},
                            {R"("map": "../x.png")", "error[outside-reference]"},
                            {R"("map": "/etc/passwd")", "error[outside-reference]"},
                            {R"("map": 3)", "error[wrong-type]"}}) {
    EXPECT_FALSE(plan(square("shown", wrong.parameters))) << wrong.parameters;
    const std::string text = diagnostics_.text();
    EXPECT_NE(text.find(wrong.message), std::string::npos) << text;
    EXPECT_NE(text.find("scene.json:"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace isoshade
