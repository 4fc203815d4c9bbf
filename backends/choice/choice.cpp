// SPDX-License-Identifier: Apache-2.0
#include "backends/choice/choice.h"

#include <cstdlib>
#include <mutex>

#include "backends/cpu/backend.h"
#include "backends/interpreter/backend.h"
#include "backends/reference/backend.h"
#include "compiler/support/visible.h"
#ifdef ISOSHADE_VULKAN
#include "backends/vulkan/backend.h"
#endif

namespace isoshade::choice {
namespace {

std::unique_ptr<backends::Backend> create_cpu(const Options& options, support::Diagnostics& diagnostics) {
  cpu::CpuOptions cpu;
  cpu.lanes = options.lanes;
  cpu.threads = options.threads;
  cpu.execution = options.execution;
  cpu.compiler = options.compiler;
  cpu.cache = options.cache;
  cpu.build_timeout = options.build_timeout;
  return cpu::create(cpu, diagnostics);
}

std::unique_ptr<backends::Backend> create_vulkan(const Options& options, support::Diagnostics& diagnostics) {
#ifdef ISOSHADE_VULKAN
  static std::mutex one_at_a_time;  // loading and leaving the drivers
  const std::lock_guard lock(one_at_a_time);
  vulkan::VulkanOptions vulkan;
  vulkan.device = options.device;
  vulkan.cache = options.cache;
  if (!options.division.empty())
    vulkan.division = options.division == "exact" ? driver::Division::exact : driver::Division::native;
  return vulkan::create(vulkan, diagnostics);
#else
  (void)options;
  diagnostics.report(support::Id::no_device, "this isoshade was built without Vulkan")
      .suggest("build with -DISOSHADE_VULKAN=ON");
  return nullptr;
#endif
}

}  // namespace

std::unique_ptr<backends::Backend> create(const Options& options, support::Diagnostics& diagnostics) {
  if (options.name == "cpu") return create_cpu(options, diagnostics);
  if (options.name == "vulkan") return create_vulkan(options, diagnostics);
  if (options.name == "interpreter") return interpreter::create(options.threads);
  if (options.name == "reference") return reference::create();
  diagnostics
      .report(support::Id::unknown_choice, "there is no backend " + support::quote(options.name))
      .suggest("the backends are cpu, vulkan, interpreter and reference");
  return nullptr;
}

bool may_stand_in(const Options& options, const support::Diagnostics& diagnostics) {
  const bool no_compiler = diagnostics.all().size() == 1 && diagnostics.all()[0].id == support::Id::no_compiler;
  const char* named = std::getenv("ISOSHADE_CXX");
  return options.name == "cpu" && no_compiler && options.compiler.empty() &&
         (named == nullptr || *named == '\0');
}

}  // namespace isoshade::choice
