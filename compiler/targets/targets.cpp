// SPDX-License-Identifier: Apache-2.0
#include "compiler/targets/targets.h"

#include <array>

#include "compiler/targets/cpp/cpp.h"
#include "compiler/targets/glsl/glsl.h"
#include "compiler/targets/glsl_es/glsl_es.h"

namespace isoshade::targets {

using emit::Target;

std::span<const Target* const> all() {
  static const std::array<const Target*, emit::target_count> table{
#define TARGET(name) &name::target(),
#include "compiler/targets/targets.def"
  };
  return table;
}

const Target& get(emit::TargetId id) { return *all()[static_cast<size_t>(id)]; }

const Target* find(std::string_view name) {
  for (const Target* target : all())
    if (target->name == name) return target;
  return nullptr;
}

const Target* find_binary(std::string_view name) {
  for (const Target* target : all())
    if (target->binary != nullptr && target->binary->name == name) return target;
  return nullptr;
}

}  // namespace isoshade::targets
