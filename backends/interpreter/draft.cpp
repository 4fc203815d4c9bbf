// SPDX-License-Identifier: Apache-2.0
#include "backends/interpreter/draft.h"

#include <algorithm>
#include <utility>

namespace isoshade::interpreter {
namespace {

/// Passes give up on values whose definition and use are farther apart, so that they take linear time.
constexpr uint32_t farthest_copy = 2000, farthest_fusion = 32;

/// Something for each place.
template <class T>
class ByPlace {
 public:
  ByPlace(const Draft& draft, T value)
      : of_{{{}, std::vector<T>(draft.scalars.size(), value), std::vector<T>(draft.words, value),
             std::vector<T>(draft.masks, value)}} {}
  T& operator[](Place place) { return of_[static_cast<size_t>(place.pool)][place.index]; }
  std::vector<T>& all(Pool pool) { return of_[static_cast<size_t>(pool)]; }

 private:
  std::array<std::vector<T>, 4> of_;
};

template <class Use>
void for_each_operand(const DraftStep& step, const Use& use) {
  for (const Place place : {step.a, step.b, step.c})
    if (place.pool != Pool::none) use(place);
}

/// Sets `target` and `end` of steps, and the ranges of loops.
template <class Map>
void move_targets(Draft& draft, const Map& map) {
  for (DraftStep& step : draft.steps) {
    step.target = map(step.target);
    step.end = map(step.end);
  }
  for (DraftLoop& loop : draft.loops) {
    loop.begin = map(loop.begin);
    loop.end = map(loop.end);
  }
}

class Simplifier {
 public:
  explicit Simplifier(Draft& draft)
      : draft_(draft), steps_(draft.steps), uses_(draft, 0), definitions_(draft, 0), definition_(draft, 0) {
    for (uint32_t i = 0; i < steps_.size(); ++i) {
      const DraftStep& step = steps_[i];
      if (step.dead) continue;
      for_each_operand(step, [&](Place place) { ++uses_[place]; });
      if (step.to.pool == Pool::none) continue;
      ++definitions_[step.to];
      definition_[step.to] = i;
    }
    for (const Place result : draft.results) ++uses_[result];
  }

  void run() {
    remove_unused();
    for (uint32_t i = 0; i < steps_.size(); ++i)
      if (!steps_[i].dead && steps_[i].shape.kind == Kind::copy) write_at_once(i);
    for (uint32_t i = 0; i < steps_.size(); ++i)
      if (!steps_[i].dead && is_plain(steps_[i])) fuse(i);
    compact();
  }

 private:
  void remove_unused() {
    for (size_t i = steps_.size(); i-- > 0;) {
      DraftStep& step = steps_[i];
      if (step.dead || step.to.pool == Pool::none || uses_[step.to] != 0) continue;
      step.dead = true;
      --definitions_[step.to];
      for_each_operand(step, [&](Place place) { --uses_[place]; });
    }
  }

  /// The step that defines what only `user` reads, if it runs as often and for the same groups; otherwise null.
  DraftStep* definition_for(Place place, uint32_t user, uint32_t farthest) {
    if (uses_[place] != 1 || definitions_[place] != 1) return nullptr;
    const uint32_t at = definition_[place];
    DraftStep& step = steps_[at];
    return at < user && user - at <= farthest && step.block == steps_[user].block ? &step : nullptr;
  }

  /// Lets the step that computes what is copied write it to where it is copied to.
  void write_at_once(uint32_t copy) {
    const Place from = steps_[copy].a, to = steps_[copy].to;
    if (from.pool != to.pool) return;
    DraftStep* const made = definition_for(from, copy, farthest_copy);
    if (made == nullptr) return;
    bool is_free = true;
    for (const DraftStep* step = made + 1; step != &steps_[copy]; ++step) {
      if (step->dead) continue;
      if (step->to == to) is_free = false;
      for_each_operand(*step, [&](Place place) { is_free &= place != to; });
    }
    if (!is_free) return;
    made->to = to;
    definition_[to] = definition_[from];
    uses_[from] = definitions_[from] = 0;
    steps_[copy].dead = true;
  }

  static bool is_plain(const DraftStep& step) {
    return step.shape.kind == Kind::primitive && step.to.pool == Pool::words;
  }

