// SPDX-License-Identifier: Apache-2.0
// The derivative of every op and of every row of functions.def against a difference quotient of its reference in
// higher precision, at 1000 random points at least and along random directions. Points where the quotients to both
// sides differ are left out: these are kinks and jumps, of abs, min, max, clamp, saturate, fract, mod, smoothstep's
// ends (second derivatives), the borders of cells of noises, equal distances of worleynoise2d, srgb's joints, sixths
// of hues; at them the side that the arithmetic takes gives the derivative.
#include <bit>
#include <cstdio>
#include <functional>
#include <gtest/gtest.h>
#include <optional>
#include <random>
#include <string_view>

#include "compiler/functions/library.h"
#include "compiler/ir/interpreter.h"
#include "compiler/ir/validator.h"
#include "compiler/passes/passes.h"
#include "tests/accuracy/measure.h"

namespace isoshade::accuracy {

namespace {

using Reals = std::vector<Real>;

namespace rows {

#define D(...) \
  { __VA_ARGS__ }
#define FUNCTION(row, signature, ulp, ranges, reference_, unit_) \
  struct row##_row : reference::rows::row##_row {                \
    using Variants = functions::Signatures<float>::signature;    \
    static std::vector<Range> domain() { return ranges; }        \
  };
#include "compiler/functions/functions.def"

}  // namespace rows

// Reference values from lists of numbers, and back.
template <class T>
struct Exact;
template <>
struct Exact<float> {
  static Real take(const Real*& from) { return *from++; }
};
template <int N>
struct Exact<lanes::vec<float, N>> {
  static Vector<N> take(const Real*& from) {
    return reference::vector<N>([&](int) { return *from++; });
  }
};
template <int N>
struct Exact<functions::mat<float, N>> {
  static Matrix<N> take(const Real*& from) {
    return reference::columns<N>([&](int) { return Exact<lanes::vec<float, N>>::take(from); });
  }
};
void flatten(Real x, Reals& out) { out.push_back(x); }
template <int N>
void flatten(const Vector<N>& v, Reals& out) {
  for (int i = 0; i < N; ++i) out.push_back(v[i]);
}
template <int N>
void flatten(const Matrix<N>& m, Reals& out) {
  for (int i = 0; i < N; ++i) flatten(m[i], out);
}

using Reference = std::function<Reals(const Reals&)>;

template <class Row, class... T>
Reference reference_of(functions::Types<T...>) {
  return [](const Reals& arguments) {
    const Real* from = arguments.data();
    const std::tuple taken{Exact<T>::take(from)...};
    Reals out;
    flatten(std::apply([](auto... a) { return Row::exact(a...); }, taken), out);
    return out;
  };
}

/// The derivative at `x` along `d`: of each result, from above, from below and from both sides.
struct Quotients {
  Reals above, below, both;
};
Quotients quotients(const Reference& f, const Reals& x, const Reals& d, Real h) {
  const auto at = [&](Real step) {
    Reals moved = x;
    for (size_t i = 0; i < x.size(); ++i) moved[i] += step * d[i];
    return f(moved);
  };
  const Reals up = at(h), here = at(0), down = at(-h);
  Quotients q;
  for (size_t i = 0; i < here.size(); ++i) {
    q.above.push_back((up[i] - here[i]) / h);
    q.below.push_back((here[i] - down[i]) / h);
    q.both.push_back((up[i] - down[i]) / (2 * h));
  }
  return q;
}

/// A function `f` of the arguments and, after derivatives, of what they change by.
class Differentiated {
 public:
  using Build = std::function<std::vector<ir::ValueId>(ir::Builder&)>;
  Differentiated(const std::vector<ir::Type>& parameters, const std::vector<ir::Type>& results,
                 const Build& build) {
    ir::Function f;
    f.name = "f";
    for (size_t i = 0; i < parameters.size(); ++i)
      f.parameters.push_back({"p" + std::to_string(i), parameters[i], "", false});
    for (size_t i = 0; i < results.size(); ++i) f.results.push_back({"r" + std::to_string(i), results[i]});
    module_.functions.push_back(std::move(f));
    ir::Builder b(module_, 0);
    std::vector<ir::ValueId> out;
    for (const ir::ValueId value : build(b)) out.push_back(b.op(ir::Opcode::ddx, {value}));
    b.finish(out);
    passes::derivatives(module_);
    EXPECT_FALSE(ir::asks_for_derivatives(module_));
    functions::expand(module_);
    EXPECT_EQ(ir::validate(module_), "");
    for (const ir::Parameter& p : module_.functions[0].parameters) {
      if (p.group == "gradients") asked_.push_back(std::stoul(p.name.substr(1)));
    }
    for (const ir::Result& r : module_.functions[0].results) words_ += r.type.width;
    interpreter_.emplace(module_);
  }

