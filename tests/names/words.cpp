// SPDX-License-Identifier: Apache-2.0
#include "tests/names/words.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "compiler/emit/words.h"
#include "compiler/graph/graph.h"
#include "tests/names/compilers.h"
#include "tests/names/documents.h"

namespace isoshade::names {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view other_words[] = {
#define LANGUAGE(name, words) words,
#include "tests/names/words.def"
#undef LANGUAGE
};

/// What no table lists: forms of names, and pairs that differ by what a text may not have.
constexpr std::string_view forms =
    "gl_ gl_Position gl_x gl__ GL_ n_gl_x n_ n __ __a a__b a_b _a_b a_b_ _ _0 __LINE__ __FILE__ __VERSION__ "
    "__func__ "
    "__attribute__ _Bool _Complex _Float16 a a_ a_1 a_1_ a_2 A A_1 _1 t t_1 t_t t_low t_high index index_1 "
    "length_ length_1 "
    "Length LENGTH main_ Main float_ Float float_1 x y z w xy xyzw rgba r x_t x_next next surface Surface "
    "Surface_1 surface_1 "
    "Parameters parameters Parameters_1 images Images spaces Spaces frame Frame screen Screen sizes Sizes "
    "camera Camera taps "
    "Taps gradients Gradients EvalResult evalResult VertexResult e1 e5 f1 inf nan nanf pi M M_1 E E_1 E1 "
    "true_ result result_0 "
    "result_1 result_2 words_block inputs_block iso_ iso_sin iso_zero iso_x function_shade function_ shade_ "
    "light light_at environment environment_at irradiance_at environment_texel has_environment "
    "pass_index pass_count "
    "out out_ sin_ sample_linear_clamp sample_level row_results canonical_1 color_at depth_at under "
    "edge_clamp edge_mirror "
    "image_a_at image_a_x material post_process_ wide record px py x0 y0 place inside kernel";

std::set<std::string> identifiers(const std::string& text) {
  std::set<std::string> found;
  std::string word;
  for (const char c : text + " ") {
    const bool part = c == '_' || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    if (part) {
      word += c;
      continue;
    }
    if (graph::is_id(word)) found.insert(word);
    word.clear();
  }
  return found;
}

/// Without comments, whose words are no names.
std::string code(const std::string& text) {
  std::istringstream lines(text);
  std::string kept;
  for (std::string line; std::getline(lines, line);) kept += line.substr(0, line.find("//")) + "\n";
  return kept;
}

std::set<std::string> all() {
  std::set<std::string> words;
  const auto add = [&](const std::set<std::string>& more) { words.insert(more.begin(), more.end()); };
  for (const std::string_view word : emit::all_words()) add(identifiers(std::string(word)));
  for (const std::string_view list : other_words) add(identifiers(std::string(list)));
  add(identifiers(std::string(forms)));
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(ISOSHADE_ROOT) / "runtime/lanes")) {
    if (entry.path().extension() != ".h") continue;
    std::ifstream file(entry.path());
    add(identifiers(code((std::stringstream() << file.rdbuf()).str())));
  }
  for (const std::string& text : sample_texts()) add(identifiers(code(text)));
  for (const char* ending : {"", "_", "1", "_1", "b"}) {
    const std::string end(ending);
    words.insert(std::string(128 - end.size(), 'a') + end);
    words.insert(std::string(99, 'a') + end);
    words.insert(std::string(100, 'a') + end);
  }
  if (is_full()) add(macros_of_headers());
  return words;
}

}  // namespace

const std::vector<std::string>& words() {
  static const std::vector<std::string> list = [] {
    const std::set<std::string> found = all();
    return std::vector<std::string>(found.begin(), found.end());
  }();
  return list;
}

std::vector<Chunk> chunks(const std::vector<std::string>& all, size_t size) {
  std::vector<Chunk> list;
  for (size_t i = 0; i < all.size(); i += size)
    list.push_back(Chunk(all).subspan(i, std::min(size, all.size() - i)));
  return list;
}

}  // namespace isoshade::names
