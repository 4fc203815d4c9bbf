// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/program.h"

#include "compiler/emit/stages.h"
#include "compiler/passes/exact_division.h"
#include "compiler/passes/pipeline.h"

namespace isoshade::driver {

std::string glsl(const Program& program, Division division) {
  const emit::Heading heading{program.document, program.name};
  if (division == Division::native) return emit::glsl_stage(program.module, program.entry, program.stage, heading);
  ir::Module module = program.module;
  passes::exact_division(module);
  const uint32_t entry = passes::finish(module, program.entry);
  return emit::glsl_stage(module, entry, program.stage, heading);
}

std::string cpp(const Program& program) {
  return emit::cpp_stage(program.module, program.entry, program.stage, {program.document, program.name});
}

}  // namespace isoshade::driver
