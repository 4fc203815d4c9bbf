// SPDX-License-Identifier: Apache-2.0
#include "backends/cpu/kernel.h"

#include <dlfcn.h>
#include <tbb/parallel_for.h>
#include <utility>

#include "backends/shared.h"
#include "compiler/driver/target_limits.h"
#include "compiler/support/assert.h"
#include "compiler/support/sha256.h"
#include "compiler/support/visible.h"

namespace isoshade::cpu {
namespace {

using backends::Cache;
using backends::write_file;
using support::Diagnostics;
using support::Id;
using support::quote;

/// Adds a part with its length, so that different lists of parts never give the same bytes.
void add_part(support::Sha256& hash, std::string_view part) {
  hash.add(std::to_string(part.size())).add(":").add(part);
}

/// A file name for a program; names of documents are free text.
std::string file_name(const driver::Program& program) {
  std::string name = program.name.empty() ? "program" : program.name;
  for (char& c : name)
    if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'))) c = '_';
  return name + "." + std::string(lower::name(program.stage)) + ".cpp";
}

/// For messages.
std::string what(const driver::Program& program) {
  return "the " + std::string(lower::name(program.stage)) + " program of " +
         quote(program.document.empty() ? program.name : program.document);
}

}  // namespace

bool Kernel::load(const std::string& path, Diagnostics& diagnostics) {
  void* const library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) {
    diagnostics.report(Id::unloadable_code, "cannot load " + quote(path))
        .note(dlerror())
        .suggest(
            "code must be loadable from the cache: set XDG_CACHE_HOME to a folder on a disk that is not "
            "mounted "
            "noexec, or delete the file if it is damaged");
    return false;
  }
  library_ = library;
  void* const function = dlsym(library, ("isoshade_" + std::string(lower::name(stage_))).c_str());
  support::assert_that(function != nullptr, "generated C++ exports no function of its stage");
  function_.store(function, std::memory_order_release);
  return true;
}

Kernel::~Kernel() {
  if (library_ != nullptr) dlclose(library_);
}

KernelStore::KernelStore(std::optional<Toolchain> toolchain, Execution execution, CppText cpp, std::string keep)
    : execution_(execution), cpp_(std::move(cpp)), keep_(std::move(keep)) {
  if (!toolchain) return;
  toolchain_ = std::make_unique<const Toolchain>(std::move(*toolchain));
  if (execution_ == Execution::at_once) builds_ = std::make_unique<Builds>(*toolchain_);
  support::Sha256 hash;
  add_part(hash, toolchain_->compiler.identity());
  for (const std::string& flag : toolchain_->compiler.flags(toolchain_->lanes)) add_part(hash, flag);
  for (const Header& header : lanes_headers()) {
    add_part(hash, header.path);
    add_part(hash, header.text);
  }
  surroundings_ = hash.hex();
}

std::string KernelStore::key_of(const std::string& text) const {
  support::Sha256 hash;
  add_part(hash, surroundings_);
  add_part(hash, text);
  return hash.hex();
}

std::string KernelStore::entry_of(const std::string& text) const { return Cache::entry_name(key_of(text)); }

std::string KernelStore::description() const {
  std::string text = toolchain_ == nullptr
                         ? "interpreter, lanes " + std::to_string(interpreter::Code::widest_lanes())
                         : toolchain_->compiler.version() + ", lanes " + std::string(toolchain_->lanes.name);
  if (execution_ != Execution::at_once) return text;
  uint64_t compiled = 0, interpreted = 0;
  for (const auto& [key, kernel] : kernels_) {
    compiled += kernel->runs_compiled();
    interpreted += kernel->runs_interpreted();
  }
  if (interpreted == 0) return text;
  return text + " (" + std::to_string(interpreted) + " of " + std::to_string(interpreted + compiled) +
         " vertices, pixels and rows by the interpreter)";
}

