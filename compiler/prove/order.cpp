// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "compiler/ir/laws.h"
#include "compiler/prove/flatten.h"

namespace isoshade::prove {
namespace {

using ir::Opcode;

/// Whether a comparison says that its first operand is below the second, or may be equal.
bool says_below(Opcode op) {
  const ir::RangeRule orders = ir::info(op).range;
  return ir::accepts(orders, ir::RangeRule::less) && !ir::accepts(orders, ir::RangeRule::greater);
}
bool says_above(Opcode op) { return says_below(ir::swapped(op)); }

class Ordering {
 public:
  explicit Ordering(Pool& pool) : pool_(pool), guard_of_(pool.tape().operations.size(), none) {}
  void run();

 private:
  void visit_from(uint32_t root);
  void find_guards();
  uint32_t child(uint32_t guard, uint32_t condition, bool truth);
  uint32_t common(uint32_t a, uint32_t b) const;
  bool encloses(uint32_t outer, uint32_t inner) const;

  void emit(uint32_t old);
  void enter(uint32_t guard);
  uint32_t append(Operation operation, std::span<const uint32_t> operands);
  /// The index of an operation's value as seen under a guard: narrowed by it, or as it is.
  uint32_t seen(uint32_t old, uint32_t guard) const;
  void narrow_by(uint32_t condition, bool truth, uint32_t guard);
  void narrow(uint32_t old, Opcode op, uint32_t by, uint32_t guard);

  void add_facts(uint32_t old);
  void add_dot_fact(uint32_t old);
  void add_projection(uint32_t old);
  void add_rotation(uint32_t old);
  void add_half(uint32_t old);
  /// The index of an operation if it comes before `user` and is evaluated wherever that is; or none.
  uint32_t before(uint32_t old, uint32_t user) const;
  /// An upper bound of the length of a vector, by how it was made.
  double longest(const Words& vector, int depth = 4) const;
  /// Whether a vector is the sum, or the difference, of these two.
  bool terms_of(const Words& vector, Words& left, Words& right) const;
  uint32_t shape_of(const Words& vector, uint32_t user, int depth = 4);
  /// A scalar product of the vector that an enclosing guard restricts; or none.
  uint32_t known_product(const Words& vector, uint32_t guard) const;
  uint32_t find_dot(std::span<const uint32_t> a, std::span<const uint32_t> b) const;

