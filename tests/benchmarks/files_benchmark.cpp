// SPDX-License-Identifier: Apache-2.0
// The time to write images and the sizes of their files, by format: files_benchmark THREADS FILE.exr...
// The files are what `isoshade render SCENE --size 1024x1024 -o FILE.exr` writes. Times include encoding to bytes where the
// format has them; they are medians of interleaved repetitions, in ms, and the least in parentheses.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "runtime/scene/image_file.h"

namespace isoshade {
namespace {

constexpr int repetitions = 15;

struct Case {
  std::string name;
  std::function<size_t()> write;  ///< returns the size
  std::vector<double> times{};
  size_t size = 0;
};

void measure(const char* path, int threads) {
  support::Diagnostics diagnostics;
  const auto image = scene::read_image(path, diagnostics);
  if (!image || image->depth.empty()) {
    std::fprintf(stderr, "%s%s: not an image with depth\n", diagnostics.text().c_str(), path);
    std::exit(2);
  }
  std::vector<Case> cases;
  cases.push_back({"encode", [&] { return scene::encode(image->rgba, scene::Encoding::srgb, 1, scene::Alpha::straight, threads).size(); }});
  for (const scene::ImageFormat& format : scene::image_formats()) {
    if (!format.is_written()) continue;
    const auto add = [&](const std::string& name, scene::WriteOptions options) {
      options.threads = threads;
      cases.push_back({name, [&, options] {
                         if (format.write_floats != nullptr) return format.write_floats(image->view(), options).size();
                         support::Diagnostics unheard;
                         const auto bytes = scene::encode_for(format, image->view(), options, path, unheard);
                         return format.write_bytes({image->width, image->height, bytes}, options).size();
                       }});
    };
    if (format.name != "exr") add(std::string(format.name), {});
    for (const auto& [name, compression] : scene::lossless_compressions)
      if (format.name == "exr") add("exr " + std::string(name), {.compression = compression});
  }
  for (int i = 0; i <= repetitions; ++i) {
    for (Case& one : cases) {
      const auto before = std::chrono::steady_clock::now();
      one.size = one.write();
      const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - before;
      if (i > 0) one.times.push_back(time.count());  // the first one is not warm
    }
  }
  std::printf("%s, %d x %d\n", path, image->width, image->height);
  for (Case& one : cases) {
    std::ranges::sort(one.times);
    std::printf("  %-10s %8.1f (%.1f) ms %10zu bytes\n", one.name.c_str(), one.times[repetitions / 2], one.times[0], one.size);
  }
}

}  // namespace
}  // namespace isoshade

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fputs("files_benchmark THREADS FILE.exr...\n", stderr);
    return 2;
  }
  for (int i = 2; i < argc; ++i) isoshade::measure(argv[i], std::atoi(argv[1]));
}
