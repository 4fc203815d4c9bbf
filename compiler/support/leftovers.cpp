// SPDX-License-Identifier: Apache-2.0
#include "compiler/support/leftovers.h"

#include <chrono>
#include <csignal>
#include <filesystem>
#include <pthread.h>
#include <set>
#include <thread>
#include <unistd.h>

namespace isoshade::support {
namespace {

struct List {
  std::mutex mutex;
  std::set<std::string> paths;
  std::set<pid_t> groups;
};

/// Never destroyed, because threads may use it until the process exits.
List& list() {
  static List& only = *new List;
  return only;
}

volatile std::sig_atomic_t exit_status = -1;  ///< set by clean_up_and_exit()
volatile std::sig_atomic_t is_waiting = 0;    ///< whether a thread waits for SIGTERM

sigset_t& awaited() {
  static sigset_t signals;
  return signals;
}

void* wait_for_signals(void*) {
  int signal = 0;
  while (sigwait(&awaited(), &signal) != 0) {}
  Leftovers::clean_up();
  if (exit_status >= 0) _exit(exit_status);
  // Take the default action, so that the parent process sees which signal ended this one.
  std::signal(signal, SIG_DFL);
  sigset_t only;
  sigemptyset(&only);
  sigaddset(&only, signal);
  pthread_sigmask(SIG_UNBLOCK, &only, nullptr);
  kill(getpid(), signal);
  _exit(128 + signal);
}

}  // namespace

std::unique_lock<std::mutex> Leftovers::lock() { return std::unique_lock(list().mutex); }

void Leftovers::add_path(const std::string& path) { list().paths.insert(path); }
void Leftovers::remove_path(const std::string& path) { list().paths.erase(path); }
void Leftovers::add_group(pid_t group) { list().groups.insert(group); }
void Leftovers::remove_group(pid_t group) { list().groups.erase(group); }

void Leftovers::clean_up() {
  List& left = list();
  left.mutex.lock();
  for (const pid_t group : left.groups) kill(-group, SIGKILL);
  // A process that is being killed may still make a file.
  constexpr int most_attempts = 100;
  for (int attempt = 0; attempt < most_attempts && !left.paths.empty(); ++attempt) {
    if (attempt > 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    std::erase_if(left.paths, [](const std::string& path) {
      std::error_code error;
      std::filesystem::remove_all(path, error);
      return !error;
    });
  }
}

void clean_up_on_signals() {
  list();  // allocate now, while there is memory
  sigemptyset(&awaited());
  for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGUSR1, SIGUSR2, SIGXCPU}) {
    struct sigaction now {};
    if (sigaction(signal, nullptr, &now) == 0 && now.sa_handler != SIG_IGN) sigaddset(&awaited(), signal);
  }
  sigset_t before;
  if (pthread_sigmask(SIG_BLOCK, &awaited(), &before) != 0) return;
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
  pthread_attr_setstacksize(&attributes, 256 * 1024);
  pthread_t thread;
  // If no thread can be created, signals end the process at once.
  if (pthread_create(&thread, &attributes, wait_for_signals, nullptr) != 0)
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
  else
    is_waiting = sigismember(&awaited(), SIGTERM);
  pthread_attr_destroy(&attributes);
}

void clean_up_and_exit(int status) {
  exit_status = status;
  if (is_waiting == 0) _exit(status);
  // The faulting thread may hold a lock that the cleanup needs; exit after a timeout.
  std::signal(SIGALRM, [](int) { _exit(exit_status); });
  alarm(5);
  kill(getpid(), SIGTERM);
  while (true) pause();
}

}  // namespace isoshade::support