  std::vector<float> operator()(const std::vector<float>& x, const std::vector<float>& d) {
    const ir::Function& f = module_.functions[0];
    std::vector<uint32_t> in;
    std::vector<size_t> first;
    for (const float value : x) in.push_back(std::bit_cast<uint32_t>(value));
    size_t word = 0;
    for (size_t i = 0; i < f.parameters.size() - asked_.size(); ++i)
      first.push_back(std::exchange(word, word + f.parameters[i].type.width));
    for (const size_t parameter : asked_)
      for (size_t i = 0; i < f.parameters[parameter].type.width; ++i)
        in.push_back(std::bit_cast<uint32_t>(d[first[parameter] + i]));
    std::vector<uint32_t> words(words_);
    EXPECT_TRUE(interpreter_->run(0, in, words));
    std::vector<float> out;
    for (const uint32_t bits : words) out.push_back(std::bit_cast<float>(bits));
    return out;
  }

 private:
  ir::Module module_;
  std::vector<size_t> asked_;  ///< the parameter that each gradient is of
  size_t words_ = 0;
  std::optional<ir::Interpreter> interpreter_;
};

/// Moderate numbers: references of huge ones tell nothing of derivatives.
Range moderate(Range range) {
  const double low = range.low > 0 ? std::max(range.low, 0.05) : std::max(range.low, -8.0);
  return {low, std::min(range.high, 8.0)};
}

/// Compares at random points; the error allowed is `bound` times what the arguments' parts of the derivative sum
/// up to in magnitude.
void expect_derivatives(const std::string& name, Differentiated& f, const Reference& reference,
                        const std::vector<Range>& ranges, Real bound) {
  std::mt19937_64 random(7);
  const auto between = [&](double low, double high) {
    return static_cast<float>(low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53);
  };
  int compared = 0, points = 0;
  Real worst = 0;
  for (; compared < 1000 && points < 5000; ++points) {
    std::vector<float> x, d;
    for (const Range& range : ranges) {
      x.push_back(between(range.low, range.high));
      d.push_back(between(-1, 1));
    }
    const Reals exact_x(x.begin(), x.end()), exact_d(d.begin(), d.end());
    constexpr Real h = 1e-7L;
    const Quotients q = quotients(reference, exact_x, exact_d, h);
    Reals unit(q.both.size());
    bool smooth = true;
    for (size_t i = 0; i < x.size(); ++i) {
      Reals along(x.size());
      along[i] = exact_d[i];
      const Quotients part = quotients(reference, exact_x, along, h);
      for (size_t k = 0; k < unit.size(); ++k) unit[k] += std::abs(part.both[k]);
    }
    for (size_t k = 0; k < unit.size(); ++k)
      smooth &= std::isfinite(q.both[k]) && std::abs(q.above[k] - q.below[k]) <= 1e-4L * unit[k] + 1e-9L;
    if (!smooth) continue;
    ++compared;
    std::vector<float> got;
    {
      const lanes::FpGuard guard;
      got = f(x, d);
    }
    ASSERT_EQ(got.size(), unit.size());
    for (size_t k = 0; k < got.size(); ++k) {
      const Real off = std::abs(got[k] - q.both[k]);
      if (!(off <= 1e-9L)) worst = std::max(worst, off / unit[k]);
      ASSERT_TRUE(off <= bound * unit[k] + 1e-9L)
          << name << " result " << k << ": " << got[k] << " is not " << static_cast<double>(q.both[k])
          << " (unit " << static_cast<double>(unit[k]) << ") at " << ::testing::PrintToString(x) << " along "
          << ::testing::PrintToString(d);
    }
  }
  std::printf("    %-24s %.2e of %.0e, %d points, %d kinks\n", name.c_str(), static_cast<double>(worst),
              static_cast<double>(bound), compared, points - compared);
  EXPECT_GE(compared, 1000) << name;
}

// The IR types of an argument.
void add_types(float, std::vector<ir::Type>& out) { out.push_back(ir::float_type); }
template <int N>
void add_types(const lanes::vec<float, N>&, std::vector<ir::Type>& out) {
  out.push_back(ir::vector_type(N));
}
template <int N>
void add_types(const functions::mat<float, N>&, std::vector<ir::Type>& out) {
  out.insert(out.end(), N, ir::vector_type(N));
}

template <class Row, class... T>
void expect_variant(std::string_view row, Real bound, functions::Types<T...> types) {
  std::vector<ir::Type> parameters;
  std::vector<Range> ranges;
  size_t argument = 0;
  const auto add = [&](auto value) {
    const size_t first = parameters.size();
    add_types(value, parameters);
    for (size_t i = first; i < parameters.size(); ++i)
      ranges.insert(ranges.end(), parameters[i].width, moderate(Row::domain()[argument]));
    ++argument;
  };
  (add(T{}), ...);
  const functions::Variant* variant = functions::find(row, parameters);
  ASSERT_NE(variant, nullptr);
  Differentiated f(parameters, variant->results, [&](ir::Builder& b) {
    std::vector<ir::ValueId> arguments;
    for (size_t i = 0; i < parameters.size(); ++i) arguments.push_back(b.parameter(i));
    return functions::call_library(b, row, arguments);
  });
  expect_derivatives(variant->name, f, reference_of<Row>(types), ranges, bound);
}

template <class T>
constexpr bool is_of_floats = false;
template <class... T>
constexpr bool is_of_floats<functions::Types<T...>> = (std::is_same_v<T, float> && ...);

/// Rows on floats are tried on floats: wider variants call them for each component.
template <class Row, class First, class... Rest>
void expect_variants(std::string_view row, Real bound, functions::Types<First, Rest...>) {
  if (row.ends_with("_exact")) return;  // stand for ops, after derivatives
  expect_variant<Row>(row, bound, First{});
  if constexpr (!is_of_floats<First>) (expect_variant<Row>(row, bound, Rest{}), ...);
}

/// Where the arithmetic itself loses digits: near its ends smoothstep rises by 1 - t, beside an axis normalize by what
/// is left across, an inverse is as exact as its determinant, and octaves of a fractal are at rounded points.
Real bound_of(std::string_view row) {
  const bool loses =
      row == "smoothstep" || row == "normalize" || row == "inverse" || row.starts_with("fractal");
  return loses ? 1e-3L : 1e-5L;
}

#define FUNCTION(row, signature, ulp, domain, reference_, unit_)                         \
  TEST(DerivativeMatchesTheDifferenceQuotient, row) {                                    \
    expect_variants<rows::row##_row>(#row, bound_of(#row), rows::row##_row::Variants{}); \
  }
#include "compiler/functions/functions.def"

using Op = ir::Opcode;

/// An op on vectors of two, whose second operand's components are positive.
void expect_op(Op op, const std::function<Real(Real, Real)>& exact) {
  const int arity = ir::info(op).arity;
  const ir::Type type = ir::vector_type(2);
  Differentiated f(std::vector<ir::Type>(static_cast<size_t>(arity), type), {type}, [&](ir::Builder& b) {
    std::vector<ir::ValueId> operands;
    for (int i = 0; i < arity; ++i) operands.push_back(b.parameter(static_cast<size_t>(i)));
    return std::vector{b.op(op, operands)};
  });
  const Reference reference = [&](const Reals& x) {
    return Reals{exact(x[0], x.size() > 2 ? x[2] : 0), exact(x[1], x.size() > 2 ? x[3] : 0)};
  };
  const Range first = op == Op::fsqrt ? Range{0.01, 8} : Range{-8, 8};
  std::vector<Range> ranges{first, first};
  if (arity == 2) ranges.insert(ranges.end(), 2, Range{0.1, 8});
  expect_derivatives(std::string(ir::name(op)), f, reference, ranges, 2e-6L);
}

TEST(DerivativeMatchesTheDifferenceQuotient, EveryFloatOp) {
  expect_op(Op::fadd, [](Real x, Real y) { return x + y; });
  expect_op(Op::fsub, [](Real x, Real y) { return x - y; });
  expect_op(Op::fmul, [](Real x, Real y) { return x * y; });
  expect_op(Op::fdiv, [](Real x, Real y) { return x / y; });
  expect_op(Op::fsqrt, [](Real x, Real) { return std::sqrt(x); });
  expect_op(Op::floor, [](Real x, Real) { return std::floor(x); });
  expect_op(Op::fneg, [](Real x, Real) { return -x; });
  expect_op(Op::fabs, [](Real x, Real) { return std::abs(x); });
}

TEST(DerivativeMatchesTheDifferenceQuotient, OpsWithOneConstantOperand) {
  for (const bool first : {true, false}) {
    for (const Op op : {Op::fadd, Op::fsub, Op::fmul, Op::fdiv}) {
      Differentiated f({ir::float_type}, {ir::float_type}, [&](ir::Builder& b) {
        const ir::ValueId three = b.constant(3.0f), x = b.parameter(0);
        return std::vector{first ? b.op(op, {x, three}) : b.op(op, {three, x})};
      });
      const Reference reference = [&](const Reals& x) {
        const Real a = first ? x[0] : 3, b = first ? 3 : x[0];
        return Reals{op == Op::fadd ? a + b : op == Op::fsub ? a - b : op == Op::fmul ? a * b : a / b};
      };
      expect_derivatives(std::string(ir::name(op)) + (first ? "(x, 3)" : "(3, x)"), f, reference, {{0.1, 8}},
                         2e-6L);
    }
  }
}

TEST(DerivativeMatchesTheDifferenceQuotient, SelectBranchAndLoop) {
  const std::vector<ir::Type> two(2, ir::float_type);
  const auto side = [](Real x, Real y) { return x < y ? x * y : y * y * x; };
  const auto sides = [](ir::Builder& b) {
    const ir::ValueId x = b.parameter(0), y = b.parameter(1);
    const ir::ValueId xy = b.op(Op::fmul, {x, y});
    return std::array{b.op(Op::flt, {x, y}), xy, b.op(Op::fmul, {xy, y})};
  };
  const Reference choice = [&](const Reals& x) { return Reals{side(x[0], x[1])}; };
  const std::vector<Range> ranges(2, Range{-3, 3});
  Differentiated select(two, {ir::float_type}, [&](ir::Builder& b) {
    const auto [condition, then, other] = sides(b);
    return std::vector{b.op(Op::select, {condition, then, other})};
  });
  expect_derivatives("select", select, choice, ranges, 2e-6L);
  Differentiated branch(two, {ir::float_type, ir::float_type}, [&](ir::Builder& b) {
    const auto all = sides(b);
    return b.branch(
        all[0],
        [&] {
          return std::vector{all[1], b.constant(1.0f)};
        },
        [&] {
          return std::vector{b.op(Op::fmul, {all[1], b.parameter(1)}), b.parameter(0)};
        });
  });
  const Reference both = [&](const Reals& x) { return Reals{side(x[0], x[1]), x[0] < x[1] ? 1 : x[0]}; };
  expect_derivatives("branch", branch, both, ranges, 2e-6L);
  // sum = sum * x + y, five times from x; the power beside it does not change with y.
  Differentiated loop(two, {ir::float_type, ir::float_type}, [&](ir::Builder& b) {
    const ir::ValueId x = b.parameter(0), y = b.parameter(1);
    const std::array initial{x, b.constant(1.0f), b.constant(0.0f)};
    const std::vector<ir::ValueId> sums =
        b.loop(b.constant(5), initial, [&](ir::ValueId, std::span<const ir::ValueId> carried) {
          const ir::ValueId product = b.op(Op::fmul, {carried[0], x});
          return std::vector{b.op(Op::fadd, {product, y}), b.op(Op::fmul, {carried[1], x}),
                             b.op(Op::fadd, {carried[2], carried[1]})};
        });
    return std::vector{sums[0], sums[2]};
  });
  const Reference horner = [](const Reals& x) {
    Real sum = x[0], power = 1, powers = 0;
    for (int i = 0; i < 5; ++i) sum = sum * x[0] + x[1], powers += power, power *= x[0];
    return Reals{sum, powers};
  };
  expect_derivatives("loop", loop, horner, std::vector<Range>(2, Range{0.1, 1.5}), 5e-6L);
}

TEST(Derivative, IsZeroWhereInfiniteOrUndefined) {
  const auto of = [](const char* row, int width) {
    const ir::Type type = width == 1 ? ir::float_type : ir::vector_type(width);
    const functions::Variant* variant = functions::find(row, std::array{type});
    return Differentiated({type}, variant->results, [&](ir::Builder& b) {
      return functions::call_library(b, row, std::array{b.parameter(0)});
    });
  };
  EXPECT_EQ(of("length", 2)({0, 0}, {1, 2}), (std::vector<float>{0}));
  EXPECT_EQ(of("normalize", 3)({0, 0, 0}, {1, 2, 3}), (std::vector<float>{0, 0, 0}));
  EXPECT_EQ(of("asin", 1)({1}, {1}), (std::vector<float>{0}));
  for (const Op op : {Op::fsqrt, Op::fabs}) {
    Differentiated f({ir::float_type}, {ir::float_type},
                     [&](ir::Builder& b) { return std::vector{b.op(op, {b.parameter(0)})}; });
    EXPECT_EQ(f({0}, {1}), (std::vector<float>{0}));
  }
}

}  // namespace
}  // namespace isoshade::accuracy
