// SPDX-License-Identifier: Apache-2.0
#include "backends/cpu/kernel.h"

#include <algorithm>
#include <dlfcn.h>
#include <sys/stat.h>
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

bool write_headers(const std::string& folder, Diagnostics& diagnostics) {
  for (const char* made : {"/isoshade", "/isoshade/lanes"}) mkdir((folder + made).c_str(), 0700);
  return std::ranges::all_of(lanes_headers(), [&](const Header& header) {
    return write_file(folder + "/" + std::string(header.path), header.text, diagnostics);
  });
}

/// A file name for a program; names of documents are free text.
std::string file_name(const driver::Program& program) {
  std::string name = program.name.empty() ? "program" : program.name;
  for (char& c : name)
    if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'))) c = '_';
  return name + "." + std::string(lower::name(program.stage)) + ".cpp";
}

}  // namespace

std::unique_ptr<Kernel> Kernel::load(const std::string& path, driver::Stage stage, Diagnostics& diagnostics) {
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) {
    diagnostics.report(Id::unloadable_code, "cannot load " + quote(path))
        .note(dlerror())
        .suggest(
            "code must be loadable from the cache: set XDG_CACHE_HOME to a folder on a disk that is not "
            "mounted "
            "noexec, or delete the file if it is damaged");
    return nullptr;
  }
  std::unique_ptr<Kernel> kernel(new Kernel(library));
  void* function = nullptr;
  switch (stage) {
    case driver::Stage::vertex:
      function = dlsym(library, "isoshade_vertex");
      kernel->vertex = reinterpret_cast<VertexFunction*>(function);
      break;
    case driver::Stage::cutout:
      function = dlsym(library, "isoshade_cutout");
      kernel->cutout = reinterpret_cast<CutoutFunction*>(function);
      break;
    case driver::Stage::pixel:
      function = dlsym(library, "isoshade_pixel");
      kernel->pixel = reinterpret_cast<PixelFunction*>(function);
      break;
    case driver::Stage::blend:
      function = dlsym(library, "isoshade_blend");
      kernel->blend = reinterpret_cast<BlendFunction*>(function);
      break;
    case driver::Stage::eval:
      function = dlsym(library, "isoshade_eval");
      kernel->eval = reinterpret_cast<EvalFunction*>(function);
      break;
    case driver::Stage::post:
      function = dlsym(library, "isoshade_post");
      kernel->post = reinterpret_cast<PostFunction*>(function);
      break;
    case driver::Stage::depth: support::bug("the CPU rasteriser computes depth itself");
  }
  support::assert_that(function != nullptr, "generated C++ exports no function of its stage");
  return kernel;
}

Kernel::~Kernel() { dlclose(library_); }

KernelStore::KernelStore(Compiler compiler, Cache cache, LaneCount lanes, CppText cpp, std::string keep)
    : compiler_(std::move(compiler)),
      cache_(std::move(cache)),
      lanes_(lanes),
      cpp_(std::move(cpp)),
      keep_(std::move(keep)) {
  support::Sha256 hash;
  add_part(hash, compiler_.identity());
  for (const std::string& flag : compiler_.flags(lanes_)) add_part(hash, flag);
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

std::optional<std::vector<const Kernel*>> KernelStore::kernels(
    std::span<const driver::Program* const> programs, Diagnostics& diagnostics) {
  const backends::Timed timed(seconds_);
  struct Missing {
    const driver::Program* program;
    std::string text;
    std::string key;
    std::unique_ptr<Kernel> kernel = nullptr;
    Diagnostics diagnostics = Diagnostics();
  };
  std::vector<std::string> keys;
  std::vector<Missing> missing;
  for (const driver::Program* program : programs) {
    if (!driver::within_limits(*program, driver::Target::cpu, driver::Division::native, diagnostics))
      return std::nullopt;
    std::string text = cpp_(*program);
    keys.push_back(key_of(text));
    const std::string& key = keys.back();
    if (!keep_.empty() && !write_file(keep_ + "/" + file_name(*program), text, diagnostics))
      return std::nullopt;
    const auto is_same = [&](const Missing& m) { return m.key == key; };
    if (loaded_.contains(key) || std::ranges::any_of(missing, is_same)) continue;
    missing.push_back({program, std::move(text), key});
  }

  tbb::parallel_for(size_t{0}, missing.size(), [&](size_t i) {
    Missing& m = missing[i];
    m.kernel = make(*m.program, m.text, m.key, m.diagnostics);
  });
  bool failed = false;
  for (Missing& m : missing) {
    for (support::Diagnostic& d : m.diagnostics.all()) diagnostics.report(d.id, d.where, d.message) = d;
    if (m.kernel)
      loaded_[m.key] = std::move(m.kernel);
    else
      failed = true;
  }
  if (failed) return std::nullopt;

  std::vector<const Kernel*> result;
  for (const std::string& key : keys) result.push_back(loaded_[key].get());
  return result;
}

std::unique_ptr<Kernel> KernelStore::make(const driver::Program& program, const std::string& text,
                                          const std::string& key, Diagnostics& diagnostics) const {
  const std::string entry = Cache::entry_name(key);
  std::optional<std::string> path = cache_.find(entry);
  if (!path) {
    if (!compile(program, text, entry, diagnostics)) return nullptr;
    path = cache_.find(entry);
  }
  if (!path) {
    diagnostics.report(Id::unwritable_cache,
                       "the cache " + quote(cache_.folder()) + " does not keep what it is given");
    return nullptr;
  }
  return Kernel::load(*path, program.stage, diagnostics);
}

bool KernelStore::compile(const driver::Program& program, const std::string& text, const std::string& entry,
                          Diagnostics& diagnostics) const {
  const std::string what = "the " + std::string(lower::name(program.stage)) + " program of " +
                           quote(program.document.empty() ? program.name : program.document);
  const std::optional<support::TemporaryFolder> workshop = cache_.workshop(diagnostics);
  return workshop && write_headers(workshop->path(), diagnostics) &&
         write_file(workshop->path() + "/program.cpp", text, diagnostics) &&
         compiler_.compile(workshop->path(), what, lanes_, diagnostics) &&
         cache_.store(entry, workshop->path() + "/program.so", diagnostics);
}

}  // namespace isoshade::cpu
