// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/program.h"

#include <optional>

#include "compiler/driver/shader.h"
#include "compiler/ir/expansion.h"
#include "compiler/passes/passes.h"
#include "compiler/passes/pipeline.h"
#include "compiler/support/visible.h"
#include "compiler/targets/cpp/cpp.h"
#include "compiler/targets/glsl/glsl.h"
#include "compiler/targets/glsl/stages.h"

namespace isoshade::driver {

namespace {

/// A program without ops that the language lacks, and with functions that its compilers can take. Refers to the program,
/// whose module it copies only where it must change it.
class Prepared {
 public:
  Prepared(const Program& program, const emit::Target& target, Division division)
      : program_(program), entries_{program.entry} {
    if (division == Division::exact && !target.rounds_division)
      passes::run(passes::division_lowering(), changed(), entries_, program.tier);
    if (!emit::has_op(target.id, ir::Opcode::imulhi))
      passes::run(passes::multiplication_lowering(), changed(), entries_, program.tier);
    if (target.keeps_calls && ir::expanded_operations(module(), entry())[entry()] > cpp::large_program)
      passes::cut_long(changed(), cpp::longest_in_large);
  }

  const ir::Module& module() const { return changed_ ? *changed_ : program_.module; }
  uint32_t entry() const { return entries_[0]; }

 private:
  ir::Module& changed() { return changed_ ? *changed_ : changed_.emplace(program_.module); }

  const Program& program_;
  passes::Entries entries_;
  std::optional<ir::Module> changed_;
};

emit::Heading heading_of(const Program& program) { return {program.document, program.name}; }

}  // namespace

std::string text(const Program& program, const emit::Target& target, Division division) {
  const Prepared made(program, target, division);
  return target.kernel(made.module(), made.entry(), program.stage, heading_of(program));
}

std::string description(const Program& program) {
  return "the " + std::string(lower::name(program.stage)) + " stage of " + support::quote(program.name) +
         (program.document.empty() ? "" : " (" + support::visible(program.document) + ")");
}

std::string glsl(const Program& program, Division division) { return text(program, glsl::target(), division); }

namespace {

std::string glsl_of(const Program& program, Division division, glsl::Variant variant) {
  const Prepared made(program, glsl::target(), division);
  return glsl::stage(made.module(), made.entry(), program.stage, heading_of(program), variant);
}

}  // namespace

std::string glsl_with_vertex_eval(const Program& program, Division division) {
  return glsl_of(program, division, glsl::Variant::vertex_eval);
}

std::string glsl_of_compute(const Program& program, Division division) {
  return glsl_of(program, division, glsl::Variant::compute);
}

std::string glsl_of_layer(const Program& program, Division division) {
  return glsl_of(program, division, glsl::Variant::layer);
}

std::string cpp(const Program& program) { return text(program, cpp::target(), Division::native); }

}  // namespace isoshade::driver
