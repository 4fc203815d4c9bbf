// SPDX-License-Identifier: Apache-2.0
// What the Vulkan backend keeps between runs, and between uploads.
#include <cstring>
#include <filesystem>

#include "backends/vulkan/device.h"
#include "backends/vulkan/disk_cache.h"
#include "backends/vulkan/limits.h"
#include "tests/unit/cpu_folders.h"
#include "tests/unit/vulkan_shaders.h"

namespace isoshade::vulkan {
namespace {

using cpu::TestFolder;
using support::Diagnostics;

/// The paths of the entries of this kind.
std::vector<std::string> entries(const TestFolder& folder, const std::string& ending) {
  std::vector<std::string> paths;
  for (const auto& file : std::filesystem::directory_iterator(folder.path()))
    if (file.path().extension() == ending) paths.push_back(file.path().string());
  return paths;
}

void damage(const std::string& path) {
  std::string text = cpu::read_text(path);
  text[text.size() / 3] ^= 1;
  cpu::write_text(path, text);
}

Probe passed_probe() {
  Probe probe;
  probe.division = driver::Division::native;
  probe.checks = {{"floor (vertex)", true, "5 rows, every bit as expected"}, {"integers", true, ""}};
  return probe;
}

TEST(ProbeText, HoldsTheWholeResult) {
  Probe probe = passed_probe();
  for (const driver::Division division : {driver::Division::native, driver::Division::exact}) {
    probe.division = division;
    const auto read = probe_from_text(to_text(probe));
    ASSERT_TRUE(read);
    EXPECT_EQ(read->division, division);
    ASSERT_EQ(read->checks.size(), probe.checks.size());
    for (size_t i = 0; i < probe.checks.size(); ++i) {
      EXPECT_EQ(read->checks[i].name, probe.checks[i].name);
      EXPECT_EQ(read->checks[i].detail, probe.checks[i].detail);
      EXPECT_TRUE(read->checks[i].passed);
    }
  }
}

TEST(ProbeText, RejectsWhatIsNoResult) {
  for (const char* text : {"", "division native\n", "division native", "division none\na\tb\n", "a\tb\n",
                           "division exact\na\tb", "division exact\na b\n", "division exact\n\tb\n"})
    EXPECT_FALSE(probe_from_text(text)) << text;
}

TEST(VulkanDiskCache, KeepsProbesOfDevicesThatPassed) {
  const TestFolder folder;
  const DiskCache cache(folder.path());
  Probe failed = passed_probe();
  failed.checks[0].passed = false;
  cache.keep(failed, "device");
  EXPECT_FALSE(cache.probe("device")) << "a device that fails is probed at each start";
  cache.keep(passed_probe(), "device");
  EXPECT_FALSE(cache.probe("device with a new driver"));
  const auto read = cache.probe("device");
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->cached);
  EXPECT_TRUE(read->passed());
  ASSERT_EQ(entries(folder, ".probe").size(), 1u);
  damage(entries(folder, ".probe")[0]);
  EXPECT_FALSE(cache.probe("device"));
}

TEST(VulkanDiskCache, ReadsShadersThatItKeptAndCompilesDamagedOnesAgain) {
  const TestFolder folder;
  const DiskCache cache(folder.path());
  const std::string text = full_screen_vertex();
  Diagnostics diagnostics;
  const auto compile = [&] { return cache.spirv(text, glsl::ShaderKind::vertex, diagnostics, "a shader"); };
  const auto expected = glsl::compile_spirv(text, glsl::ShaderKind::vertex, diagnostics);
  ASSERT_TRUE(expected);
  EXPECT_EQ(compile(), expected);
  ASSERT_EQ(entries(folder, ".spv").size(), 1u);
  const std::string path = entries(folder, ".spv")[0];
  EXPECT_EQ(compile(), expected);

  // Another module under the entry's name shows that it is read.
  std::vector<uint32_t> other = *expected;
  other.back() += 1;
  const auto store = [&](size_t bytes) {
    backends::Cache::open(folder.path(), diagnostics)
        ->keep(std::filesystem::path(path).filename(), {reinterpret_cast<const char*>(other.data()), bytes});
  };
  store(4 * other.size());
  EXPECT_EQ(compile(), other);
  store(4 * other.size() - 1);
  EXPECT_EQ(compile(), expected) << "half a word";
  damage(path);
  EXPECT_EQ(compile(), expected);
  EXPECT_EQ(entries(folder, ".spv").size(), 1u);
  EXPECT_TRUE(diagnostics.all().empty()) << diagnostics.text();
}

TEST(VulkanDiskCache, CompilesWithoutAFolder) {
  const DiskCache cache("/dev/null/nowhere");
  Diagnostics diagnostics;
  EXPECT_TRUE(cache.spirv(full_screen_vertex(), glsl::ShaderKind::vertex, diagnostics, "a shader"));
  cache.keep(passed_probe(), "device");
  EXPECT_FALSE(cache.probe("device"));
  EXPECT_TRUE(cache.pipelines("device").empty());
  EXPECT_TRUE(diagnostics.all().empty()) << diagnostics.text();
}

TEST(VulkanDiskCache, KeepsPipelinesUpToALimit) {
  const TestFolder folder;
  const DiskCache cache(folder.path());
  EXPECT_TRUE(cache.pipelines("device").empty());
  cache.keep_pipelines(std::string(DiskCache::max_pipeline_bytes + 1, 'x'), "device");
  EXPECT_TRUE(cache.pipelines("device").empty());
  cache.keep_pipelines("what the driver compiled", "device");
  EXPECT_EQ(cache.pipelines("device"), "what the driver compiled");
  EXPECT_TRUE(cache.pipelines("another device").empty());
}

TEST(VulkanProbeCache, SparesADeviceThatPassedAndProbesAnewOnDemandOrDamage) {
  const TestFolder folder;
  Diagnostics diagnostics;
  VulkanOptions options;
  options.cache = folder.path();
  const auto probe = [&] {
    const auto backend = create(options, diagnostics);
    if (backend == nullptr) ADD_FAILURE() << diagnostics.text();
    return backend == nullptr ? Probe{} : backend->probe();
  };
  const Probe first = probe();
  EXPECT_FALSE(first.cached);
  const Probe second = probe();
  EXPECT_TRUE(second.cached);
  EXPECT_EQ(to_text(second), to_text(first));
  options.probe_anew = true;
  EXPECT_FALSE(probe().cached);
  options.probe_anew = false;
  ASSERT_EQ(entries(folder, ".probe").size(), 1u);
  damage(entries(folder, ".probe")[0]);
  EXPECT_FALSE(probe().cached);
  EXPECT_TRUE(probe().cached) << "kept again";
  const cpu::TestVariable changed("LP_ISOSHADE_TEST", "1");
  EXPECT_FALSE(probe().cached) << "drivers read such variables";
}

TEST(VulkanUpload, OfTheSameRevisionIsSkipped) {
  for (const bool own_memory : {false, true}) {
    Diagnostics diagnostics;
    VulkanOptions options;
    options.own_memory = own_memory;
    const auto device = Device::open(options, diagnostics);
    ASSERT_NE(device, nullptr) << diagnostics.text();
    const auto pipeline = device->pipeline({Output::words, 1, full_screen_vertex(), interface_glsl() + R"(
layout(location = 0) out ivec4 result;
void main() { result = ivec4(inputs[0]); }
)"},
                                           diagnostics);
    ASSERT_TRUE(pipeline) << diagnostics.text();
    const auto result_of = [&](int32_t input, uint64_t revision) {
      device->upload(lower::FrameBuffer::inputs, &input, sizeof input, {revision, sizeof input});
      int32_t result = 0;
      device->run_table(*pipeline, 1, 1, 1, {&result, 1});
      return result;
    };
    EXPECT_EQ(result_of(10, 7), 10);
    EXPECT_EQ(result_of(11, 7), 10) << "the caller said that nothing changed";
    EXPECT_EQ(result_of(12, 8), 12);
    EXPECT_EQ(result_of(13, 0), 13);
    EXPECT_EQ(result_of(14, 0), 14) << "without a revision, contents are compared";
    EXPECT_EQ(result_of(15, 8), 15) << "another upload came between";
  }
}

}  // namespace
}  // namespace isoshade::vulkan
