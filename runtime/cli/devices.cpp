// SPDX-License-Identifier: Apache-2.0
// isoshade devices: lists the Vulkan devices and whether each passes the probe.
#include <cstdio>

#include "runtime/cli/session.h"
#ifdef ISOSHADE_VULKAN
#include "backends/vulkan/backend.h"
#endif

namespace isoshade::cli {

#ifdef ISOSHADE_VULKAN
namespace {

bool print_device(const vulkan::DeviceInfo& device, bool probe_anew, support::Diagnostics& diagnostics) {
  std::printf("%d  %s\n   driver %s, Vulkan %s%s\n", device.index, device.name.c_str(), device.driver.c_str(),
              device.api.c_str(), device.cpu ? ", software" : "");
  vulkan::VulkanOptions options;
  options.device = std::to_string(device.index);
  options.allow_unproven = true;
  options.probe_anew = probe_anew;
  const auto backend = vulkan::create(options, diagnostics);
  if (backend == nullptr) return false;
  std::printf("   probe %s\n", backend->probe().cached ? "passed before; its result is cached (--probe runs it again)" : "run now");
  for (const vulkan::Check& check : backend->probe().checks)
    std::printf("   %s  %s%s%s\n", check.passed ? "ok    " : "FAILED", check.name.c_str(),
                check.detail.empty() ? "" : ": ", check.detail.c_str());
  std::printf("   division: %s; %s\n", std::string(driver::name(backend->division())).c_str(),
              backend->probe().passed() ? "images are identical to those of every proven device"
                                        : "NOT proven: images may differ from those of other devices");
  return true;
}

}  // namespace
#endif

int devices([[maybe_unused]] const DevicesArguments& arguments, [[maybe_unused]] const Common& common) {
  support::Diagnostics diagnostics = make_diagnostics(common);
#ifdef ISOSHADE_VULKAN
  bool any = false;
  for (const vulkan::DeviceInfo& device : vulkan::list_devices(diagnostics)) {
    const std::string& wanted = arguments.choice.device;
    if (!wanted.empty() && !vulkan::matches(device, wanted)) continue;
    any = true;
    if (!print_device(device, arguments.probe, diagnostics)) break;
  }
  if (!any && !diagnostics.has_errors())
    diagnostics.report(support::Id::no_device, "no Vulkan device has that name or number")
        .suggest("`isoshade devices` lists all devices");
#else
  diagnostics.report(support::Id::no_device, "this isoshade was built without Vulkan");
#endif
  return flush(diagnostics, common) ? failure : success;
}

}  // namespace isoshade::cli
