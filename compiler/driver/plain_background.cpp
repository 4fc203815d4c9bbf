// SPDX-License-Identifier: Apache-2.0
#include "compiler/driver/plain_background.h"

#include "compiler/driver/fixed.h"
#include "compiler/lower/screen.h"
#include "compiler/passes/passes.h"

namespace isoshade::driver {
namespace {

/// Lets every read of the depth find no surface.
void show_no_surface(ir::Module& module, uint32_t depth) {
  for (ir::Function& f : module.functions)
    for (ir::Instruction& made : f.instructions)
      if (made.op == ir::Opcode::call && made.imm == depth) {
        made.op = ir::Opcode::constant;
        made.imm = 0;
        made.operand_count = 0;
      }
}

}  // namespace

bool keeps_background_plain(const lower::Lowered& post, functions::Tier tier) {
  lower::Lowered plain = post;
  show_no_surface(plain.module, plain.interface.find(interface::Host::depth, lower::depth_image));
  passes::fold(plain.module, tier);
  passes::renumber(plain.module);  // drops what nothing needs now
  drop_unread(plain.module.functions[plain.interface.entry], plain.interface);
  return lower::ignores_place(plain);
}

}  // namespace isoshade::driver
