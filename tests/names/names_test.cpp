// SPDX-License-Identifier: Apache-2.0
// Every word of a language, and of our own texts, as a name in every place where a document names something: glslang
// takes the GLSL (and SPIR-V validates), g++ and clang++ take the C++. The macros of the standard headers are live there.
//
// With ISOSHADE_FULL set the words are also all macros that the headers of this machine define, and clang++ takes all.
#include <gtest/gtest.h>

#include "tests/names/compilers.h"
#include "tests/names/documents.h"
#include "tests/names/words.h"

namespace isoshade::names {
namespace {

/// Compiles documents and collects their texts; at the end of a place every compiler takes all of them.
class NameCase {
 public:
  explicit NameCase(std::string name) : name_(std::move(name)) {}

  void add(const Made& made) {
    ASSERT_TRUE(made.programs.size() > 0) << made.messages;
    for (const driver::Program& program : made.programs) texts_.add(program);
    for (const driver::Shader& shader : made.shaders) texts_.add(shader);
  }
  void count(size_t words) { words_ += words; }

  ~NameCase() {
    texts_.compile();
    std::printf("%-22s %5zu words: glslang %4zu texts, g++ %4zu, clang++ %4zu, GLSL ES %4zu\n", name_.c_str(), words_,
                texts_.glsl_count(), texts_.cpp_count(), texts_.clang_count(), texts_.es_count());
    ::testing::Test::RecordProperty("words_of_" + name_, static_cast<int>(words_));
  }

 private:
  std::string name_;
  Texts texts_;
  size_t words_ = 0;
};

TEST(AnyWord, NamesAFunctionAndItsFileInputNodeAndOutput) {
  NameCase place("function");
  for (const Chunk& chunk : chunks(words(), 120)) {
    place.count(chunk.size());
    place.add(functions_called(chunk));
  }
}

TEST(AnyWord, NamesOneOfManyInputsAndOutputs) {
  NameCase place("inputs and outputs");
  for (const Chunk& chunk : chunks(words(), 100)) {
    place.count(chunk.size());
    place.add(function_of_many(chunk));
  }
}

TEST(AnyWord, NamesANode) {
  NameCase place("nodes");
  for (const Chunk& chunk : chunks(words(), 250)) {
    place.count(chunk.size());
    place.add(nodes_called(chunk));
  }
}

TEST(AnyWord, NamesAnEffectPassParameterAndEnumValue) {
  NameCase place("effects");
  for (const Chunk& chunk : chunks(words(), 60)) {
    place.count(chunk.size());
    place.add(effect_with_parameters(chunk));
  }
}

TEST(AnyWord, NamesAnImageAndFileOfAnEffect) {
  NameCase place("images of effects");
  for (const Chunk& chunk : chunks(words(), 120)) {
    place.count(chunk.size());
    place.add(effect_with_images(chunk));
  }
}

TEST(AnyWord, NamesAPostAndItsParameterAndSum) {
  NameCase place("posts");
  for (const Chunk& chunk : chunks(words(), 60)) {
    place.count(chunk.size());
    place.add(post_with_parameters(chunk));
  }
}

TEST(AnyWord, NamesAnImageOfAPost) {
  NameCase place("images of posts");
  for (const Chunk& chunk : chunks(words(), 8)) {
    place.count(chunk.size());
    place.add(post_with_images(chunk));
  }
}

}  // namespace
}  // namespace isoshade::names
