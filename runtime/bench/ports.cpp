// SPDX-License-Identifier: Apache-2.0
#include "runtime/bench/ports.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>
#include <sys/stat.h>
#include <vector>

#include "backends/cache.h"
#include "compiler/support/process.h"
#include "runtime/render/clock.h"

namespace isoshade::bench {

namespace {

constexpr int iterations = 100;

std::vector<std::string> lines_of(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const size_t end = std::min(text.find('\n'), text.size());
    lines.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

/// Nothing if it cannot be read.
std::optional<std::string> bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(file), {});
}

bool is_instruction(std::string_view line) { return line.size() > 1 && line[0] == '\t' && line[1] != '.'; }

/// Lines [first, last] of a loop: its label and the jump back to it.
struct Loop {
  size_t first, last;
  size_t instructions;
};

/// The longest of the loops without another one inside.
std::optional<Loop> hot_loop(const std::vector<std::string>& lines) {
  std::map<std::string, size_t> labels;
  std::vector<Loop> loops;
  for (size_t i = 0; i < lines.size(); ++i) {
    const std::string& line = lines[i];
    if (line.starts_with(".L") && line.ends_with(":")) labels[line.substr(0, line.size() - 1)] = i;
    if (!line.starts_with("\tj")) continue;
    const auto target = labels.find(line.substr(line.find_last_of(" \t") + 1));
    if (target == labels.end()) continue;  // forwards
    const auto body = std::span(lines).subspan(target->second, i - target->second + 1);
    loops.push_back({target->second, i, static_cast<size_t>(std::ranges::count_if(body, is_instruction))});
  }
  std::optional<Loop> found;
  for (const Loop& loop : loops) {
    const bool is_inner = std::ranges::none_of(loops, [&](const Loop& other) {
      const bool is_same = other.first == loop.first && other.last == loop.last;
      return !is_same && other.first >= loop.first && other.last <= loop.last;
    });
    if (is_inner && (!found || loop.instructions > found->instructions)) found = loop;
  }
  return found;
}

std::string text_of(const std::vector<std::string>& lines, const Loop& loop, double& spills) {
  std::string text;
  for (size_t i = loop.first; i <= loop.last; ++i) {
    if (lines[i].starts_with("\t.")) continue;
    text += lines[i] + "\n";
    if (lines[i].find("(%rsp)") != std::string::npos || lines[i].find("(%rbp)") != std::string::npos) ++spills;
  }
  return text;
}

/// Reads what `llvm-mca -json` says of one region.
std::optional<PortBound> parse(const std::string& output) {
  const nlohmann::json report = nlohmann::json::parse(output, nullptr, false);
  if (report.is_discarded() || !report.contains("CodeRegions") || report["CodeRegions"].empty()) return std::nullopt;
  const nlohmann::json& region = report["CodeRegions"][0];
  const nlohmann::json& summary = region["SummaryView"];
  PortBound bound;
  bound.cycles = summary["BlockRThroughput"].get<double>();
  bound.simulated = summary["TotalCycles"].get<double>() / iterations;
  bound.resource = "dispatch";
  const double dispatch = summary["TotaluOps"].get<double>() / iterations / summary["DispatchWidth"].get<double>();
  // The usage of all instructions together stands under the index after the last one.
  const size_t all = region["Instructions"].size();
  double most = 0;
  for (const nlohmann::json& usage : region["ResourcePressureView"]["ResourcePressureInfo"]) {
    const double cycles = usage["ResourceUsage"].get<double>();
    if (usage["InstructionIndex"].get<size_t>() != all || cycles <= std::max(most, dispatch)) continue;
    most = cycles;
    const std::string name = report["TargetInfo"]["Resources"][usage["ResourceIndex"].get<size_t>()].get<std::string>();
    bound.resource = name.substr(0, name.find('.'));  // "Zn3FPP45.\u0001" is one unit of a group
  }
  return bound;
}

}  // namespace

bool write_lanes_headers(const std::string& folder, bool free_compiler) {
  support::Diagnostics ignored;
  for (const char* made : {"/isoshade", "/isoshade/lanes"}) mkdir((folder + made).c_str(), 0700);
  return std::ranges::all_of(cpu::lanes_headers(), [&](const cpu::Header& header) {
    std::string text(header.text);
    const size_t pragma = free_compiler ? text.find("#pragma GCC optimize(") : text.npos;
    if (pragma != text.npos) text.erase(pragma, text.find('\n', pragma) - pragma);
    return backends::write_file(folder + "/" + std::string(header.path), text, ignored);
  });
}

std::unique_ptr<PortAnalyser> PortAnalyser::find(const std::string& compiler, support::Seconds limit) {
  support::Diagnostics ignored;
  const std::string mca = support::find_program("llvm-mca");
  auto found = cpu::Compiler::find(compiler, ignored, limit);
  auto folder = support::TemporaryFolder::make(support::temporary_parent());
  if (mca.empty() || !found || !folder || !write_lanes_headers(folder->path(), false)) return nullptr;
  return std::unique_ptr<PortAnalyser>(new PortAnalyser(mca, *std::move(found), *std::move(folder), limit));
}

std::optional<PortBound> PortAnalyser::analyse(const std::string& cpp, const cpu::LaneCount& lanes) const {
  support::Diagnostics ignored;
  const std::string source = folder_.path() + "/program.cpp", assembly = folder_.path() + "/program.s",
                    loop_file = folder_.path() + "/loop.s";
  std::vector<std::string> command{compiler_.path()};
  for (const std::string& flag : compiler_.flags(lanes))
    if (flag != "-shared") command.push_back(flag);
  command.insert(command.end(), {"-S", "-I" + folder_.path(), "-o", assembly, source});
  if (!backends::write_file(source, cpp, ignored)) return std::nullopt;
  const auto compiled = support::run_process(command, {{"LC_ALL", "C"}}, limit_);
  if (!compiled || compiled->late || compiled->status != 0) return std::nullopt;
  const auto text = bytes_of(assembly);
  if (!text) return std::nullopt;
  const std::vector<std::string> lines = lines_of(*text);
  const auto loop = hot_loop(lines);
  double spills = 0;
  if (!loop || !backends::write_file(loop_file, text_of(lines, *loop, spills), ignored)) return std::nullopt;
  const std::string result = folder_.path() + "/mca.json";  // longer than what run_process keeps
  const auto analysed = support::run_process(
      {mca_, "-mcpu=native", "-iterations=" + std::to_string(iterations), "-json", "-o", result, loop_file}, {}, limit_);
  const auto output = analysed && analysed->status == 0 ? bytes_of(result) : std::nullopt;
  auto bound = output ? parse(*output) : std::nullopt;
  if (!bound) return std::nullopt;
  const bool one_register = cpp.find("#undef ISOSHADE_REGISTERS") != std::string::npos;  // a large program
  const double evaluated = lanes.lanes * (one_register ? 1 : lanes.registers);
  bound->cycles /= evaluated;
  bound->simulated /= evaluated;
  bound->spills = spills / evaluated;
  return bound;
}

double clock_frequency() {
#if defined(__x86_64__)
  constexpr int rounds = 50'000, multiplications = 4, latency = 3;
  render::Clock clock;
  long value = 3;
  for (int i = 0; i < rounds; ++i)
    asm volatile("imul %0, %0\n\timul %0, %0\n\timul %0, %0\n\timul %0, %0" : "+r"(value));
  return rounds * multiplications * latency / (clock.lap() * 1e9);
#else
  return 0;
#endif
}

}  // namespace isoshade::bench
