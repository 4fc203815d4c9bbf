// SPDX-License-Identifier: Apache-2.0
#include "runtime/bench/backends.h"

#include "backends/cpu/backend.h"
#include "backends/cpu/lane_count.h"
#include "compiler/support/assert.h"
#ifdef ISOSHADE_VULKAN
#include "backends/vulkan/backend.h"
#endif

namespace isoshade::bench {

namespace {

using support::Diagnostics;

/// Wraps `make` so that it is called once for each program and its result is reused.
template <class Make>
auto cached(Make make) {
  auto known = std::make_shared<std::map<const driver::Program*, std::string>>();
  return [known, make](const driver::Program& program, auto... rest) {
    const auto [found, is_new] = known->try_emplace(&program);
    if (is_new) found->second = make(program, rest...);
    return found->second;
  };
}

bool add_cpu(const BenchOptions& options, std::vector<Contestant>& all, Diagnostics& diagnostics) {
  std::vector<std::string> lanes = options.lanes;
  if (lanes.empty())
    for (const cpu::LaneCount& count : cpu::lane_counts())
      if (count.available()) lanes.emplace_back(count.name);
  for (const std::string& count : lanes) {
    cpu::CpuOptions cpu;
    cpu.lanes = count;
    cpu.threads = options.threads;
    cpu.compiler = options.compiler;
    cpu.build_timeout = options.build_timeout;
    cpu.cpp = cached([](const driver::Program& program) { return driver::cpp(program); });
    auto device = cpu::create(cpu, diagnostics);
    if (device == nullptr) return false;
    all.push_back({"cpu", count, false, std::move(device)});
  }
  return true;
}

#ifdef ISOSHADE_VULKAN
bool add_vulkan(const BenchOptions& options, const BuiltIns* built_ins, std::vector<Contestant>& all,
                Diagnostics& diagnostics) {
  vulkan::VulkanOptions vulkan;
  vulkan.device = options.device;
  vulkan.glsl = cached([built_ins](const driver::Program& program, driver::Division division) {
    if (built_ins == nullptr) return driver::glsl(program, division);
    const auto found = built_ins->find(&program);
    // The built-ins are compared with native division.
    std::string text = driver::glsl(program, driver::Division::native);
    return found != built_ins->end() ? with_built_ins(std::move(text), found->second) : text;
  });
  auto device = vulkan::create(vulkan, diagnostics);
  if (device == nullptr) return false;
  all.push_back({"vulkan", "", built_ins != nullptr, std::move(device)});
  return true;
}
#endif

/// The type, the name and the type of the first parameter of a definition: "vec3 f(vec3". That tells overloads apart.
std::string_view signature_of(std::string_view head) {
  const size_t open = head.find('(');
  return open == head.npos ? std::string_view() : head.substr(0, head.find(' ', open));
}

void erase_all(std::string& text, std::string_view what) {
  for (size_t at = 0; (at = text.find(what, at)) != std::string::npos;) text.erase(at, what.size());
}

}  // namespace

std::string with_built_ins(std::string glsl, const std::string& definitions) {
  erase_all(glsl, "precise ");
  constexpr std::string_view close = "\n}\n";
  for (size_t at = 0; at < definitions.size();) {
    const size_t end = definitions.find(close, at) + close.size();
    support::assert_that(end >= close.size(), "a definition does not end");
    std::string definition = definitions.substr(at, end - at);
    at = end;
    const size_t line = definition.rfind('\n', definition.find(" {\n"));
    const size_t start = line == std::string::npos ? 0 : line + 1;
    const std::string_view head =
        std::string_view(definition).substr(start, definition.find(" {\n", start) + 2 - start);
    const std::string_view signature = signature_of(head);
    support::assert_that(!signature.empty(), definition);
    const size_t line_end = glsl.find("\n" + std::string(signature) + " ");
    if (line_end == std::string::npos) continue;  // this tier does not call it
    const size_t begin = line_end + 1;
    const size_t line_close = glsl.find('\n', begin);
    // "float f(float a) { return a; }"
    const bool is_line = std::string_view(glsl).substr(begin, line_close - begin).find(" { return ") != glsl.npos;
    const size_t after = is_line ? line_close + 1 : glsl.find(close, begin) + close.size();
    glsl.replace(begin, after - begin, definition);
  }
  return glsl;
}

std::vector<Contestant> contestants(const BenchOptions& options, [[maybe_unused]] const BuiltIns& built_ins,
                                    Diagnostics& diagnostics) {
  std::vector<Contestant> all;
  bool good = add_cpu(options, all, diagnostics);
#ifdef ISOSHADE_VULKAN
  if (options.vulkan)
    good = good && add_vulkan(options, nullptr, all, diagnostics) &&
           add_vulkan(options, &built_ins, all, diagnostics);
#endif
  if (!good) all.clear();
  return all;
}

}  // namespace isoshade::bench
