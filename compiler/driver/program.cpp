// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/program.h"

#include "compiler/ir/expansion.h"
#include "compiler/passes/passes.h"
#include "compiler/passes/pipeline.h"
#include "compiler/support/visible.h"
#include "compiler/targets/cpp/cpp.h"
#include "compiler/targets/cpp/stages.h"
#include "compiler/targets/glsl/stages.h"

namespace isoshade::driver {

namespace {

std::string glsl_of(const Program& program, Division division, glsl::EvalIn eval_in) {
  const emit::Heading heading{program.document, program.name};
  if (division == Division::native)
    return glsl::stage(program.module, program.entry, program.stage, heading, eval_in);
  ir::Module module = program.module;
  passes::Entries entries{program.entry};
  passes::run(passes::division_lowering(), module, entries, program.tier);
  return glsl::stage(module, entries[0], program.stage, heading, eval_in);
}

}  // namespace

std::string description(const Program& program) {
  return "the " + std::string(lower::name(program.stage)) + " stage of " + support::quote(program.name) +
         (program.document.empty() ? "" : " (" + support::visible(program.document) + ")");
}

std::string glsl(const Program& program, Division division) {
  return glsl_of(program, division, glsl::EvalIn::fragment_shader);
}

std::string glsl_with_vertex_eval(const Program& program, Division division) {
  return glsl_of(program, division, glsl::EvalIn::vertex_shader);
}

std::string cpp(const Program& program) {
  const emit::Heading heading{program.document, program.name};
  if (ir::expanded_operations(program.module, program.entry)[program.entry] <= cpp::large_program)
    return cpp::stage(program.module, program.entry, program.stage, heading);
  ir::Module module = program.module;
  passes::cut_long(module, cpp::longest_in_large);
  return cpp::stage(module, program.entry, program.stage, heading);
}

}  // namespace isoshade::driver
