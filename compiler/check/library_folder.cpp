// SPDX-License-Identifier: Apache-2.0
#include <dlfcn.h>
#include <filesystem>

#include "compiler/check/library.h"

namespace isoshade::check {
namespace {

namespace fs = std::filesystem;

/// The file that holds this code: the shared library, or else the program.
fs::path own_file() {
  std::error_code error;
  Dl_info info{};
  const auto* code = reinterpret_cast<const void*>(&own_file);
  if (dladdr(code, &info) != 0 && info.dli_fname != nullptr) {
    const fs::path name(info.dli_fname);
    if (name.filename().string().find(".so") != std::string::npos) {
      const fs::path file = fs::canonical(name, error);
      if (!error) return file;
    }
  }
  // Of the program itself, the loader knows the name only as it was called.
  return fs::read_symlink("/proc/self/exe", error);
}

}  // namespace

std::string shipped_library() {
  std::error_code error;
  // Programs lie one folder below the prefix, libraries one or two (lib/x86_64-linux-gnu).
  fs::path folder = own_file().parent_path();
  for (int up = 0; up < 2 && folder.has_relative_path(); ++up) {
    folder = folder.parent_path();
    const fs::path library = folder / ISOSHADE_DATA_FOLDER / "isoshade/library";
    if (fs::is_directory(library, error)) return library.string();
  }
  return ISOSHADE_SOURCE_LIBRARY;
}

}  // namespace isoshade::check
