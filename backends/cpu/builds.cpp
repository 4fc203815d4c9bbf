// SPDX-License-Identifier: Apache-2.0
#include "backends/cpu/builds.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

#include "backends/shared.h"
#include "compiler/support/leftovers.h"
#include "compiler/support/visible.h"

namespace isoshade::cpu {
namespace {

namespace fs = std::filesystem;
using support::Diagnostics;
using support::Id;
using support::Leftovers;

constexpr std::chrono::milliseconds tick{5};
/// A folder without a lock is that of a process that has just created it.
constexpr std::chrono::seconds youth{10};
/// The compilers must not hold up the threads that draw.
constexpr int niceness = 10;

/// Compiles in each folder that it is given: `build` makes made.so. In the end there is program.so, or `failed` with what
/// the compiler said.
constexpr const char* script =
    "for folder do cd \"$folder\" && { TMPDIR=\"$folder\" /bin/sh ./build && mv made.so program.so; } >log 2>&1 || "
    "mv log failed; done";

/// Held, while it is open, by the processes that compile: as long as any of them lives, nobody else can lock it.
class Lock {
 public:
  Lock(const std::string& folder, int flags) : descriptor_(open((folder + "/lock").c_str(), flags | O_CLOEXEC, 0600)) {}
  ~Lock() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

  bool is_open() const { return descriptor_ >= 0; }
  bool take() const { return flock(descriptor_, LOCK_EX | LOCK_NB) == 0; }
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

enum class State : uint8_t { absent, running, made, failed, dead };

bool exists(const std::string& path) { return access(path.c_str(), F_OK) == 0; }

/// Whether the folder has changed a short time ago; nothing if it does not exist.
std::optional<bool> is_young(const std::string& folder) {
  std::error_code error;
  const auto changed = fs::last_write_time(folder, error);
  if (error) return std::nullopt;
  return fs::file_time_type::clock::now() - changed < youth;
}

State end_of(const std::string& folder, State otherwise) {
  if (exists(folder + "/program.so")) return State::made;
  return exists(folder + "/failed") ? State::failed : otherwise;
}

State state_of(const std::string& folder) {
  if (const State end = end_of(folder, State::running); end != State::running) return end;
  const Lock lock(folder, O_RDONLY);
  const bool is_taken = exists(folder + "/taken.so");
  if (lock.is_open() && !is_taken) return lock.take() ? end_of(folder, State::dead) : State::running;
  const auto young = is_young(folder);
  if (!young) return State::absent;
  return *young ? State::running : State::dead;
}

void remove_folder(const std::string& folder) {
  std::error_code ignored;
  fs::remove_all(folder, ignored);
}

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

Builds::~Builds() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void Builds::add(Build build) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(build));
  }
  changed_.notify_one();
  if (!thread_.joinable()) thread_ = std::thread([this] { work(); });
}

void Builds::report(Diagnostics& diagnostics) {
  const std::lock_guard lock(mutex_);
  for (const support::Diagnostic& failure : failures_) {
    support::Diagnostic& report =
        diagnostics.report(Id::not_compiled, failure.message + "; the interpreter runs it, which is slower");
    report.notes = failure.notes;
    report.fix = failure.fix;
  }
  failures_.clear();
}

void Builds::fail(const Diagnostics& failure) {
  const std::lock_guard lock(mutex_);
  failures_.insert(failures_.end(), failure.all().begin(), failure.all().end());
}

void Builds::fail(const Running& running, const std::string& how, const std::string& words) {
  Diagnostics failure;
  toolchain_.compiler.report_failure(running.build.what, how, words, failure);
  fail(failure);
}

void Builds::work() {
  setpriority(PRIO_PROCESS, 0, niceness);  // of this thread, and of what it starts
  const size_t most = std::max(1u, std::thread::hardware_concurrency());
  std::unique_lock lock(mutex_);
  const auto may_begin = [&] { return !waiting_.empty() && running_.size() < most; };
  const auto wakes = [&] { return ends_ || may_begin(); };
  while (!ends_) {
    if (running_.empty())
      changed_.wait(lock, wakes);
    else
      changed_.wait_for(lock, tick, wakes);
    std::optional<Running> next;
    if (!ends_ && may_begin()) {
      next.emplace(std::move(waiting_.front()), toolchain_.cache.shared_workshop(waiting_.front().entry));
      waiting_.pop_front();
    }
    lock.unlock();
    if (next && !begin(*next)) running_.push_back(*std::move(next));
    std::erase_if(running_, [&](Running& running) { return is_done(running); });
    if (running_.empty()) adopt_all();
    lock.lock();
  }
  std::vector<Running> rest;
  for (Build& build : waiting_) rest.emplace_back(std::move(build), toolchain_.cache.shared_workshop(build.entry));
  lock.unlock();
  leave(std::move(rest));
}

