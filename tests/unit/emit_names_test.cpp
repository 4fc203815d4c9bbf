// SPDX-License-Identifier: Apache-2.0
// Names of one scope: no two are alike, none is a word, whatever documents call things.
#include <algorithm>
#include <gtest/gtest.h>
#include <random>
#include <set>

#include "compiler/emit/names.h"
#include "compiler/graph/graph.h"
#include "compiler/targets/cpp/cpp.h"
#include "compiler/targets/cpp/stages.h"
#include "compiler/targets/glsl/spirv.h"
#include "compiler/targets/glsl/stages.h"
#include "tests/unit/ir_text.h"

namespace isoshade::emit {
namespace {

constexpr Scope scopes[] = {Scope::global, Scope::local, Scope::field};

/// What may become alike: by a cleaned, cut, renamed or numbered name.
std::vector<std::string> adversaries() {
  std::vector<std::string> names = {
      "a",       "a_",    "_a",     "__a",     "a__",     "a_1",      "a_1_",     "a__1",      "a_1_1",
      "a_2",     "A",     "A_1",    "length",  "length_", "length__", "length_1", "length_1_", "_length",
      "Length",  "float", "float_", "float_1", "M",       "M_",       "M_1",      "M_PI",      "M_PI_",
      "E",       "E_1",   "E1",     "E_",      "EDOM",    "EDOM_1",   "gl_a",     "n_gl_a",    "gl__a",
      "n_gl__a", "gl_",   "n_gl",   "_",       "__",      "_1",       "n_1",      "n_",        "n",
      "n_1_",    "n__1",  "GL_x",   "spirv_x", "webgl_x", "webgl", "webgl_", "result",  "result_1", "result_2", "x_block",   "x_block_1",
      "main",    "main_", "x_MAX",  "x_MAX_",  "x_MAX_1", "SIG",      "SIG_1",    "t",         "t_low"};
  for (const char* ending : {"", "_", "1", "_1", "_2", "b", "__"})
    for (const size_t size : {98, 99, 100, 101, 128}) {
      const std::string end(ending);
      names.push_back(std::string(size - end.size(), 'a') + end);
    }
  std::ranges::sort(names);
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

void expect_good(const std::string& name, Scope scope) {
  EXPECT_FALSE(name.empty() || name.find("__") != std::string::npos || name.front() == '_') << name;
  EXPECT_TRUE(graph::is_id(name)) << name;
  EXPECT_FALSE(is_word(name, scope)) << name;
  EXPECT_FALSE(name.starts_with("gl_") || name.starts_with("webgl_")) << name;
}

TEST(Names, AreUniqueInAnyOrder) {
  std::vector<std::string> wanted = adversaries();
  std::mt19937 random(1);
  for (const Scope scope : scopes) {
    for (int turn = 0; turn < 200; ++turn) {
      std::ranges::shuffle(wanted, random);
      const size_t outside = turn % 2 == 0 ? 0 : wanted.size() / 2;
      Names outer(Scope::global);
      std::set<std::string> taken;
      for (size_t i = 0; i < outside; ++i) {
        const std::string name = outer.take(wanted[i]);
        EXPECT_TRUE(taken.insert(name).second) << name;
        expect_good(name, Scope::global);
      }
      Names names(scope, &outer);
      for (const std::string& name : wanted) {
        const std::string given = names.take(name);
        EXPECT_TRUE(taken.insert(given).second) << name << " became " << given << " again";
        expect_good(given, scope);
      }
    }
  }
}

TEST(Names, AreUnchangedIfFreeAndNotReserved) {
  for (const char* name :
       {"a", "a_1", "base_color", "roughness", "x0", "Length", "lambda", "sigma", "EdgeWidth"}) {
    for (const Scope scope : scopes) {
      Names names(scope);
      EXPECT_EQ(names.take(name), name);
    }
  }
}

TEST(Names, AvoidReservedWordsInTheirScopes) {
  struct Case {
    const char* word;
    bool global, local, field;  ///< whether it is a word there
  };
  for (const Case& c : {Case{"length", true, false, true}, Case{"smoothstep", true, false, false},
                        Case{"float", true, true, true}, Case{"NULL", true, true, true},
                        Case{"errno", true, true, true}, Case{"linux", true, true, true},
                        Case{"M_PI", true, true, true}, Case{"sampler2DArray", true, true, true},
                        Case{"color", true, false, false}, Case{"typeof", true, true, true},
                        Case{"webgl_position", true, true, true}}) {
    const bool expected[] = {c.global, c.local, c.field};
    for (size_t i = 0; i < 3; ++i) {
      Names names(scopes[i]);
      EXPECT_EQ(names.take(c.word) == c.word, !expected[i]) << c.word << " in scope " << i;
      EXPECT_EQ(is_word(c.word, scopes[i]), expected[i]) << c.word << " in scope " << i;
    }
  }
}

TEST(Names, EveryTableWordIsReservedInSomeScope) {
  EXPECT_GT(all_words().size(), 500u);
  for (const std::string_view word : all_words()) {
    EXPECT_TRUE(std::ranges::any_of(scopes, [&](Scope scope) { return is_word(word, scope); })) << word;
    for (const Scope scope : scopes) {
      Names names(scope);
      expect_good(names.take(word), scope);
    }
  }
}

/// Both texts of the eval stage of a module, which compiles.
std::pair<std::string, std::string> texts(const char* text) {
  const ir::Module module = ir::valid(text);
  const uint32_t entry = module.find("eval");
  support::Diagnostics diagnostics;
  const std::string glsl = glsl::stage(module, entry, lower::Stage::eval, {"", "test"});
  EXPECT_TRUE(glsl::compile_spirv(glsl, glsl::ShaderKind::fragment, diagnostics)) << diagnostics.text() << glsl;
  return {glsl, cpp::stage(module, entry, lower::Stage::eval, {"", "test"})};
}

TEST(Names, HighProductsReserveTheNamesOfBothWords) {
  // The text of a high product declares a second variable.
  const auto [glsl, cpp] = texts(R"(
func @eval(%row: int) -> (out: int) {
  %x: int = umulhi %row, %row
  %x_low: int = iadd %x, %row
  %x_high: int = imulhi %x_low, %row
  %x_high_low: int = imulhi %x_high, %x_low
  %out: int = iadd %x_high_low, %x_high
  return %out
})");
  EXPECT_NE(glsl.find("umulExtended(uint(row), uint(row), x_high, x_low)"), std::string::npos) << glsl;
  EXPECT_NE(glsl.find("int x_low_1 = "), std::string::npos) << glsl;
  EXPECT_NE(cpp.find(" x_low_1 = "), std::string::npos) << cpp;
}

TEST(Names, FunctionNamedLikeAStageRecordDoesNotClash) {
  const auto [glsl, cpp] = texts(R"(
func @EvalResult(%x: float) -> (length: float, out: float) {
  %y = fadd %x, %x
  return %x, %y
}
func @eval(%row: int) -> (length: float, out: float) {
  %x = itof %row
  %a, %b = call @EvalResult(%x)
  return %a, %b
})");
  EXPECT_NE(glsl.find(".length_"), std::string::npos) << glsl;
  EXPECT_EQ(glsl.find(".length)"), std::string::npos) << glsl;
}

TEST(Names, LocalOfAKnownFunctionGivesWayToAGlobalOfAnotherProgram) {
  const std::string helper = R"(
func @helper(%x: float) -> (out: float) {
  %total = fadd %x, %x
  %out = fmul %total, %total
  return %out
})";
  const std::string one = helper + R"(
func @eval(%row: int) -> (out: float) {
  %x = itof %row
  %out = call @helper(%x)
  return %out
})";
  const std::string other = helper + R"(
func @total(%x: float) -> (out: float) {
  %out = fmul %x, %x
  return %out
}
func @eval(%row: int) -> (out: float) {
  %x = itof %row
  %y = call @helper(%x)
  %out = call @total(%y)
  return %out
})";
  const auto first = texts(one.c_str()), second = texts(other.c_str());
  EXPECT_NE(first.second.find(" total = "), std::string::npos) << first.second;
  EXPECT_EQ(second.second.find(" total = "), std::string::npos) << second.second;
  EXPECT_NE(second.second.find(" total_1 = "), std::string::npos) << second.second;
  EXPECT_EQ(texts(one.c_str()), first);
  EXPECT_EQ(texts(other.c_str()), second);
}

TEST(Names, KnownFunctionCallsWhatItsCalleeIsCalledInEachProgram) {
  const auto program = [](const std::string& callee) {
    return "func @" + callee + R"((%x: float) -> (out: float) {
  %out = fadd %x, %x
  return %out
}
func @helper(%x: float) -> (out: float) {
  %out = call @)" + callee + R"((%x)
  return %out
}
func @eval(%row: int) -> (out: float) {
  %x = itof %row
  %out = call @helper(%x)
  return %out
})";
  };
  EXPECT_NE(texts(program("first").c_str()).first.find("return first(x)"), std::string::npos);
  EXPECT_NE(texts(program("second").c_str()).first.find("return second(x)"), std::string::npos);
}

}  // namespace
}  // namespace isoshade::emit
