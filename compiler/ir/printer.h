// SPDX-License-Identifier: Apache-2.0
// Text IR, one instruction a line. parser.h reads it back.
//
//     buffer positions: float
//
//     func @ggx_d(%alpha: float uniform, %surface.normal: vec3) -> (out: float) from "graphs/ggx_d.json" {
//       %a = fmul %n_dot_h, %alpha  ; a:12
//       %3: bool = flt %a, %alpha
//       %out = branch %3 {  ; out:14
//         %5 = constant float 0x3f800000  # 1
//         yield %5
//       } else {
//         yield %a
//       }
//       %sum: vec3 = loop %i < %count, %7: vec3 = %black {
//         %9: vec3 = call @light(%i)
//         %10: vec3 = fadd %7, %9
//         yield %10
//       }
//       return %out
//     }
//
//     func @exp2(%x: float) -> (out: float) library "exp2"
//
// A value without a type is a float. `; node:line` is the instruction's origin. A value with a node's name is
// that node's result: the node of the instruction's origin, or, written `%name:line`, another one. Numbers
// count the values in the order of the text; a name met twice gets its number as a suffix. `#` starts a
// comment.
#pragma once

#include <string>

#include "compiler/ir/module.h"

namespace isoshade::ir {

/// Needs a module whose indices are in range, as in all that the builder and the passes leave.
std::string print(const Module& module);
std::string print(const Module& module, const Function& function);
/// The line of one instruction, blocks left out.
std::string print_instruction(const Module& module, const Function& function, InstructionId instruction);

}  // namespace isoshade::ir
