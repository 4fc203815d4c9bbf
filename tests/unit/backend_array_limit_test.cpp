// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <iterator>

#include "backends/shared.h"
#include "compiler/support/source.h"

namespace isoshade::backends {
namespace {

constexpr ArrayLimit small_device{"a device", 1000};

std::string report(lower::FrameBuffer array, const ArrayLimit& limit, const Frame* frame) {
  support::Diagnostics diagnostics;
  report_too_large(array, 4096, limit, frame, diagnostics);
  EXPECT_EQ(diagnostics.all().at(0).id, support::Id::device_limit);
  return diagnostics.text();
}

TEST(ArrayLimit, ErrorStatesBothSizesAndAFixForEveryArray) {
  for (size_t array = 0; array < std::size(lower::frame_buffers); ++array) {
    const std::string text = report(static_cast<lower::FrameBuffer>(array), small_device, nullptr);
    EXPECT_NE(text.find("take 4096 bytes; a device takes at most 1000"), std::string::npos) << text;
    EXPECT_NE(text.find("--backend cpu"), std::string::npos) << text;
  }
}

TEST(ArrayLimit, ErrorNamesTheLargestItemAndItsReference) {
  const auto source = std::make_shared<support::SourceFile>("scene.json", "{\"a\": \"b.png\"}\n");
  Frame frame;
  frame.largest_in_texel_bytes = {"the image \"b.png\"", {source, 6, 13}};
  frame.largest_mesh = {"the mesh of \"house\"", {}};
  const std::string images = report(lower::FrameBuffer::texel_bytes, small_device, &frame);
  EXPECT_NE(images.find("scene.json:1:7: error[device-limit]: the textures of 8 bits"), std::string::npos)
      << images;
  EXPECT_NE(images.find("the largest is the image \"b.png\""), std::string::npos) << images;
  const std::string triangles = report(lower::FrameBuffer::triangles, small_device, &frame);
  EXPECT_NE(triangles.find("the largest is the mesh of \"house\""), std::string::npos) << triangles;
  const std::string floats = report(lower::FrameBuffer::texels, small_device, &frame);
  EXPECT_EQ(floats.find("the largest is"), std::string::npos) << floats;
}

TEST(ArrayLimit, ErrorNamesTheShadowThatTakesTheRoom) {
  const auto source = std::make_shared<support::SourceFile>("scene.json", "{\"size\": 4096}\n");
  Frame frame;
  const std::string images = report(lower::FrameBuffer::layers, small_device, &frame);
  EXPECT_NE(images.find("make a smaller image with --size"), std::string::npos) << images;
  frame.largest_shadow = {"the shadow of light \"lamp\", 6 maps of 4096 x 4096 pixels", {source, 9, 13}};
  const std::string shadows = report(lower::FrameBuffer::layers, small_device, &frame);
  EXPECT_NE(shadows.find("scene.json:1:10: error[device-limit]"), std::string::npos) << shadows;
  EXPECT_NE(shadows.find("the largest is the shadow of light \"lamp\""), std::string::npos) << shadows;
  EXPECT_NE(shadows.find("make the \"size\" of its shadow smaller; or draw it with --backend cpu"), std::string::npos)
      << shadows;
  EXPECT_EQ(shadows.find("--size"), std::string::npos) << shadows;
}

TEST(ArrayLimit, ErrorOnTheCpuDoesNotSuggestTheCpu) {
  const std::string text = report(lower::FrameBuffer::texels, {"the cpu backend", 1000, true}, nullptr);
  EXPECT_EQ(text.find("--backend"), std::string::npos) << text;
}

}  // namespace
}  // namespace isoshade::backends
