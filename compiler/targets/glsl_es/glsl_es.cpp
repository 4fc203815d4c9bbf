// SPDX-License-Identifier: Apache-2.0
#include "compiler/targets/glsl_es/glsl_es.h"

#include "compiler/targets/glsl/glsl.h"

namespace isoshade::glsl_es {

using namespace emit;

namespace {

constexpr glsl::Dialect dialect{TargetId::glsl_es, false};

constexpr Target es_target{
    .id = TargetId::glsl_es,
    .name = "glsl-es",
    .doc = "GLSL ES 3.00 for WebGL 2.0, outside the contract",
    .extension = ".es.glsl",
    .head =
        "// GLSL ES 3.00, for WebGL 2.0. It has no `precise`: compilers may contract a * b + c and reorder sums, and devices may\n"
        "// round and flush in their own ways. So its results are close to those of the GLSL and C++, but not the same bits.\n"
        "precision highp float;\n"
        "precision highp int;\n",
    .has_precise = dialect.has_precise,
    .has_storage_buffers = false,
    .keeps_calls = false,
    .rounds_division = false,
    .language = [](const ir::Module&, uint32_t) { return glsl::language(dialect); },
    .kernel = nullptr,
    .kernel_extension = nullptr,
    .binary = nullptr,
    .pure = [](const PureShader& shader) { return glsl::pure(shader, dialect, target().head); },
    .forward = [](const ForwardProgram& program) { return glsl::forward(program, dialect); },
    .forward_infix = ".es",
};

}  // namespace

const Target& target() { return es_target; }

}  // namespace isoshade::glsl_es
