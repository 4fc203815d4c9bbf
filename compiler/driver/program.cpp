// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/program.h"

#include "compiler/emit/stages.h"
#include "compiler/passes/pipeline.h"

namespace isoshade::driver {

std::string glsl(const Program& program, Division division) {
  const emit::Heading heading{program.document, program.name};
  if (division == Division::native)
    return emit::glsl_stage(program.module, program.entry, program.stage, heading);
  ir::Module module = program.module;
  passes::Entries entries{program.entry};
  passes::run(passes::division_lowering(), module, entries);
  return emit::glsl_stage(module, entries[0], program.stage, heading);
}

std::string cpp(const Program& program) {
  return emit::cpp_stage(program.module, program.entry, program.stage, {program.document, program.name});
}

}  // namespace isoshade::driver
