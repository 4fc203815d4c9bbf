// SPDX-License-Identifier: Apache-2.0
#include "tests/conformance/cases.h"

#include <array>
#include <functional>
#include <string_view>

#include "compiler/driver/driver.h"
#include "compiler/functions/library.h"
#include "compiler/ir/builder.h"
#include "compiler/lower/frame_layout.h"
#include "compiler/lower/stages.h"

namespace isoshade::conformance {

namespace {

using ir::Builder;
using ir::Opcode;
using ir::ValueId;

/// Something to evaluate: its name, and how it is built from the parameters a, b, c, i, j.
struct Expression {
  std::string name;
  std::function<std::vector<ValueId>(Builder&)> build;
};

constexpr int max_words = 32;

ValueId float_parameter(Builder& b, int index) { return b.parameter(static_cast<size_t>(index % 3)); }
ValueId int_parameter(Builder& b, int index) { return b.parameter(static_cast<size_t>(3 + index % 2)); }
ValueId bool_of(Builder& b, int index) {
  return b.op(Opcode::flt, {float_parameter(b, index), float_parameter(b, index + 1)});
}

/// The k-th argument of some type: vectors are rotations of (a, b, c, a).
ValueId argument(Builder& b, ir::Type type, int k) {
  if (type == ir::bool_type) return bool_of(b, k);
  if (type == ir::int_type) return int_parameter(b, k);
  std::vector<ValueId> components;
  for (int i = 0; i < type.width; ++i) components.push_back(float_parameter(b, k + i));
  return b.construct(components);
}

/// Makes an operand satisfy the row's precondition, by ops that need none.
ValueId satisfy(Builder& b, ir::Precondition precondition, ValueId operand, int k) {
  switch (precondition) {
    case ir::Precondition::none: return operand;
    case ir::Precondition::finite_in_int_range: {
      const ValueId magnitude = b.op(Opcode::fabs, {operand});
      const ValueId inside = b.op(Opcode::flt, {magnitude, b.constant(2147483648.0f)});
      return b.op(Opcode::select, {inside, operand, b.constant(-7.75f)});
    }
    case ir::Precondition::not_nan: {
      const ValueId number = b.op(Opcode::feq, {operand, operand});
      return b.op(Opcode::select, {number, operand, b.constant(1.5f)});
    }
    case ir::Precondition::not_denormal_bits: {
      const ValueId exponent = b.op(Opcode::iand, {operand, b.constant(0x7f800000)});
      const ValueId denormal = b.op(Opcode::ieq, {exponent, b.constant(0)});
      return b.op(Opcode::select, {denormal, b.constant(0x3f800000), operand});
    }
    case ir::Precondition::shift_amount:
      return k == 0 ? operand : b.op(Opcode::iand, {operand, b.constant(31)});
  }
  return operand;
}

std::vector<ir::Type> operand_types(const ir::OpInfo& row, int width) {
  std::vector<ir::Type> types(static_cast<size_t>(row.arity));
  for (ir::Type& type : types) {
    switch (row.rule) {
      case ir::Rule::same: type = ir::vector_type(width); break;
      case ir::Rule::compare:
      case ir::Rule::to_int: type = ir::float_type; break;
      case ir::Rule::icompare:
      case ir::Rule::integer:
      case ir::Rule::to_float: type = ir::int_type; break;
      case ir::Rule::logic: type = ir::bool_type; break;
      case ir::Rule::choose: type = &type == &types[0] ? ir::bool_type : ir::vector_type(width); break;
    }
  }
  return types;
}

Expression op_expression(Opcode op, int width) {
  std::string name(ir::name(op));
  if (width > 1) name += std::to_string(width);
  return {name, [=](Builder& b) {
            const ir::OpInfo& row = ir::info(op);
            const std::vector<ir::Type> types = operand_types(row, width);
            std::vector<ValueId> operands;
            for (size_t k = 0; k < types.size(); ++k)
              operands.push_back(satisfy(b, row.precondition, argument(b, types[k], static_cast<int>(k)),
                                         static_cast<int>(k)));
            return std::vector{b.op(op, operands)};
          }};
}

Expression function_expression(const functions::Variant& variant) {
  return {"iso_" + variant.name, [&variant](Builder& b) {
            std::vector<ValueId> arguments;
            for (size_t k = 0; k < variant.parameters.size(); ++k)
              arguments.push_back(argument(b, variant.parameters[k], static_cast<int>(k)));
            return b.call(functions::declare(b.module(), variant), arguments);
          }};
}

/// Counts the words of an expression by building it once.
int word_count(const Expression& expression);

driver::Program program_of(std::string name, const std::vector<Expression>& expressions,
                           std::vector<std::string>& words,
                           functions::Tier tier = functions::Tier::standard) {
  ir::Module module = lower::frame_module();
  ir::Function function;
  function.name = "conform";
  for (const char* parameter : {"a", "b", "c"})
    function.parameters.push_back({parameter, ir::float_type, "", false});
  for (const char* parameter : {"i", "j"})
    function.parameters.push_back({parameter, ir::int_type, "", false});
  module.functions.push_back(function);
  // Results are declared once their types are known: build into a scratch function first.
  std::vector<ir::Result> results;
  {
    ir::Module scratch = module;
    Builder b(scratch, 0);
    for (const Expression& expression : expressions) {
      for (ValueId value : expression.build(b)) {
        const ir::Type type = b.type(value);
        results.push_back({"r" + std::to_string(results.size()), type});
        for (int i = 0; i < type.width; ++i)
          words.push_back(type.width == 1 ? expression.name : expression.name + "." + "xyzw"[i]);
      }
    }
  }
  module.functions[0].results = results;
  Builder b(module, 0);
  std::vector<ValueId> values;
  for (const Expression& expression : expressions)
    for (ValueId value : expression.build(b)) values.push_back(value);
  b.finish(values);
  return driver::finish_eval(std::move(module), 0, std::move(name), tier);
}

int word_count(const Expression& expression) {
  std::vector<std::string> words;
  program_of("count", {expression}, words);
  return static_cast<int>(words.size());
}

std::vector<Case> cases_of(const std::string& name, const std::vector<Expression>& expressions,
                           functions::Tier tier = functions::Tier::standard) {
  std::vector<Case> cases;
  std::vector<Expression> chunk;
  int used = 0;
  const auto flush = [&] {
    if (chunk.empty()) return;
    Case made;
    made.name = name + "_" + std::to_string(cases.size());
    made.program = program_of(made.name, chunk, made.words, tier);
    cases.push_back(std::move(made));
    chunk.clear();
    used = 0;
  };
  for (const Expression& expression : expressions) {
    const int words = word_count(expression);
    if (used + words > max_words) flush();
    chunk.push_back(expression);
    used += words;
  }
  flush();
  return cases;
}

}  // namespace

std::vector<Case> op_cases() {
  std::vector<Expression> expressions;
  for (int i = 0; i < ir::primitive_count; ++i) {
    const auto op = static_cast<Opcode>(i);
    const ir::Rule rule = ir::info(op).rule;
    const bool vectors = rule == ir::Rule::same || rule == ir::Rule::choose;
    for (int width = 1; width <= (vectors ? 4 : 1); ++width) expressions.push_back(op_expression(op, width));
  }
  return cases_of("ops", expressions);
}

std::vector<Case> function_cases() {
  std::vector<Expression> expressions;
  for (const functions::Variant& variant : functions::variants())
    expressions.push_back(function_expression(variant));
  return cases_of("functions", expressions);
}

std::vector<Case> tier_cases() {
  std::vector<Case> cases;
  for (const functions::Tier tier : {functions::Tier::fast, functions::Tier::precise}) {
    std::vector<Expression> expressions;
    for (const functions::Variant& variant : functions::variants())
      if (variant.has_own_body(tier)) expressions.push_back(function_expression(variant));
    for (Case& made : cases_of(std::string(functions::tier_name(tier)), expressions, tier))
      cases.push_back(std::move(made));
  }
  return cases;
}

// What optimisers like to recognise and to replace by something that is nearly the same.
std::vector<Case> idiom_cases() {
  std::vector<Expression> e;
  const auto add = [&](std::string name,
                       std::function<ValueId(Builder&, ValueId a, ValueId b, ValueId c)> build) {
    e.push_back({std::move(name), [build = std::move(build)](Builder& b) {
                   return std::vector{build(b, b.parameter(0), b.parameter(1), b.parameter(2))};
                 }});
  };
  const auto compare_select = [&](std::string name, Opcode compare, bool swapped) {
    add(std::move(name), [=](Builder& k, ValueId a, ValueId b, ValueId) {
      const ValueId condition = k.op(compare, {a, b});
      return swapped ? k.op(Opcode::select, {condition, b, a}) : k.op(Opcode::select, {condition, a, b});
    });
  };
  for (Opcode compare : {Opcode::flt, Opcode::fle, Opcode::fgt, Opcode::fge, Opcode::feq, Opcode::fne}) {
    compare_select(std::string(ir::name(compare)) + "_select", compare, false);
    compare_select(std::string(ir::name(compare)) + "_select_swapped", compare, true);
  }
  // LLVM compares the operands instead of the sum, which may have been flushed to zero.
  for (Opcode compare : {Opcode::flt, Opcode::fle, Opcode::fgt, Opcode::fge, Opcode::feq, Opcode::fne})
    for (Opcode sum : {Opcode::fadd, Opcode::fsub}) {
      const std::string name = std::string(ir::name(compare)) + "_of_" + std::string(ir::name(sum));
      add(name + "_and_zero", [=](Builder& k, ValueId a, ValueId b, ValueId) {
        return k.op(compare, {k.op(sum, {a, b}), k.constant(0.0f)});
      });
      add("zero_" + name, [=](Builder& k, ValueId a, ValueId b, ValueId) {
        return k.op(compare, {k.constant(-0.0f), k.op(sum, {a, b})});
      });
    }
  add("is_nan", [](Builder& k, ValueId a, ValueId, ValueId) { return k.op(Opcode::fne, {a, a}); });
  add("is_nan_replaced", [](Builder& k, ValueId a, ValueId b, ValueId) {
    return k.op(Opcode::select, {k.op(Opcode::feq, {a, a}), a, b});
  });
  add("abs_by_select", [](Builder& k, ValueId a, ValueId, ValueId) {
    const ValueId negative = k.op(Opcode::flt, {a, k.constant(0.0f)});
    return k.op(Opcode::select, {negative, k.op(Opcode::fneg, {a}), a});
  });
  add("clamp_unit", [](Builder& k, ValueId a, ValueId, ValueId) {
    const ValueId low = k.op(Opcode::select, {k.op(Opcode::flt, {a, k.constant(0.0f)}), k.constant(0.0f), a});
    return k.op(Opcode::select, {k.op(Opcode::fgt, {low, k.constant(1.0f)}), k.constant(1.0f), low});
  });
  add("clamp", [](Builder& k, ValueId a, ValueId b, ValueId c) {
    const ValueId low = k.op(Opcode::select, {k.op(Opcode::flt, {a, b}), b, a});
    return k.op(Opcode::select, {k.op(Opcode::fgt, {low, c}), c, low});
  });
  add("contraction", [](Builder& k, ValueId a, ValueId b, ValueId c) {
    return k.op(Opcode::fadd, {k.op(Opcode::fmul, {a, b}), c});
  });
  add("contraction_sub", [](Builder& k, ValueId a, ValueId b, ValueId c) {
    return k.op(Opcode::fsub, {c, k.op(Opcode::fmul, {a, b})});
  });
  add("cancel", [](Builder& k, ValueId a, ValueId b, ValueId) {
    return k.op(Opcode::fsub, {k.op(Opcode::fadd, {a, b}), a});
  });
  add("factored", [](Builder& k, ValueId a, ValueId b, ValueId c) {
    return k.op(Opcode::fadd, {k.op(Opcode::fmul, {a, c}), k.op(Opcode::fmul, {b, c})});
  });
  add("self_difference", [](Builder& k, ValueId a, ValueId, ValueId) { return k.op(Opcode::fsub, {a, a}); });
  add("self_quotient", [](Builder& k, ValueId a, ValueId, ValueId) { return k.op(Opcode::fdiv, {a, a}); });
  add("square_of_root", [](Builder& k, ValueId a, ValueId, ValueId) {
    const ValueId root = k.op(Opcode::fsqrt, {a});
    return k.op(Opcode::fmul, {root, root});
  });
  add("double_negation", [](Builder& k, ValueId a, ValueId b, ValueId) {
    return k.op(Opcode::fsub, {k.op(Opcode::fneg, {a}), k.op(Opcode::fneg, {b})});
  });
  add("reciprocal_product", [](Builder& k, ValueId a, ValueId b, ValueId) {
    return k.op(Opcode::fmul, {a, k.op(Opcode::fdiv, {k.constant(1.0f), b})});
  });
  add("divide_by_constant", [](Builder& k, ValueId a, ValueId, ValueId) {
    return k.op(Opcode::fdiv, {a, k.constant(3.0f)});
  });
  add("compare_of_sum", [](Builder& k, ValueId a, ValueId b, ValueId) {
    return k.op(Opcode::flt, {k.op(Opcode::fadd, {a, b}), a});
  });
  add("not_less", [](Builder& k, ValueId a, ValueId b, ValueId) {
    return k.op(Opcode::bnot, {k.op(Opcode::flt, {a, b})});
  });
  add("fract", [](Builder& k, ValueId a, ValueId, ValueId) {
    return k.op(Opcode::fsub, {a, k.op(Opcode::floor, {a})});
  });
  add("lazy_branch", [](Builder& k, ValueId a, ValueId b, ValueId c) {
    return k.branch(
        k.op(Opcode::flt, {a, b}),
        [&] {
          return std::vector{k.op(Opcode::fdiv, {a, c})};
        },
        [&] {
          return std::vector{k.op(Opcode::fmul, {b, c})};
        })[0];
  });
  add("loop_sum", [](Builder& k, ValueId a, ValueId b, ValueId c) {
    // A count that is the same for all rows and that no compiler knows: the int of the first row, within 2 to 7.
    const ValueId word = k.load(static_cast<uint32_t>(lower::FrameBuffer::inputs), k.constant(3));
    const ValueId count = k.op(Opcode::ior, {k.op(Opcode::iand, {word, k.constant(7)}), k.constant(2)});
    return k.loop(count, std::vector{a}, [&](ValueId index, std::span<const ValueId> carried) {
      const ValueId term = k.op(Opcode::fmul, {k.op(Opcode::itof, {index}), b});
      return std::vector{k.op(Opcode::fadd, {k.op(Opcode::fmul, {carried[0], c}), term})};
    })[0];
  });
  return cases_of("idioms", e);
}

}  // namespace isoshade::conformance