void Builds::leave(std::vector<Running> rest) {
  if (!toolchain_.cache.is_lasting()) {
    for (const Running& running : running_)
      if (running.group != 0) abandon(running);
    return;
  }
  std::erase_if(rest, [&](Running& running) { return claim(running) != Claim::own; });
  std::vector<Running*> started;
  for (Running& running : rest) started.push_back(&running);
  if (!started.empty() && start(started))
    for (Running& running : rest) running_.push_back(std::move(running));
  for (const Running& running : running_)
    if (running.group != 0) forget(running);
}

/// Takes what other processes have left, so that it counts for the limits of the cache.
void Builds::adopt_all() const {
  for (const std::string& entry : toolchain_.cache.shared_workshops()) {
    const std::string folder = toolchain_.cache.shared_workshop(entry);
    support::Diagnostics ignored;
    if (state_of(folder) == State::made) adopt(entry, folder, ignored);
  }
}

/// Moves what was made to the cache, unless another process does.
bool Builds::adopt(const std::string& entry, const std::string& folder, Diagnostics& diagnostics) const {
  const std::string taken = folder + "/taken.so";
  if (rename((folder + "/program.so").c_str(), taken.c_str()) != 0) return false;
  toolchain_.cache.store(entry, taken, diagnostics);
  remove_folder(folder);
  return true;
}

/// Uses the entry if it is in the cache. Otherwise claims its folder, or learns that another process has it.
Builds::Claim Builds::claim(Running& running) {
  for (int attempt = 0; attempt < 2; ++attempt) {
    if (use(running)) return Claim::done;
    {
      const auto lock = Leftovers::lock();
      if (mkdir(running.folder.c_str(), 0700) == 0) {
        Leftovers::add_path(running.folder);
        break;
      }
    }
    const int failure = errno;
    const State state = failure == EEXIST ? state_of(running.folder) : State::absent;
    if (state == State::running || state == State::made) return Claim::other;
    if (state == State::failed) fail(running, " failed", text_of(running.folder + "/failed"));
    remove_folder(running.folder);
    if (attempt == 1) {
      fail(running, std::string(" could not start (") + std::strerror(failure) + ")", "");
      return Claim::done;
    }
  }
  Diagnostics diagnostics;
  const Compiler& compiler = toolchain_.compiler;
  if (write_sources(running.folder, running.build.text, diagnostics) &&
      backends::write_file(running.folder + "/build", compiler.script(toolchain_.lanes), diagnostics))
    return Claim::own;
  fail(diagnostics);
  abandon(running);
  return Claim::done;
}

/// Whether it is done already.
bool Builds::begin(Running& running) {
  switch (claim(running)) {
    case Claim::done: return true;
    case Claim::other: return false;
    case Claim::own: break;
  }
  return !start({&running});
}

/// Starts a process that compiles in one folder after the other.
bool Builds::start(const std::vector<Running*>& all) {
  const Lock lock(all[0]->folder, O_RDWR | O_CREAT);
  std::optional<pid_t> group;
  if (lock.take()) {
    // The same file for all: this process inherits one descriptor.
    for (size_t i = 1; i < all.size(); ++i)
      (void)!link((all[0]->folder + "/lock").c_str(), (all[i]->folder + "/lock").c_str());
    std::vector<std::string> arguments = {"/bin/sh", "-c", script, "sh"};
    for (const Running* running : all) arguments.push_back(running->folder);
    group = support::start_process(arguments, {{"LC_ALL", "C"}}, lock.descriptor());
  }
  for (Running* running : all) {
    running->group = group.value_or(0);
    running->start = Clock::now();
    if (group) continue;
    fail(*running, " could not be started", "");
    abandon(*running);
  }
  return group.has_value();
}

/// Whether the entry is in the cache; then it is used.
bool Builds::use(const Running& running) {
  const std::optional<std::string> path = toolchain_.cache.find(running.build.entry);
  if (!path) return false;
  Diagnostics diagnostics;
  running.build.ready(*path, diagnostics);
  fail(diagnostics);
  return true;
}

bool Builds::is_done(Running& running) {
  const bool own = running.group != 0;
  const State state = state_of(running.folder);
  switch (state) {
    case State::running:
      if (!own || Clock::now() - running.start < toolchain_.compiler.limit()) return false;
      abandon(running);
      fail(running, " took too long", "");
      return true;
    case State::made: {
      Diagnostics diagnostics;
      if (!adopt(running.build.entry, running.folder, diagnostics)) return false;
      fail(diagnostics);
      if (own) forget(running);
      use(running);
      return true;
    }
    case State::failed: {
      const std::string words = text_of(running.folder + "/failed");
      if (own) abandon(running);
      fail(running, " failed", words);
      return true;
    }
    case State::absent:
    case State::dead: break;
  }
  if (own) abandon(running);
  if (use(running)) return true;
  if (!own) return begin(running);
  fail(running, " was ended", "");
  return true;
}

/// From here on this process does not end it.
void Builds::forget(const Running& running) {
  const auto lock = Leftovers::lock();
  Leftovers::remove_path(running.folder);
  Leftovers::remove_group(running.group);
}

void Builds::abandon(const Running& running) {
  if (running.group != 0) kill(-running.group, SIGKILL);
  remove_folder(running.folder);
  forget(running);
}

}  // namespace isoshade::cpu
