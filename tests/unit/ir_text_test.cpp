// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/ir_text.h"

#include <gtest/gtest.h>
#include <random>

#include "compiler/ir/printer.h"
#include "tests/unit/random_module.h"

namespace isoshade::ir {
namespace {

// As the printer writes it: all that text IR can say.
constexpr std::string_view everything = R"(buffer positions: float
buffer indices: int

func @shade(%count: int uniform, %alpha: float uniform, %surface.normal: vec3, %surface.lit: bool) -> (color: vec4, depth: float) from "graphs/a \"b\"\\\x0a.json" {
  %4 = extract %surface.normal, 2  ; facing:7
  %out: vec4, %depth:5 = branch %surface.lit {  ; out:9
    %7 = constant float 0x7fc00000  # nan
    %8: int = constant int -3
    %9 = load positions[%8]
    %10: vec4 = construct %4, %7, %9, %alpha
    %sum: vec4 = loop %i < %count, %13: vec4 = %10 {  ; sum:11
      %out.14: vec4 = fadd %13, %10  ; out:9
      yield %out.14
    }
    yield %sum, %7
  } else {
    %facing:8: vec4, %16 = call @library_one(%alpha)  ; facing:7
    %17: bool = constant bool true
    %alpha.18: bool = bnot %17
    %19 = select %alpha.18, %16, %alpha
    yield %facing, %19
  }
  return %out, %depth
}

func @library_one(%x: float) -> (a: vec4, b: float) library "one"

func @nothing() -> () {
  return
}
)";

TEST(TextIr, PrintsWhatItParsed) { EXPECT_EQ(print(valid(everything)), everything); }

TEST(TextIr, RandomModulesRoundTrip) {
  for (uint64_t seed = 0; seed < 500; ++seed) {
    const std::string text = print(RandomModule(seed).make({.library_calls = true}));
    ASSERT_EQ(print(valid(text)), text);
  }
}

TEST(TextIr, KeepsTheBitsOfEveryConstant) {
  for (uint32_t bits : special_floats()) {
    char hex[16];
    std::snprintf(hex, sizeof hex, "0x%08x", bits);
    const Module module =
        valid("func @f() -> (x: float) { %x = constant float " + std::string(hex) + " return %x }");
    EXPECT_EQ(module.functions[0].instructions[0].imm, bits);
    EXPECT_EQ(parsed(print(module)), module);
  }
}

TEST(TextIr, ErrorsStateTheLineAndTheReason) {
  const auto error_of = [](const std::string& body) {
    std::string error;
    EXPECT_FALSE(
        parse("buffer b: int\nfunc @f(%x: float, %i: int, %c: bool) -> (out: float) {\n" + body, error))
        << body;
    return error;
  };
  EXPECT_EQ(error_of("%a = fadd %x, %y return %a }"), "line 3: %y is not defined before");
  EXPECT_EQ(error_of("\n%a = fadd %x, %i return %a }"), "line 4: the operands do not fit fadd");
  EXPECT_EQ(error_of("%a = frob %x return %a }"), "line 3: expected an instruction");
  EXPECT_EQ(error_of("%a: int = fneg %x return %a }"), "line 3: the value is a float, not a int");
  EXPECT_EQ(error_of("%a = fneg %x %a = fneg %x return %a }"), "line 3: %a is defined twice");
  EXPECT_EQ(error_of("%a, %b = fneg %x return %a }"), "line 3: the instruction has 1 results");
  EXPECT_EQ(error_of("%a = load nowhere[%i] return %a }"), "line 3: no buffer nowhere");
  EXPECT_EQ(error_of("%a = call @g(%x) return %a }"), "line 3: no function @g");
  EXPECT_EQ(error_of("%a = constant float 1 return %a }"), "line 3: expected 0x...");
  EXPECT_EQ(error_of("%a = constant int 2147483648 return %a }"), "line 3: no such number here: 2147483648");
  EXPECT_EQ(error_of("%a = branch %c { yield %x } return %a }"), "line 3: expected 'else'");
  EXPECT_EQ(error_of("return %x"), "line 3: the body does not end");
  EXPECT_EQ(error_of("return %x }\nfunc @f() -> ()"), "line 4: two functions @f");
  EXPECT_EQ(error_of("return %x }\n$"), "line 4: a character that is nowhere part of text IR");
  EXPECT_EQ(error_of("return %x }\nfunc @g() -> () from \"a"),
            "line 4: a string that does not end on its line");

  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "%v" + std::to_string(i) + " = branch %c {";
  for (int i = 0; i < 100000; ++i) deep += "}";
  EXPECT_EQ(error_of(deep + "}"), "line 3: blocks nest too deep");
}

// Cuts, repeats, swaps and garbles pieces of a text.
std::string mutated(std::string text, std::mt19937& random) {
  constexpr std::string_view alphabet = "%@(){}[]<,:;=->\"\\#\n 0x9azf.\x80_-";
  for (uint32_t n = 1 + random() % 2; n != 0 && !text.empty(); --n) {
    const size_t at = random() % text.size();
    const size_t size = random() % std::min<size_t>(text.size() - at, 40) + 1;
    const size_t other = random() % text.size();
    switch (random() % 5) {
      case 0: text.erase(at, size); break;
      case 1: text.insert(other, text.substr(at, size)); break;
      case 2: text[at] = alphabet[random() % alphabet.size()]; break;
      case 3: text.insert(at, 1, alphabet[random() % alphabet.size()]); break;
      default: text.replace(at, size, text.substr(other, 1 + random() % 12)); break;
    }
  }
  return text;
}

TEST(TextIr, GarbledTextYieldsAnErrorOrAModule) {
  std::mt19937 random(20240229);
  const std::vector<std::string> texts{std::string(everything), print(RandomModule(5).make()),
                                       print(RandomModule(11).make())};
  int parsed_count = 0, valid_count = 0;
  for (int i = 0; i < 6000; ++i) {
    const std::string text = mutated(texts[random() % texts.size()], random);
    std::string error;
    const auto module = parse(text, error);
    EXPECT_EQ(module.has_value(), error.empty()) << text;
    if (!module) {
      ASSERT_TRUE(error.starts_with("line ")) << error;
      continue;
    }
    ++parsed_count;
    if (!validate(*module).empty()) continue;
    ++valid_count;
    std::string again;
    const std::string printed = print(*module);
    const auto reread = parse(printed, again);
    ASSERT_TRUE(reread.has_value()) << again << "\n" << printed;
    ASSERT_EQ(print(*reread), printed);
  }
  EXPECT_GT(parsed_count, valid_count);
  EXPECT_GT(valid_count, 100);
}

}  // namespace
}  // namespace isoshade::ir
