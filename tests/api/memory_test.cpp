// SPDX-License-Identifier: Apache-2.0
// Whichever allocation fails, the call returns.
#include <isoshade/compiler.h>
#include <isoshade/runtime.h>

#include <atomic>
#include <cstdlib>
#include <gtest/gtest.h>
#include <new>

namespace {

std::atomic<long> until_failure = -1;  ///< allocations that still succeed; negative: all do

void* allocate(std::size_t bytes, std::size_t alignment) {
  if (until_failure >= 0 && until_failure.fetch_sub(1) <= 0) {
    until_failure = 0;  // all that follow fail too
    throw std::bad_alloc();
  }
  void* memory = alignment > alignof(std::max_align_t)
                     ? std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment)
                     : std::malloc(bytes == 0 ? 1 : bytes);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t bytes) { return allocate(bytes, 0); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return allocate(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace {

/// How many allocations work() makes.
template <class Work>
long allocations_of(const Work& work) {
  constexpr long many = 1L << 40;
  until_failure = many;
  work();
  return many - until_failure.exchange(-1);
}

/// Lets allocations at about 100 places fail.
template <class Work>
void fail_everywhere(const Work& work) {
  const long all = allocations_of(work);
  ASSERT_GT(all, 100);
  int failures = 0;
  for (long k = 0; k < all; k += 1 + k / 16 + all / 200) {
    until_failure = k;
    const isoshade::Status status = work();
    until_failure = -1;
    EXPECT_TRUE(status == isoshade::Status::out_of_memory || status == isoshade::Status::failed ||
                status == isoshade::Status::done)
        << "allocation " << k << " of " << all;
    failures += status == isoshade::Status::out_of_memory;
  }
  EXPECT_GT(failures, 10);
  EXPECT_EQ(work(), isoshade::Status::done);
}

const std::string graphs = ISOSHADE_GRAPHS;

TEST(Memory, RenderingReturnsWhicheverAllocationFails) {
  const std::string file = graphs + "/scenes/outline_cube.json";
  isoshade::RenderOptions options;
  options.width = 16;
  options.height = 9;
  isoshade::BackendOptions choice;
  choice.name = "interpreter";
  fail_everywhere([&] {
    isoshade::Backend interpreter;
    const isoshade::Outcome opened = interpreter.open(choice);
    if (!opened) return opened.status;
    return interpreter.render_file(file, options).status;
  });
}

TEST(Memory, CompilingReturnsWhicheverAllocationFails) {
  const std::string file = graphs + "/materials/cook_torrance.json";
  const isoshade::CompileOptions options;
  fail_everywhere([&] { return isoshade::compile_file(file, options).status; });
}

}  // namespace