std::optional<std::vector<const Kernel*>> KernelStore::kernels(
    std::span<const driver::Program* const> programs, Diagnostics& diagnostics) {
  const backends::Timed timed(seconds_);
  struct Missing {
    const driver::Program* program;
    std::string text;
    std::unique_ptr<Kernel> kernel;
    bool is_found = false;
    Diagnostics diagnostics = Diagnostics();
  };
  const bool waits = execution_ == Execution::compiled;
  if (builds_ != nullptr) builds_->report(diagnostics);
  std::vector<const Kernel*> result;
  for (const driver::Program* program : programs)
    if (const auto known = kernel_of_program_.find(program->number); known != kernel_of_program_.end())
      result.push_back(known->second);
  if (result.size() == programs.size()) return result;
  std::vector<std::string> keys;
  std::map<std::string, Missing> missing;
  for (const driver::Program* program : programs) {
    const driver::Target target =
        execution_ == Execution::interpreted ? driver::Target::interpreter : driver::Target::cpu;
    if (!driver::within_limits(*program, target, driver::Division::native, diagnostics)) return std::nullopt;
    std::string text = cpp_(*program);
    if (!keep_.empty() && !write_file(keep_ + "/" + file_name(*program), text, diagnostics)) return std::nullopt;
    const std::string& key = keys.emplace_back(key_of(text));
    if (!kernels_.contains(key))
      missing.try_emplace(key, Missing{program, std::move(text), std::make_unique<Kernel>(program->stage)});
  }

  std::vector<Missing*> all;
  for (auto& [key, m] : missing) all.push_back(&m);
  tbb::parallel_for(size_t{0}, all.size(), [&](size_t i) {
    Missing& m = *all[i];
    Diagnostics too_large;
    const bool interprets =
        !waits && driver::within_limits(*m.program, driver::Target::interpreter, driver::Division::native, too_large);
    m.is_found = find(*m.program, m.text, interprets, *m.kernel, m.diagnostics);
  });
  bool failed = false;
  for (auto& [key, m] : missing) {
    for (support::Diagnostic& d : m.diagnostics.all()) diagnostics.report(d.id, d.where, d.message) = d;
    failed = failed || !m.is_found;
    if (!m.is_found) continue;
    if (builds_ != nullptr && !m.kernel->is_compiled())
      builds_->add({what(*m.program), std::move(m.text), Cache::entry_name(key),
                    [kernel = m.kernel.get()](const std::string& path, Diagnostics& reports) { kernel->load(path, reports); }});
    kernels_[key] = std::move(m.kernel);
  }
  if (failed) return std::nullopt;

  result.clear();
  for (const std::string& key : keys) result.push_back(kernels_[key].get());
  for (size_t i = 0; i < programs.size(); ++i)
    if (programs[i]->number != 0) kernel_of_program_[programs[i]->number] = result[i];
  return result;
}

/// Loads compiled code, or lets the interpreter run the program if it may, or compiles it.
bool KernelStore::find(const driver::Program& program, const std::string& text, bool interprets, Kernel& kernel,
                       Diagnostics& diagnostics) const {
  std::optional<std::string> path;
  if (toolchain_ != nullptr) path = toolchain_->cache.find(entry_of(text));
  if (!path && interprets) {
    kernel.interpret(program);
    return true;
  }
  if (!path) {
    if (!compile(program, text, diagnostics)) return false;
    path = toolchain_->cache.find(entry_of(text));
  }
  if (!path) {
    diagnostics.report(Id::unwritable_cache,
                       "the cache " + quote(toolchain_->cache.folder()) + " does not keep what it is given");
    return false;
  }
  return kernel.load(*path, diagnostics);
}

bool KernelStore::compile(const driver::Program& program, const std::string& text, Diagnostics& diagnostics) const {
  const auto& [compiler, cache, lanes] = *toolchain_;
  const std::optional<support::TemporaryFolder> workshop = cache.workshop(diagnostics);
  return workshop && write_sources(workshop->path(), text, diagnostics) &&
         compiler.compile(workshop->path(), what(program), lanes, diagnostics) &&
         cache.store(entry_of(text), workshop->path() + "/program.so", diagnostics);
}

}  // namespace isoshade::cpu
