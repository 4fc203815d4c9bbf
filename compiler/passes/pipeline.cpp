// SPDX-License-Identifier: Apache-2.0
#include "compiler/passes/pipeline.h"

#include <string>

#include "compiler/functions/library.h"
#include "compiler/ir/printer.h"
#include "compiler/ir/validator.h"
#include "compiler/passes/passes.h"
#include "compiler/support/assert.h"

namespace isoshade::passes {

namespace {

using functions::Tier;
using interface::Skip;

void run_derivatives(ir::Module& m, Entries&, Tier) { derivatives(m); }
void run_renumber(ir::Module& m, Entries&, Tier) { renumber(m); }
void run_fold(ir::Module& m, Entries&, Tier tier) { fold(m, tier); }
void run_cse(ir::Module& m, Entries&, Tier) { cse(m); }
void run_expand(ir::Module& m, Entries&, Tier tier) { functions::expand(m, tier); }
void run_decide(ir::Module& m, Entries&, Tier tier) { decide(m, tier); }
void run_sink(ir::Module& m, Entries&, Tier) { sink(m); }
void run_specialize(ir::Module& m, Entries&, Tier) { specialize(m); }
void run_hoist(ir::Module& m, Entries& entries, Tier) {
  if (!entries.draw_rate) return;
  entries.draw_values = hoist(m, entries.functions[0], *entries.draw_rate);
}
void run_drop_unread(ir::Module& m, Entries& entries, Tier) { drop_unread(m, entries.functions); }
void run_dce(ir::Module& m, Entries& entries, Tier) { dce(m, entries.functions); }
void run_hide(ir::Module& m, Entries& entries, Tier) {
  hide_foldables(m, entries.are_linked ? std::span<const uint32_t>() : entries.functions);
}
void run_exact_division(ir::Module& m, Entries&, Tier) { exact_division(m); }
void run_multiply_by_halves(ir::Module& m, Entries&, Tier) { multiply_by_halves(m); }

constexpr ModulePass optimisation_table[] = {
    {"derivatives", run_derivatives,
     "no other pass knows of ddx and ddy; functions have rules while calls are calls"},
    {"renumber", run_renumber,
     "lowering leaves the order open; all after it sees one order and nothing dead"},
    {"fold", run_fold, "functions of constants are evaluated whole, while calls are calls"},
    {"cse", run_cse, "folding makes equal constants and operands"},
    {"renumber", run_renumber, "drops what fold and cse replaced, and the calls in it"},
    {"dce", run_dce, "no body is made for what nobody calls"},
    {"expand", run_expand, "all that reasons about functions has seen them"},
    {"decide", run_decide, "the bodies tell what ranges the ranges of their arguments make", Skip::ranges},
    {"fold", run_fold, "bodies are templates: they have constants to fold, and what was decided is constant"},
    {"sink", run_sink, "what can be folded would count as expensive", Skip::branches},
    {"fold", run_fold, "inside a branch its condition is known", Skip::branches},
    {"specialize", run_specialize, "only bodies can take constants in"},
    {"decide", run_decide, "constants make narrower ranges in the clones", Skip::ranges},
    {"fold", run_fold, "what was decided is constant", Skip::ranges},
    {"renumber", run_renumber, "drops what specialize has folded away"},
    {"hoist", run_hoist, "all that is known of a value is used; a value that is loaded has no range", Skip::rates},
    {"drop_unread", run_drop_unread, "constants leave parameters unread, and hiding would read them"},
    {"hide_foldables", run_hide, "after the last fold, which could bring the shapes back"},
    {"cse", run_cse, "bodies compute things twice, and hidden shapes share their bits"},
    {"renumber", run_renumber, "what is printed is in canonical order"},
    {"dce", run_dce, "no function that folding made useless, callees before callers"},
};

constexpr ModulePass division_table[] = {
    {"exact_division", run_exact_division, "calls instead of the two ops"},
    {"expand", run_expand, "the called functions"},
    {"fold", run_fold,
     "their constants; folding cannot have a division of constants left, so none is hidden again"},
    {"specialize", run_specialize, "1 / x calls with a constant"},
    {"hide_foldables", run_hide, "shapes in the new bodies"},
    {"cse", run_cse, "the new bodies compute things twice"},
    {"renumber", run_renumber, "canonical order"},
    {"dce", run_dce, "callees before callers"},
};

constexpr ModulePass multiplication_table[] = {
    {"multiply_by_halves", run_multiply_by_halves, "calls instead of the two ops"},
    {"renumber", run_renumber, "canonical order"},
    {"dce", run_dce, "callees before callers"},
};

#ifdef NDEBUG
constexpr bool always_check = false;
#else
constexpr bool always_check = true;
#endif

}  // namespace

std::span<const ModulePass> optimisations() { return optimisation_table; }
std::span<const ModulePass> division_lowering() { return division_table; }
std::span<const ModulePass> multiplication_lowering() { return multiplication_table; }

void run(std::span<const ModulePass> passes, ir::Module& module, Entries& entries, Tier tier, const Dump& dump,
         bool check, const interface::Skips& skips) {
  for (const ModulePass& pass : passes) {
    if (pass.skip && !skips.has(*pass.skip)) continue;
    pass.run(module, entries, tier);
    if (dump) dump(pass.name, module);
    if (!check && !always_check) continue;
    if (const std::string breach = ir::validate(module); !breach.empty())
      support::bug(std::string(pass.name) + " left an invalid module: " + breach);
  }
}

}  // namespace isoshade::passes
