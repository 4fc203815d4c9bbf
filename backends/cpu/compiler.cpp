// SPDX-License-Identifier: Apache-2.0
#include "backends/cpu/compiler.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <sys/stat.h>
#include <unistd.h>

#include "backends/cache.h"
#include "compiler/support/temporary.h"
#include "compiler/support/visible.h"

namespace isoshade::cpu {
namespace {

using support::Diagnostics;
using support::Id;
using support::quote;

constexpr const char* way_out =
    "isoshade needs g++ 12 or clang++ 14, or newer, with the standard library's headers: install one, or "
    "name it "
    "with --cxx or in ISOSHADE_CXX";

/// Differs between a file and another one that replaces it.
std::string file_facts(const std::string& path) {
  struct stat facts;
  if (stat(path.c_str(), &facts) != 0) return "";
  return std::to_string(facts.st_dev) + " " + std::to_string(facts.st_ino) + " " +
         std::to_string(facts.st_size) + " " + std::to_string(facts.st_mtim.tv_sec) + "." +
         std::to_string(facts.st_mtim.tv_nsec);
}

/// The first lines of a compiler's output, each as a note.
void note_lines(std::string_view text, support::Diagnostic& report) {
  constexpr size_t most = 12;
  size_t count = 0;
  while (!text.empty() && count < most) {
    const size_t end = std::min(text.find('\n'), text.size());
    if (end > 0) {
      report.note(std::string(text.substr(0, end)));
      ++count;
    }
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  if (count == 0) report.note("it said nothing");
}

/// What the user can do about a compiler that failed with this output.
std::string_view way_out_of(std::string_view words) {
  // The compiler runs in the C locale, and spells these reasons as strerror does.
  for (const int failure : {ENOSPC, EDQUOT, EFBIG, EROFS})
    if (words.find(std::strerror(failure)) != std::string_view::npos) return support::write_failure_fix(failure);
  return way_out;
}

std::string quoted_for_shell(const std::string& argument) {
  std::string text = "'";
  for (const char c : argument) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

// Enough for a program that only prints its version, even on a busy machine.
constexpr support::Seconds longest_answer{20};

}  // namespace

std::optional<Compiler> Compiler::find(const std::string& wanted, Diagnostics& diagnostics,
                                       support::Seconds limit) {
  const char* variable = std::getenv("ISOSHADE_CXX");
  std::string name = !wanted.empty() ? wanted : variable ? variable : "";
  Compiler compiler;
  if (!name.empty()) {
    compiler.path_ = support::find_program(name);
    if (compiler.path_.empty()) {
      diagnostics.report(Id::no_compiler, "there is no C++ compiler " + quote(name)).suggest(way_out);
      return std::nullopt;
    }
  } else {
    for (const char* usual : {"c++", "g++", "clang++"})
      if (compiler.path_.empty()) compiler.path_ = support::find_program(usual);
    if (compiler.path_.empty()) {
      diagnostics.report(Id::no_compiler, "there is no C++ compiler on PATH").suggest(way_out);
      return std::nullopt;
    }
  }
  const std::optional<support::ProcessEnd> answer =
      support::run_process({compiler.path_, "--version"}, {{"LC_ALL", "C"}}, std::min(limit, longest_answer));
  if (!answer || answer->late || answer->status != 0 || answer->output.empty()) {
    diagnostics
        .report(Id::no_compiler, quote(compiler.path_) + " is no compiler: it does not answer --version")
        .suggest(way_out);
    return std::nullopt;
  }
  compiler.limit_ = limit;
  compiler.version_ = answer->output;
  compiler.identity_ = compiler.path_ + "\n" + file_facts(compiler.path_) + "\n" + compiler.version_;
  return compiler;
}

std::vector<std::string> Compiler::flags(const LaneCount& lanes) const {
  std::vector<std::string> result = {"-std=c++20",
                                     "-O2",
                                     "-shared",
                                     "-fPIC",
                                     "-fvisibility=hidden",
                                     "-ffp-contract=off",
                                     "-frounding-math",
                                     "-fwrapv",
                                     "-fno-exceptions",
                                     "-fno-asynchronous-unwind-tables"};
  // g++ folds some arithmetic without flushing unless signaling NaNs matter; clang does not know the option.
  if (version_.find("clang") == std::string::npos) {
    result.push_back("-fsignaling-nans");
    // Orders instructions before registers are allocated, with regard to how many there are, so that the registers of a
    // value hide each other's latency: Cook-Torrance with 8x2 lanes takes 34 % less time.
    result.insert(result.end(), {"-fschedule-insns", "-fsched-pressure"});
  }
  for (const std::string_view flag : lanes.flags()) result.emplace_back(flag);
  result.push_back("-DISOSHADE_LANES=" + std::to_string(lanes.lanes));
  result.push_back("-DISOSHADE_REGISTERS=" + std::to_string(lanes.registers));
  return result;
}

bool Compiler::compile(const std::string& folder, const std::string& what, const LaneCount& lanes,
                       Diagnostics& diagnostics) const {
  std::vector<std::string> arguments = {path_};
  for (std::string& flag : flags(lanes)) arguments.push_back(std::move(flag));
  arguments.insert(arguments.end(), {"-I" + folder, "-o", folder + "/program.so", folder + "/program.cpp"});
  const std::optional<support::ProcessEnd> end =
      support::run_process(arguments, {{"LC_ALL", "C"}, {"TMPDIR", folder}}, limit_);
  if (end && end->late) {
    support::report_late(Id::compiler_failed, path_, "compile " + what, limit_, diagnostics)
        .suggest("give it more time (--build-timeout SECONDS), or make the document smaller");
    return false;
  }
  const bool wrote = access((folder + "/program.so").c_str(), R_OK) == 0;
  if (end && end->status == 0 && wrote) return true;
  const std::string failed = !end                ? " could not be started"
                             : end->status > 128 ? " was ended by signal " + std::to_string(end->status - 128)
                             : end->status > 0   ? " failed with status " + std::to_string(end->status)
                                                 : " ended well but wrote no program";
  report_failure(what, failed, end ? end->output : "", diagnostics);
  return false;
}

void Compiler::report_failure(const std::string& what, const std::string& how, const std::string& words,
                              Diagnostics& diagnostics) const {
  support::Diagnostic& report =
      diagnostics.report(Id::compiler_failed, quote(path_) + how + " as it compiled " + what)
          .suggest(std::string(way_out_of(words)));
  note_lines(words, report);
}

std::string Compiler::script(const LaneCount& lanes) const {
  const std::string seconds = std::to_string(std::lround(std::ceil(limit_.count())));
  // Where there is no process that watches it any more, these end a compiler that hangs.
  std::string text = "ulimit -t " + seconds + "\nexec";
  const std::string timeout = support::find_program("timeout");
  std::vector<std::string> arguments;
  if (!timeout.empty()) arguments = {timeout, "-s", "KILL", seconds};
  arguments.push_back(path_);
  for (std::string& flag : flags(lanes)) arguments.push_back(std::move(flag));
  arguments.insert(arguments.end(), {"-I.", "-o", "made.so", "program.cpp"});
  for (const std::string& argument : arguments) text += " " + quoted_for_shell(argument);
  return text + "\n";
}

bool write_sources(const std::string& folder, const std::string& text, Diagnostics& diagnostics) {
  for (const char* made : {"/isoshade", "/isoshade/lanes"}) mkdir((folder + made).c_str(), 0700);
  return std::ranges::all_of(lanes_headers(),
                             [&](const Header& header) {
                               return backends::write_file(folder + "/" + std::string(header.path), header.text,
                                                           diagnostics);
                             }) &&
         backends::write_file(folder + "/program.cpp", text, diagnostics);
}

}  // namespace isoshade::cpu
