// SPDX-License-Identifier: Apache-2.0
#include "compiler/support/process.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <string_view>
#include <sys/stat.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>

#include "compiler/support/leftovers.h"
#include "compiler/support/parse_number.h"
#include "compiler/support/visible.h"

namespace isoshade::support {
namespace {

constexpr size_t most_output = 64 * 1024;

class SpawnSettings {
 public:
  /// `output`: what receives stdout and stderr.
  explicit SpawnSettings(int output) {
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&files, output, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&files, output, STDERR_FILENO);
    // Unblocks all signals and restores SIGPIPE. An ignored SIGXFSZ stays ignored, so that a child that exceeds the
    // limit on file sizes reports it in words instead of being killed.
    posix_spawnattr_init(&attributes);
    sigset_t signals;
    sigemptyset(&signals);
    posix_spawnattr_setsigmask(&attributes, &signals);
    sigaddset(&signals, SIGPIPE);
    posix_spawnattr_setsigdefault(&attributes, &signals);
    posix_spawnattr_setpgroup(&attributes, 0);  // a new group, so that its children can be killed with it
    posix_spawnattr_setflags(&attributes,
                             POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  }
  ~SpawnSettings() {
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;

  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
};

std::vector<std::string> environment_with(const Variables& variables) {
  std::vector<std::string> result;
  for (char** entry = environ; *entry; ++entry) {
    const std::string_view text(*entry);
    const std::string_view name = text.substr(0, text.find('='));
    if (std::none_of(variables.begin(), variables.end(), [&](const auto& v) { return v.first == name; }))
      result.emplace_back(text);
  }
  for (const auto& [name, value] : variables) result.push_back(name + "=" + value);
  return result;
}

std::vector<char*> pointers(const std::vector<std::string>& strings) {
  std::vector<char*> result;
  for (const std::string& text : strings) result.push_back(const_cast<char*>(text.c_str()));
  result.push_back(nullptr);
  return result;
}

class Output {
 public:
  explicit Output(int file) : file_(file) {}
  ~Output() { end(); }
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  bool is_open() const { return file_ >= 0; }
  std::string take() { return std::move(text_); }

  /// Waits at most this long for output and reads it, so that the writer never blocks on a full pipe.
  void read_for(int milliseconds) {
    pollfd event{file_, POLLIN, 0};
    if (poll(&event, 1, milliseconds) <= 0) return;
    char part[4096];
    const ssize_t n = read(file_, part, sizeof part);
    if (n < 0 && errno == EINTR) return;
    if (n <= 0) return end();
    text_.append(part, std::min(static_cast<size_t>(n), most_output - text_.size()));
  }
  /// Reads what is available without waiting.
  void read_rest() {
    for (pollfd event{file_, POLLIN, 0}; is_open() && poll(&event, 1, 0) > 0;) read_for(0);
  }

 private:
  void end() {
    if (file_ >= 0) close(file_);
    file_ = -1;
  }

  int file_;
  std::string text_;
};

/// Whether the child has ended. It stays a zombie, so that its pid is not reused.
bool has_ended(pid_t child, bool wait) {
  siginfo_t info{};
  while (waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOWAIT | (wait ? 0 : WNOHANG)) != 0)
    if (errno != EINTR) return true;
  return info.si_pid == child;
}

/// Waits for the child, which leads its own process group, and kills the group after `limit`. Returns whether it was
/// killed. Does not wait for processes that the child leaves running, although they may hold its output open.
bool wait_for(pid_t child, Output& output, Seconds limit) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point end = Clock::now() + std::chrono::duration_cast<Clock::duration>(limit);
  constexpr int tick = 20;  // milliseconds between checks whether the child has ended
  while (!has_ended(child, false)) {
    if (Clock::now() >= end) {
      kill(-child, SIGKILL);
      has_ended(child, true);
      return true;
    }
    if (output.is_open())
      output.read_for(tick);
    else
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

bool is_program(const std::string& path) {
  struct stat facts;
  return stat(path.c_str(), &facts) == 0 && S_ISREG(facts.st_mode) && access(path.c_str(), X_OK) == 0;
}

/// The program's path, found in the absolute folders of PATH; empty if there is none.
std::string search_path(const std::string& name) {
  const char* variable = std::getenv("PATH");
  std::string_view folders = variable ? variable : "/usr/bin:/bin";
  while (!folders.empty()) {
    const size_t end = std::min(folders.find(':'), folders.size());
    const std::string folder(folders.substr(0, end));
    folders.remove_prefix(std::min(end + 1, folders.size()));
    if (folder.starts_with('/') && is_program(folder + "/" + name)) return folder + "/" + name;
  }
  return "";
}

}  // namespace

std::string find_program(const std::string& name) {
  if (name.find('/') != std::string::npos) return is_program(name) ? name : "";
  return search_path(name);
}

std::optional<ProcessEnd> run_process(const std::vector<std::string>& arguments, const Variables& variables,
                                      Seconds limit) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return std::nullopt;
  Output output(ends[0]);
  const std::vector<std::string> environment = environment_with(variables);
  const SpawnSettings settings(ends[1]);
  pid_t child = 0;
  int failure = 0;
  {
    const auto lock = Leftovers::lock();
    failure = posix_spawn(&child, arguments[0].c_str(), &settings.files, &settings.attributes,
                          pointers(arguments).data(), pointers(environment).data());
    if (failure == 0) Leftovers::add_group(child);
  }
  close(ends[1]);
  if (failure != 0) return std::nullopt;

  ProcessEnd result{-1, "", wait_for(child, output, limit)};
  output.read_rest();
  {
    const auto lock = Leftovers::lock();
    Leftovers::remove_group(child);
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return std::nullopt;
  result.output = output.take();
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

std::optional<pid_t> start_process(const std::vector<std::string>& arguments, const Variables& variables, int descriptor) {
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere < 0) return std::nullopt;
  const std::vector<std::string> environment = environment_with(variables);
  // The shell ends at once, and leaves the program to the system's first process, which waits for orphans.
  std::vector<std::string> shell = {"/bin/sh", "-c", "\"$@\" &", "sh"};
  shell.insert(shell.end(), arguments.begin(), arguments.end());
  pid_t group = 0;
  int failure = 0;
  {
    SpawnSettings settings(nowhere);
    // To itself: that keeps it open in the shell.
    posix_spawn_file_actions_adddup2(&settings.files, descriptor, descriptor);
    const auto lock = Leftovers::lock();
    failure = posix_spawn(&group, shell[0].c_str(), &settings.files, &settings.attributes, pointers(shell).data(),
                          pointers(environment).data());
    if (failure == 0) Leftovers::add_group(group);
  }
  close(nowhere);
  if (failure != 0) return std::nullopt;
  int status = 0;
  while (waitpid(group, &status, 0) < 0)
    if (errno != EINTR) break;
  return group;
}

Diagnostic& report_late(Id id, const std::string& program, const std::string& what, Seconds limit,
                        Diagnostics& diagnostics) {
  std::string seconds = format_float(static_cast<float>(limit.count()));
  if (seconds.ends_with(".0")) seconds.resize(seconds.size() - 2);
  return diagnostics.report(id, quote(program) + " did not " + what + " within " + seconds +
                                    (seconds == "1" ? " second" : " seconds") + " and was killed");
}

}  // namespace isoshade::support
