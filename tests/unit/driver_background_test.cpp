// SPDX-License-Identifier: Apache-2.0
// Which posts make one color of a background of one color.
#include <gtest/gtest.h>

#include "compiler/driver/driver.h"

namespace isoshade::driver {
namespace {

bool keeps_plain(const support::Source& source) {
  check::Library library(ISOSHADE_GRAPHS "/library");
  CompileOptions options;
  options.library = &library;
  support::Diagnostics diagnostics;
  const auto post = compile_post(source, options, diagnostics);
  EXPECT_TRUE(post) << diagnostics.text();
  return post && post->keeps_background_plain;
}

bool ships_plain(const std::string& name) {
  support::Diagnostics diagnostics;
  return keeps_plain(graph::read_source(ISOSHADE_GRAPHS "/effects/" + name + ".json", diagnostics));
}

/// Of a post that makes `code` of its pixel's color, depth, and the ray through it.
bool makes_plain(const std::string& code) {
  return keeps_plain(std::make_shared<support::SourceFile>("post.json", R"json({"isoshade": 1, "post": "post", "nodes": {
    "seen": {"type": "scenecolor"}, "depth": {"type": "scenedepth"}, "ray": {"type": "viewray"},
    "beside": {"type": "scenecolor", "offsetx": 1},
    "made": {"type": "expression", "code": ")json" + code + R"json(", "seen": "seen", "beside": "beside",
             "d": "depth.linear", "nothing": "depth.issky", "ray": "ray"}},
    "outputs": {"color": "made"}})json"));
}

TEST(PlainBackground, StaysPlainUnderFogAndToneMapping) {
  for (const char* name : {"height_fog", "distance_fog", "tonemap_aces"}) EXPECT_TRUE(ships_plain(name)) << name;
}

TEST(PlainBackground, IsNotPlainUnderWhatDependsOnThePlace) {
  for (const char* name : {"backdrop", "paper", "bloom/threshold"}) EXPECT_FALSE(ships_plain(name)) << name;
}

TEST(PlainBackground, DependsOnThePixelsWithoutASurfaceAlone) {
  EXPECT_TRUE(makes_plain("seen * 2"));
  EXPECT_TRUE(makes_plain("nothing ? seen : seen * ray.y"));
  EXPECT_TRUE(makes_plain("d >= 0 ? seen * d : seen"));
  EXPECT_FALSE(makes_plain("nothing ? seen * ray.y : seen"));
  EXPECT_FALSE(makes_plain("seen * ray.y"));
  EXPECT_FALSE(makes_plain("nothing ? beside : seen")) << "it reads other pixels";
}

}  // namespace
}  // namespace isoshade::driver
