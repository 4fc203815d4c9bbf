// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/known_ranges.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <unordered_map>

#include "compiler/functions/library.h"
#include "compiler/prove/ends.h"

namespace isoshade::passes {

using ir::Opcode;
using ir::Scalar;

namespace {

KnownRange any_of(Scalar scalar) {
  if (scalar == Scalar::floating) return {};
  return scalar == Scalar::boolean ? KnownRange{0, 1} : KnownRange{-0x1p31, 0x1p31 - 1};
}

KnownRange either(const KnownRange& a, const KnownRange& b) {
  if (!a || !b) return {};
  return {std::min(a.lo, b.lo), std::max(a.hi, b.hi), !a.is_never_minus_zero() || !b.is_never_minus_zero(),
          std::min(a.gap, b.gap)};
}

KnownRange constant(Scalar scalar, uint32_t bits) {
  const bool is_float = scalar == Scalar::floating;
  const auto value = is_float ? static_cast<double>(std::bit_cast<float>(bits)) : static_cast<int32_t>(bits);
  if (!std::isfinite(value)) return {};
  return {value, value, std::signbit(value), value == 0 ? HUGE_VAL : std::abs(value)};
}

/// What is known of the sign of a float that is 0, and of how near to 0 others are.
void find_zeros(KnownRange& out, Opcode op, const KnownRange& a, const KnownRange& b, bool same) {
  // A sum of which one operand is at least this is a multiple of 2^-126: it is never flushed, which could make it -0.
  constexpr double least_of_normal_sums = 0x1p-100;
  const auto certain_signs_agree = [&] { return same || (a.is_plus() && b.is_plus()) || (a.hi < 0 && b.hi < 0); };
  switch (op) {
    case Opcode::fadd:
      out.may_be_minus_zero = (!a.is_never_minus_zero() && !b.is_never_minus_zero()) ||
                              (std::max(a.gap, b.gap) < least_of_normal_sums && !(a.is_plus() && b.is_plus()));
      // If x is not 0, x + y is a multiple of half the distance of floats at x, or at least half of x; else it is y.
      out.gap = std::max({0x1p-126, std::min(a.gap * 0x1p-25, a.may_be_zero() ? b.gap : HUGE_VAL),
                          std::min(b.gap * 0x1p-25, b.may_be_zero() ? a.gap : HUGE_VAL)});
      return;
    case Opcode::fmul:
    case Opcode::fdiv: out.may_be_minus_zero = !certain_signs_agree(); return;
    case Opcode::fsqrt:
    case Opcode::floor: out.may_be_minus_zero = !a.is_plus(); return;
    case Opcode::fabs: out.may_be_minus_zero = false; return;
    case Opcode::itof: out.may_be_minus_zero = false; return;
    default: return;
  }
}

/// The range of an op's result, by its range rule, where those of its operands are known.
KnownRange by_range_rule(ir::RangeRule rule, const KnownRange& a, const KnownRange& b, bool same,
                         Scalar scalar) {
  const std::optional<prove::Ends> ends = prove::ends_of(rule, {a.lo, a.hi}, {b.lo, b.hi}, same);
  if (!ends) return any_of(scalar);
  return std::isfinite(ends->lo) && std::isfinite(ends->hi) ? KnownRange{ends->lo, ends->hi} : KnownRange{};
}

/// The variants of functions.def, by name.
const functions::Variant& variant_of(const ir::Function& function) {
  static const std::unordered_map<std::string_view, const functions::Variant*> by_name = [] {
    std::unordered_map<std::string_view, const functions::Variant*> map;
    for (const functions::Variant& variant : functions::variants()) map.emplace(variant.name, &variant);
    return map;
  }();
  return *by_name.at(function.library);
}

}  // namespace

RangeWalker::RangeWalker(const ir::Module& module, functions::Tier tier)
    : module_(module),
      tier_(tier),
      arguments_(module.functions.size()),
      met_decisions_(module.functions.size()),
      library_(module.functions.size()) {}

KnownRanges RangeWalker::any(ir::Type type) {
  KnownRanges ranges;
  ranges.fill(any_of(type.scalar));
  return ranges;
}

const RangeWalker::Library& RangeWalker::library_of(uint32_t function) {
  std::optional<Library>& library = library_[function];
  if (library) return *library;
  library.emplace();
  const ir::Function& callee = module_.functions[function];
  if (callee.library.empty()) return *library;
  const functions::Variant& variant = variant_of(callee);
  library->row = variant.row;
  library->chooses =
      variant.row == "min" || variant.row == "max" || variant.row == "clamp" || variant.row == "saturate";
  library->rule = prove::find_rule(variant.row);
  return *library;
}

void RangeWalker::keep(uint32_t function, const std::vector<KnownRanges>& arguments) {
  std::vector<KnownRanges>& all = arguments_[function];
  if (all.empty()) {
    all = arguments;
    return;
  }
  for (size_t i = 0; i < all.size(); ++i)
    for (size_t c = 0; c < 4; ++c) all[i][c] = either(all[i][c], arguments[i][c]);
}

std::vector<KnownRanges> RangeWalker::walk(uint32_t function, const std::vector<KnownRanges>& given) {
  const ir::Function& callee = module_.functions[function];
  std::vector<KnownRanges> results;
  if (callee.is_declaration() || budget_ <= 0) {
    for (const ir::Result& result : callee.results) results.push_back(any(result.type));
    return results;
  }
  std::vector<KnownRanges> arguments = given;
  for (size_t i = 0; i < arguments.size(); ++i) {
    const ir::Parameter& parameter = callee.parameters[i];
    if (!parameter.least || !parameter.most) continue;
    arguments[i].fill({static_cast<double>(*parameter.least), static_cast<double>(*parameter.most)});
  }
  if (!callee.document.empty()) keep(function, arguments);
  RangeFrame frame{&callee, std::vector<KnownRanges>(callee.values.size())};
  for (size_t i = 0; i < arguments.size(); ++i) frame.values[callee.blocks[0].parameters[i]] = arguments[i];
  block(frame, 0, function);
  for (size_t r = 0; r < callee.results.size(); ++r)
    results.push_back(finished() ? frame.values[callee.blocks[0].yields[r]] : any(callee.results[r].type));
  return results;
}

void RangeWalker::block(RangeFrame& frame, ir::BlockId id, uint32_t function) {
  const bool counts = !frame.function->document.empty();
  const std::function<void(ir::BlockId)> walk_inner = [&](ir::BlockId inner) { block(frame, inner, function); };
  for (const ir::InstructionId i : frame.function->blocks[id].instructions) {
    if (--budget_ <= 0) return;
    const ir::Instruction& made = frame.function->instructions[i];
    instruction(frame, made, walk_inner);
    if (counts && decides(frame, made)) met_decisions_[function] = true;
  }
}

bool RangeWalker::decides(const RangeFrame& frame, const ir::Instruction& made) {
  const auto is_known = [&](ir::ValueId value) { return bool(frame.values[value][0]); };
  if (made.op == Opcode::call)
    return library_of(made.imm).chooses && std::ranges::all_of(frame.function->operands_of(made), is_known);
  if (made.op == Opcode::fabs) return is_known(made.first_result);
  if (made.op == Opcode::fadd || made.op == Opcode::fsub)
    for (const ir::ValueId operand : frame.function->operands_of(made))
      if (frame.values[operand][0].is_zero()) return true;
  if (made.op == Opcode::select) return frame.values[frame.function->operands_of(made)[0]][0].is_point();
  return ir::is_primitive(made.op) && frame.values[made.first_result][0].is_point();
}

void RangeWalker::instruction(RangeFrame& frame, const ir::Instruction& made,
                              const std::function<void(ir::BlockId)>& walk_block) {
  const ir::Function& f = *frame.function;
  const auto in = f.operands_of(made);
  const ir::Type type = f.type(made.first_result);
  KnownRanges& out = frame.values[made.first_result];
  switch (made.op) {
    case Opcode::constant: out.fill(constant(type.scalar, made.imm)); return;
    case Opcode::hidden_zero: out.fill({0, 0, false}); return;
    case Opcode::construct:
      for (size_t c = 0; c < in.size(); ++c) out[c] = frame.values[in[c]][0];
      return;
    case Opcode::extract: out.fill(frame.values[in[0]][made.imm]); return;
    case Opcode::call: return call(frame, made);
    case Opcode::loop: return loop(frame, made, walk_block);
    case Opcode::branch:
      for (const ir::BlockId side : made.blocks) walk_block(side);
      for (uint32_t r = 0; r < made.result_count; ++r)
        for (size_t c = 0; c < 4; ++c)
          frame.values[made.first_result + r][c] =
              either(frame.values[f.blocks[made.blocks[0]].yields[r]][c],
                     frame.values[f.blocks[made.blocks[1]].yields[r]][c]);
      return;
    case Opcode::load:
    case Opcode::ddx:
    case Opcode::ddy: out = any(type); return;
#define OP(name, ...) case Opcode::name:
#include "compiler/ir/ops.def"
      out = primitive(frame, made);
  }
}

KnownRanges RangeWalker::primitive(const RangeFrame& frame, const ir::Instruction& made) const {
  const ir::OpInfo& row = ir::info(made.op);
  const ir::Type type = frame.function->type(made.first_result);
  const auto in = frame.function->operands_of(made);
  KnownRanges out = any(type);
  const auto of = [&](size_t operand, uint32_t c) -> const KnownRange& {
    return frame.values[in[operand]][frame.function->type(in[operand]).width == 1 ? 0 : c];
  };
  for (uint32_t c = 0; c < type.width; ++c) {
    const KnownRange &a = of(0, c), &b = of(in.size() > 1 ? 1 : 0, c);
    if (row.rule == ir::Rule::choose)
      out[c] = a.is_point() ? of(a.lo != 0 ? 1 : 2, c) : either(of(1, c), of(2, c));
    else if (a && b) {
      const bool same = in.size() > 1 && in[0] == in[1];
      out[c] = by_range_rule(row.range, a, b, same, type.scalar);
      if (out[c] && type.is_float()) find_zeros(out[c], made.op, a, b, same);
    }
  }
  return out;
}

/// The range of min, max, clamp and saturate, which may be known where not all arguments are.
KnownRanges RangeWalker::chosen(const RangeFrame& frame, const ir::Instruction& made,
                                std::string_view row) const {
  const ir::Function& f = *frame.function;
  const auto in = f.operands_of(made);
  KnownRanges out;
  const auto may_give_minus_zero = [](const KnownRange& a, const KnownRange& b) {
    return !a.is_never_minus_zero() || !b.is_never_minus_zero();
  };
  // min(a, b) is b < a ? b : a, and max(a, b) is a < b ? b : a: a NaN in the place of b gives a.
  const auto lesser = [&](const KnownRange& a, const KnownRange& b) -> KnownRange {
    if (a && b) return {std::min(a.lo, b.lo), std::min(a.hi, b.hi), may_give_minus_zero(a, b)};
    if (a.least && b) return {std::min(*a.least, b.lo), b.hi};
    return a ? KnownRange{.most = a.hi} : KnownRange{};
  };
  const auto greater = [&](const KnownRange& a, const KnownRange& b) -> KnownRange {
    if (a && b) return {std::max(a.lo, b.lo), std::max(a.hi, b.hi), may_give_minus_zero(a, b)};
    if (a.most && b) return {b.lo, std::max(*a.most, b.hi)};
    return a ? KnownRange{.least = a.lo} : KnownRange{};
  };
  for (uint32_t c = 0; c < f.type(made.first_result).width; ++c) {
    const auto of = [&](size_t operand) -> const KnownRange& {
      return frame.values[in[operand]][f.type(in[operand]).width == 1 ? 0 : c];
    };
    if (row == "saturate")
      out[c] = of(0) ? KnownRange{std::clamp(of(0).lo, 0.0, 1.0), std::clamp(of(0).hi, 0.0, 1.0), false}
                     : KnownRange{0, 1, false};
    else if (row == "min")
      out[c] = lesser(of(0), of(1));
    else if (row == "max")
      out[c] = greater(of(0), of(1));
    else
      out[c] = lesser(greater(of(0), of(1)), of(2));
  }
  return out;
}

KnownRanges RangeWalker::by_rule(const RangeFrame& frame, const ir::Instruction& made,
                                 const Library& library) const {
  const ir::Function& f = *frame.function;
  const ir::Type type = f.type(made.first_result);
  KnownRanges out = any(type);
  const bool componentwise = prove::is_componentwise(library.row);
  for (uint32_t c = 0; c < type.width; ++c) {
    std::vector<prove::Bound> arguments;
    bool known = true;
    for (const ir::ValueId operand : f.operands_of(made)) {
      const uint32_t width = f.type(operand).width;
      for (uint32_t k = 0; k < width; ++k) {
        if (componentwise && k != std::min(c, width - 1)) continue;
        const KnownRange& range = frame.values[operand][k];
        known = known && range;
        if (known) arguments.push_back(prove::between(range.lo, range.hi));
      }
    }
    if (!known) continue;
    const prove::Outcome outcome =
        prove::bound_of(*library.rule, arguments, componentwise ? 0 : c, tier_);
    if (outcome.breach == prove::Breach::none) out[c] = {outcome.bound.lo, outcome.bound.hi};
  }
  return out;
}

void RangeWalker::call(RangeFrame& frame, const ir::Instruction& made) {
  const ir::Function& f = *frame.function;
  const ir::Function& callee = module_.functions[made.imm];
  const auto in = f.operands_of(made);
  const auto is_known = [&](ir::ValueId operand) {
    const KnownRanges& ranges = frame.values[operand];
    return std::any_of(ranges.begin(), ranges.begin() + f.type(operand).width,
                       [](const KnownRange& r) { return bool(r); });
  };
  const Library& library = library_of(made.imm);
  if (library.chooses) {
    frame.values[made.first_result] = chosen(frame, made, library.row);
    return;
  }
  // No argument has a known range, so no result has one; skip the expensive walk.
  const bool is_lost = !callee.library.empty() && std::ranges::none_of(in, is_known);
  if (is_lost) {
    for (uint32_t r = 0; r < made.result_count; ++r)
      frame.values[made.first_result + r] = any(f.type(made.first_result + r));
    return;
  }
  if (library.rule != nullptr) {
    frame.values[made.first_result] = by_rule(frame, made, library);
    return;
  }
  std::vector<KnownRanges> arguments;
  for (const ir::ValueId operand : in) arguments.push_back(frame.values[operand]);
  const std::vector<KnownRanges> results = walk(made.imm, arguments);
  std::ranges::copy(results, frame.values.begin() + made.first_result);
}

void RangeWalker::loop(RangeFrame& frame, const ir::Instruction& made,
                       const std::function<void(ir::BlockId)>& walk_block) {
  const ir::Function& f = *frame.function;
  const ir::Block& body = f.blocks[made.blocks[0]];
  const KnownRange& count = frame.values[f.operands_of(made)[0]][0];
  frame.values[body.parameters[0]].fill({0, std::max(0.0, count.hi - 1)});
  for (uint32_t r = 0; r < made.result_count; ++r)
    frame.values[body.parameters[r + 1]] = any(f.type(body.parameters[r + 1]));
  walk_block(made.blocks[0]);
  for (uint32_t r = 0; r < made.result_count; ++r)
    frame.values[made.first_result + r] = any(f.type(made.first_result + r));
}

}  // namespace isoshade::passes
