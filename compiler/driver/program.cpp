// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/program.h"

#include "compiler/emit/cpp.h"
#include "compiler/emit/stages.h"
#include "compiler/ir/expansion.h"
#include "compiler/passes/passes.h"
#include "compiler/passes/pipeline.h"
#include "compiler/support/visible.h"

namespace isoshade::driver {

namespace {

std::string glsl_of(const Program& program, Division division, emit::EvalIn eval_in) {
  const emit::Heading heading{program.document, program.name};
  if (division == Division::native)
    return emit::glsl_stage(program.module, program.entry, program.stage, heading, eval_in);
  ir::Module module = program.module;
  passes::Entries entries{program.entry};
  passes::run(passes::division_lowering(), module, entries, program.tier);
  return emit::glsl_stage(module, entries[0], program.stage, heading, eval_in);
}

}  // namespace

std::string description(const Program& program) {
  return "the " + std::string(lower::name(program.stage)) + " stage of " + support::quote(program.name) +
         (program.document.empty() ? "" : " (" + support::visible(program.document) + ")");
}

std::string glsl(const Program& program, Division division) {
  return glsl_of(program, division, emit::EvalIn::fragment_shader);
}

std::string glsl_with_vertex_eval(const Program& program, Division division) {
  return glsl_of(program, division, emit::EvalIn::vertex_shader);
}

std::string cpp(const Program& program) {
  const emit::Heading heading{program.document, program.name};
  if (ir::expanded_operations(program.module, program.entry)[program.entry] <= emit::large_program)
    return emit::cpp_stage(program.module, program.entry, program.stage, heading);
  ir::Module module = program.module;
  passes::cut_long(module, emit::longest_in_large);
  return emit::cpp_stage(module, program.entry, program.stage, heading);
}

}  // namespace isoshade::driver