  void fuse(uint32_t outer) {
    DraftStep& step = steps_[outer];
    for (const bool first : {true, false}) {
      const Place operand = first ? step.a : step.b, other = first ? step.b : step.a;
      if (operand.pool != Pool::words) continue;
      DraftStep* const inner = definition_for(operand, outer, farthest_fusion);
      if (inner == nullptr || !is_plain(*inner) || !may_fuse(inner->shape.op, step.shape.op, first)) continue;
      bool unchanged = true;  // between the two steps
      for_each_operand(*inner, [&](Place place) { unchanged &= definitions_[place] <= 1; });
      if (!unchanged) continue;
      step.shape.kind = Kind::fused;
      step.shape.inner = inner->shape.op;
      step.shape.inner_first = first || commutes(step.shape.op);
      step.shape.uniform = (inner->shape.uniform & 3) | (other.pool == Pool::scalars ? 4u : 0u);
      step.a = inner->a;
      step.b = inner->b;
      step.c = other;
      inner->dead = true;
      uses_[operand] = definitions_[operand] = 0;
      return;
    }
  }

  void compact() {
    std::vector<uint32_t> to(steps_.size() + 1);
    uint32_t next = 0;
    for (size_t i = 0; i < steps_.size(); ++i) {
      to[i] = next;
      if (!steps_[i].dead) steps_[next++] = steps_[i];
    }
    to[steps_.size()] = next;
    steps_.resize(next);
    move_targets(draft_, [&](uint32_t old) { return to[old]; });
  }

  Draft& draft_;
  std::vector<DraftStep>& steps_;
  ByPlace<uint32_t> uses_, definitions_;
  ByPlace<uint32_t> definition_;  ///< the last one, if there is any
};

/// From the first step that writes a value to the last one that it must survive; `end` of what nothing reads is none.
struct Lifetime {
  uint32_t begin = ir::none, end = ir::none;
};

class Allocator {
 public:
  explicit Allocator(Draft& draft) : draft_(draft), lifetimes_(draft, {}) {}

  void run() {
    measure();
    number(Pool::words, draft_.words);
    number(Pool::masks, draft_.masks);
  }

 private:
  void measure() {
    for (const Place place : draft_.parameters)
      if (place.pool != Pool::none) lifetimes_[place].begin = 0;
    for (uint32_t i = 0; i < draft_.steps.size(); ++i) {
      const DraftStep& step = draft_.steps[i];
      for_each_operand(step, [&](Place place) { use(place, i, step.loop); });
      if (step.shape.kind == Kind::split) use(step.a, step.end, step.loop);
      if (step.to.pool == Pool::none) continue;
      Lifetime& lifetime = lifetimes_[step.to];
      lifetime.begin = std::min(lifetime.begin, i);
      use(step.to, i, step.loop);
    }
    for (const Place place : draft_.results) use(place, static_cast<uint32_t>(draft_.steps.size()), ir::none);
  }

  /// What is older than a loop that uses it must survive all of its turns.
  void use(Place place, uint32_t at, uint32_t loop) {
    Lifetime& lifetime = lifetimes_[place];
    for (; loop != ir::none && draft_.loops[loop].begin > lifetime.begin; loop = draft_.loops[loop].around)
      at = std::max(at, draft_.loops[loop].end);
    if (lifetime.end == ir::none || lifetime.end < at) lifetime.end = at;
  }

  /// Registers of a pool: those that were freed last are taken first, for they are in the nearest cache.
  void number(Pool pool, uint32_t& count) {
    const std::vector<Lifetime>& lifetimes = lifetimes_.all(pool);
    std::vector<std::vector<uint32_t>> ending(draft_.steps.size() + 1);
    for (uint32_t i = 0; i < lifetimes.size(); ++i)
      if (lifetimes[i].end != ir::none) ending[lifetimes[i].end].push_back(i);
    std::vector<uint32_t> register_of(lifetimes.size(), ir::none), free;
    uint32_t registers = 0;
    const auto take = [&](Place place) {
      if (place.pool != pool || register_of[place.index] != ir::none || lifetimes[place.index].end == ir::none) return;
      uint32_t& taken = register_of[place.index];
      if (free.empty()) {
        taken = registers++;
      } else {
        taken = free.back();
        free.pop_back();
      }
    };
    for (const Place place : draft_.parameters) take(place);
    for (size_t i = 0; i < draft_.steps.size(); ++i) {
      for (const uint32_t value : ending[i])
        if (register_of[value] != ir::none) free.push_back(register_of[value]);
      take(draft_.steps[i].to);
    }
    const auto rename = [&](Place& place) {
      if (place.pool != pool) return;
      place.index = register_of[place.index];
      if (place.index == ir::none) place = {};
    };
    for (DraftStep& step : draft_.steps)
      for (Place* const place : {&step.to, &step.a, &step.b, &step.c}) rename(*place);
    for (Place& place : draft_.parameters) rename(place);
    for (Place& place : draft_.results) rename(place);
    count = registers;
  }

  Draft& draft_;
  ByPlace<Lifetime> lifetimes_;
};

}  // namespace

void simplify(Draft& draft) { Simplifier(draft).run(); }

void assign_registers(Draft& draft) { Allocator(draft).run(); }

}  // namespace isoshade::interpreter
