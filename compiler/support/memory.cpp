// SPDX-License-Identifier: Apache-2.0
#include "compiler/support/memory.h"

#include <algorithm>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <string_view>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

namespace isoshade::support {
namespace {

constexpr uint64_t no_limit = std::numeric_limits<uint64_t>::max();

/// MemAvailable + SwapFree of the machine, in bytes.
uint64_t free_on_machine() {
  std::ifstream file("/proc/meminfo");
  std::optional<uint64_t> memory;
  uint64_t swap = 0, kilobytes = 0;
  std::string name, unit;
  while (file >> name >> kilobytes) {
    if (name == "MemAvailable:") memory = kilobytes;
    if (name == "SwapFree:") swap = kilobytes;
    std::getline(file, unit);
  }
  return memory ? (*memory + swap) * 1024 : no_limit;
}

/// The number in a control group file; no limit for "max" or a missing file.
uint64_t number_in(const std::string& path) {
  uint64_t number = no_limit;
  std::ifstream file(path);
  return file >> number ? number : no_limit;
}

/// The memory limit of the process's control group and its ancestors; reads both cgroup versions.
uint64_t limit_of_group() {
  const std::string root = "/sys/fs/cgroup";
  uint64_t limit =
      std::min(number_in(root + "/memory.max"), number_in(root + "/memory/memory.limit_in_bytes"));
  std::ifstream groups("/proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    if (!line.starts_with("0::/")) continue;
    for (std::string group = line.substr(3); group.size() > 1; group.resize(group.rfind('/')))
      limit = std::min(limit, number_in(root + group + "/memory.max"));
  }
  return limit;
}

/// What is left of a resource limit of which this process already uses `pages`.
uint64_t left_of(int resource, uint64_t pages) {
  rlimit limit{};
  if (getrlimit(static_cast<__rlimit_resource>(resource), &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
    return no_limit;
  const uint64_t used = pages * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
  return limit.rlim_cur > used ? limit.rlim_cur - used : 0;
}

/// What is left of this process's limits on address space and data. Async-signal-safe: allocates nothing.
uint64_t left_of_limits() {
  // Fields of statm, in pages: total, resident, shared, text, libraries, data.
  uint64_t pages[6] = {};
  char text[256];
  const int file = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  const ssize_t size = file < 0 ? 0 : read(file, text, sizeof text);
  if (file >= 0) close(file);
  size_t field = 0;
  for (ssize_t i = 0; i < size && field < std::size(pages); ++i) {
    if (text[i] >= '0' && text[i] <= '9')
      pages[field] = 10 * pages[field] + static_cast<uint64_t>(text[i] - '0');
    else
      ++field;
  }
  return std::min(left_of(RLIMIT_AS, pages[0]), left_of(RLIMIT_DATA, pages[5]));
}

}  // namespace

uint64_t available_memory() { return std::min({free_on_machine(), limit_of_group(), left_of_limits()}); }

bool is_memory_exhausted() {
  constexpr uint64_t few = uint64_t{128} << 20;  // drivers allocate blocks of about this size
  return left_of_limits() < few;
}

std::string memory_text(uint64_t bytes) {
  const uint64_t tenths = bytes / (uint64_t{1} << 20) * 10 / 1024;
  if (tenths < 10) return std::to_string(bytes >> 20) + " MiB";
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " GiB";
}

bool check_memory(uint64_t bytes, const std::string& what, const std::string& fix, Diagnostics& diagnostics) {
  const uint64_t available = available_memory();
  if (bytes <= available) return true;
  diagnostics
      .report(Id::device_limit, what + " needs " + memory_text(bytes) + " of memory, but only " +
                                    memory_text(available) + " are available")
      .suggest(fix);
  return false;
}

void use_huge_pages(void* begin, size_t bytes) {
  constexpr uintptr_t page = uintptr_t{1} << 21;
  const auto address = reinterpret_cast<uintptr_t>(begin);
  const uintptr_t first = (address + page - 1) / page * page, end = (address + bytes) / page * page;
  // Only a wish: where the system does not grant it, memory comes in small pages.
  if (end > first) madvise(reinterpret_cast<void*>(first), end - first, MADV_HUGEPAGE);
}

}  // namespace isoshade::support