  Pool& pool_;
  std::vector<bool> visited_;
  std::vector<uint32_t> order_;
  std::vector<uint32_t> guard_of_;
  struct OldGuard {
    uint32_t parent, condition;
    bool truth;
    uint32_t depth;
    bool entered = false;
    std::map<uint32_t, uint32_t> narrowed = {};  ///< old operations, and where they are narrowed
  };
  std::vector<OldGuard> guards_{{0, none, true, 0, true}};
  std::vector<uint32_t> at_;  ///< of old operations: where they are now
  std::vector<Operation> operations_;
  std::vector<uint32_t> operands_;
};

void Ordering::visit_from(uint32_t root) {
  std::vector<std::pair<uint32_t, uint32_t>> stack{{root, 0}};

  while (!stack.empty()) {
    auto& [operation, next] = stack.back();
    if (next == 0 && visited_[operation]) {
      stack.pop_back();
      continue;
    }
    visited_[operation] = true;
    const auto operands = pool_.operands(operation);
    if (next == operands.size()) {
      order_.push_back(operation);
      stack.pop_back();
      continue;
    }
    const uint32_t operand = operands[next++];
    if (!visited_[operand]) stack.emplace_back(operand, 0);
  }
}

uint32_t Ordering::child(uint32_t guard, uint32_t condition, bool truth) {
  for (uint32_t i = 0; i < guards_.size(); ++i)
    if (i != 0 && guards_[i].parent == guard && guards_[i].condition == condition &&
        guards_[i].truth == truth)
      return i;
  guards_.push_back({guard, condition, truth, guards_[guard].depth + 1});
  return static_cast<uint32_t>(guards_.size() - 1);
}

uint32_t Ordering::common(uint32_t a, uint32_t b) const {
  while (a != b) {
    uint32_t& deeper = guards_[a].depth >= guards_[b].depth ? a : b;
    deeper = guards_[deeper].parent;
  }
  return a;
}

bool Ordering::encloses(uint32_t outer, uint32_t inner) const { return common(outer, inner) == outer; }

void Ordering::find_guards() {
  for (const Tape::Output& output : pool_.tape().outputs) guard_of_[output.operation] = 0;
  for (auto it = order_.rbegin(); it != order_.rend(); ++it) {
    const Operation& user = pool_[*it];
    const auto operands = pool_.operands(*it);
    for (uint32_t i = 0; i < operands.size(); ++i) {
      uint32_t guard = guard_of_[*it];
      if (user.kind == Kind::op && user.op == Opcode::select && i > 0)
        guard = child(guard, operands[0], i == 1);
      uint32_t& of_operand = guard_of_[operands[i]];
      of_operand = of_operand == none ? guard : common(of_operand, guard);
    }
  }
}

uint32_t Ordering::append(Operation operation, std::span<const uint32_t> operands) {
  operation.first = static_cast<uint32_t>(operands_.size());
  operation.count = static_cast<uint32_t>(operands.size());
  operands_.insert(operands_.end(), operands.begin(), operands.end());
  operations_.push_back(operation);
  return static_cast<uint32_t>(operations_.size() - 1);
}

uint32_t Ordering::seen(uint32_t old, uint32_t guard) const {
  for (uint32_t g = guard; g != 0; g = guards_[g].parent)
    if (const auto found = guards_[g].narrowed.find(old); found != guards_[g].narrowed.end())
      return found->second;
  return at_[old];
}

void Ordering::enter(uint32_t guard) {
  if (guards_[guard].entered) return;
  guards_[guard].entered = true;
  enter(guards_[guard].parent);
  const OldGuard& old = guards_[guard];
  pool_.tape().guards[guard] = {old.parent, seen(old.condition, old.parent), old.truth};
  append({.kind = Kind::enter, .index = guard}, {});
  narrow_by(old.condition, old.truth, guard);
}

void Ordering::narrow_by(uint32_t condition, bool truth, uint32_t guard) {
  const Operation& c = pool_[condition];
  if (c.kind != Kind::op) return;
  const auto operands = pool_.operands(condition);
  switch (ir::info(c.op).range) {
    using enum ir::RangeRule;
    case inverse: return narrow_by(operands[0], !truth, guard);
    case both:
    case either:
      if (truth != (c.op == Opcode::band)) return;
      narrow_by(operands[0], truth, guard);
      return narrow_by(operands[1], truth, guard);
    case less:
    case less_or_equal:
    case greater:
    case greater_or_equal:
    case equal:
    case not_equal: {
      if (ir::info(c.op).rule != ir::Rule::compare) return;  // ints are not narrowed
      const Opcode op = truth ? c.op : ir::opposite(c.op);
      narrow(operands[0], op, operands[1], guard);
      return narrow(operands[1], ir::swapped(op), operands[0], guard);
    }
    // These are no conditions, or imply nothing about the operands.
    case different:
    case choice:
    case any:
    case sum:
    case difference:
    case product:
    case quotient:
    case root:
    case floor:
    case negative:
    case magnitude:
    case truncated:
    case rounded:
    case integer_sum:
    case integer_difference: return;
  }
}

void Ordering::narrow(uint32_t old, Opcode op, uint32_t by, uint32_t guard) {
  const Operation& narrowed = pool_[old];
  if (narrowed.kind == Kind::constant || at_[old] == none || at_[by] == none) return;
  const std::array operands{seen(old, guard), seen(by, guard)};
  const Operation operation{.kind = Kind::narrow, .op = op, .place = narrowed.place, .guard = guard};
  guards_[guard].narrowed[old] = append(operation, operands);
  // min(a, b) above x implies that both are above x; the same for max and below.
  const bool both =
      (narrowed.kind == Kind::least && says_above(op)) || (narrowed.kind == Kind::greatest && says_below(op));
  if (!both) return;
  for (const uint32_t operand : pool_.operands(old)) narrow(operand, op, by, guard);
}

void Ordering::emit(uint32_t old) {
  const uint32_t guard = guard_of_[old];
  enter(guard);
  Operation operation = pool_[old];
  operation.guard = guard;
  std::vector<uint32_t> operands;
  const auto from = pool_.operands(old);
  for (uint32_t i = 0; i < from.size(); ++i) {
    uint32_t sees = guard;
    if (operation.kind == Kind::op && operation.op == Opcode::select && i > 0)
      sees = child(guard, from[0], i == 1);
    enter(sees);
    operands.push_back(seen(from[i], sees));
  }
  at_[old] = append(operation, operands);
  add_facts(old);
}

uint32_t Ordering::before(uint32_t old, uint32_t user) const {
  if (old == none || at_[old] == none || guard_of_[old] == none) return none;
  return encloses(guard_of_[old], guard_of_[user]) ? at_[old] : none;
}

uint32_t Ordering::find_dot(std::span<const uint32_t> a, std::span<const uint32_t> b) const {
  Words both(a.begin(), a.end());
  both.insert(both.end(), b.begin(), b.end());
  return pool_.find({.kind = Kind::dot}, both);
}

double Ordering::longest(const Words& vector, int depth) const {
  constexpr double any = HUGE_VAL;
  if (pool_.at_most_units.contains(vector)) return 1;
  if (depth == 0) return any;
  Words left, right;
  if (!terms_of(vector, left, right)) return any;
  return std::min(any, longest(left, depth - 1) + longest(right, depth - 1));
}

bool Ordering::terms_of(const Words& vector, Words& left, Words& right) const {
  for (const uint32_t component : vector) {
    const Operation& o = pool_[component];
    const bool adds = o.kind == Kind::op && (o.op == Opcode::fadd || o.op == Opcode::fsub);
    if (!adds || o.op != pool_[vector[0]].op) return false;
    left.push_back(pool_.operands(component)[0]);
    right.push_back(pool_.operands(component)[1]);
  }
  return true;
}

void Ordering::add_facts(uint32_t old) {
  const Operation& operation = pool_[old];
  if (operation.kind == Kind::dot) add_dot_fact(old);
  if (operation.kind == Kind::greatest) add_half(old);
  if (operation.kind == Kind::op && operation.op == Opcode::fadd) {
    add_projection(old);
    add_rotation(old);
  }
}

void Ordering::add_dot_fact(uint32_t old) {
  const auto operands = pool_.operands(old);
  const auto half = operands.size() / 2;
  const Words a(operands.begin(), operands.begin() + half), b(operands.begin() + half, operands.end());
  Fact fact{Fact::Kind::dot};
  fact.left = shape_of(a, old);
  fact.right = a == b ? fact.left : shape_of(b, old);
  if (a != b) {
    fact.first = before(find_dot(a, a), old);
    fact.second = before(find_dot(b, b), old);
  }
  pool_.tape().facts[at_[old]].push_back(fact);
}

/// The shape of a vector as the operation `user` sees it.
uint32_t Ordering::shape_of(const Words& vector, uint32_t user, int depth) {
  VectorShape shape;
  shape.length = longest(vector);
  for (const uint32_t component : vector) shape.components.push_back(at_[component]);
  const uint32_t square = find_dot(vector, vector);
  if (square != user) shape.square = before(square, user);
  const auto set = [&](VectorShape::Kind kind, const Words& left, const Words& right) {
    shape.kind = kind;
    shape.left = shape_of(left, user, depth - 1);
    shape.right = shape_of(right, user, depth - 1);
  };
  Words left, right;
  if (depth > 0 && terms_of(vector, left, right)) set(VectorShape::Kind::sum, left, right);
  if (const auto cross = pool_.crosses.find(vector); depth > 0 && cross != pool_.crosses.end())
    set(VectorShape::Kind::cross, cross->second.left, cross->second.right);
  pool_.tape().vectors.push_back(std::move(shape));
  return static_cast<uint32_t>(pool_.tape().vectors.size() - 1);
}

/// n . l + n . v, where n . (l + v) is there too.
void Ordering::add_projection(uint32_t old) {
  const auto summands = pool_.operands(old);
  if (pool_[summands[0]].kind != Kind::dot || pool_[summands[1]].kind != Kind::dot) return;
  const auto left = pool_.operands(summands[0]), right = pool_.operands(summands[1]);
  const auto half = left.size() / 2;
  if (left.size() != right.size() || !std::equal(left.begin(), left.begin() + half, right.begin())) return;
  Words sum;
  for (size_t i = half; i < left.size(); ++i) {
    const Operation add{.kind = Kind::op, .op = Opcode::fadd};
    sum.push_back(pool_.find(add, std::array{left[i], right[i]}));
    if (sum.back() == none) return;
  }
  // |n . (l + v)| <= |l + v| if n is a unit vector.
  const uint32_t square = before(find_dot(sum, sum), old);
  const Words normal(left.begin(), left.begin() + half);
  const bool units = pool_.at_most_units.contains(normal) &&
                     pool_.at_most_units.contains(Words(left.begin() + half, left.end())) &&
                     pool_.at_most_units.contains(Words(right.begin() + half, right.end()));
  if (square != none && units) pool_.tape().facts[at_[old]].push_back({Fact::Kind::projection, square});
}

/// dot(u x w, u x w) + (r dot(u, w))^2, where dot(w, w) is there too and u is a unit vector.
void Ordering::add_rotation(uint32_t old) {
  const auto summands = pool_.operands(old);
  const Operation& squared = pool_[summands[1]];
  if (pool_[summands[0]].kind != Kind::dot || squared.kind != Kind::op || squared.op != Opcode::fmul) return;
  const auto sine = pool_.operands(summands[0]);
  const auto factors = pool_.operands(summands[1]);
  if (sine.size() != 6 || !std::equal(sine.begin(), sine.begin() + 3, sine.begin() + 3)) return;
  if (factors[0] != factors[1] || pool_[factors[0]].kind != Kind::op || pool_[factors[0]].op != Opcode::fmul)
    return;
  const auto cross = pool_.crosses.find(Words(sine.begin(), sine.begin() + 3));
  if (cross == pool_.crosses.end()) return;
  const Words& axis = cross->second.left;
  const uint32_t not_zero = pool_.units.contains(axis) ? none : known_product(axis, guard_of_[old]);
  if (!pool_.units.contains(axis) && (!pool_.at_most_units.contains(axis) || not_zero == none)) return;
  const uint32_t cosine = find_dot(cross->second.left, cross->second.right);
  const auto scaled = pool_.operands(factors[0]);
  for (const int i : {0, 1}) {
    if (scaled[i] != cosine) continue;
    const uint32_t square = before(find_dot(cross->second.right, cross->second.right), old);
    const uint32_t factor = before(scaled[1 - i], old);
    if (square != none && factor != none)
      pool_.tape().facts[at_[old]].push_back({Fact::Kind::rotation, square, factor, not_zero});
    return;
  }
}

uint32_t Ordering::known_product(const Words& vector, uint32_t guard) const {
  for (uint32_t g = guard; g != 0; g = guards_[g].parent) {
    for (const auto& [old, at] : guards_[g].narrowed) {
      const auto operands = pool_.operands(old);
      if (pool_[old].kind != Kind::dot) continue;
      if (std::equal(vector.begin(), vector.end(), operands.begin()) ||
          std::equal(vector.begin(), vector.end(), operands.begin() + vector.size()))
        return at;
    }
  }
  return none;
}

void Ordering::add_half(uint32_t old) {
  const auto operands = pool_.operands(old);
  const Operation add{.kind = Kind::op, .op = Opcode::fadd};
  const uint32_t sum = before(pool_.find(add, operands), old);
  if (sum != none) pool_.tape().facts[at_[old]].push_back({Fact::Kind::half, sum});
}

void Ordering::run() {
  Tape& tape = pool_.tape();
  visited_.resize(tape.operations.size());
  for (const Tape::Output& output : tape.outputs) visit_from(output.operation);
  find_guards();
  at_.assign(tape.operations.size(), none);
  // The sides of a select have guards even if no operation is needed only there: the operands are narrowed all the
  // same.
  tape.guards.assign(guards_.size(), {});
  for (const uint32_t old : order_) emit(old);
  for (Tape::Output& output : tape.outputs) output.operation = at_[output.operation];
  tape.operations = std::move(operations_);
  tape.operands = std::move(operands_);
}

}  // namespace

void put_in_order(Pool& pool) { Ordering(pool).run(); }

}  // namespace isoshade::prove
