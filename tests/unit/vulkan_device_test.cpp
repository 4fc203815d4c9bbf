// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <gtest/gtest.h>

#include "backends/vulkan/backend.h"

namespace isoshade::vulkan {
namespace {

class Devices : public testing::Test {
 protected:
  void SetUp() override { setenv("ISOSHADE_VALIDATION", "1", 1); }

  support::Diagnostics diagnostics;
};

TEST_F(Devices, AreListedByIndex) {
  const std::vector<DeviceInfo> devices = list_devices(diagnostics);
  ASSERT_FALSE(devices.empty()) << diagnostics.text();
  for (size_t i = 0; i < devices.size(); ++i) {
    EXPECT_EQ(devices[i].index, static_cast<int>(i));
    EXPECT_FALSE(devices[i].name.empty());
    EXPECT_FALSE(devices[i].driver.empty());
  }
}

TEST_F(Devices, DefaultIsASoftwareDeviceIfAvailable) {
  const std::vector<DeviceInfo> devices = list_devices(diagnostics);
  const auto backend = create({}, diagnostics);
  ASSERT_NE(backend, nullptr) << diagnostics.text();
  EXPECT_EQ(backend->device().cpu,
            std::any_of(devices.begin(), devices.end(), [](const DeviceInfo& device) { return device.cpu; }));
}

TEST_F(Devices, DefaultPassesTheProbe) {
  const auto backend = create({}, diagnostics);
  ASSERT_NE(backend, nullptr) << diagnostics.text();
  for (const Check& check : backend->probe().checks)
    EXPECT_TRUE(check.passed) << check.name << ": " << check.detail;
  EXPECT_EQ(backend->division(), backend->probe().division);
  EXPECT_FALSE(diagnostics.has_errors()) << diagnostics.text();
}

TEST_F(Devices, LavapipeDividesNatively) {
  VulkanOptions options;
  options.device = "llvmpipe";
  const auto backend = create(options, diagnostics);
  if (backend == nullptr) GTEST_SKIP() << "lavapipe is not installed";
  EXPECT_EQ(backend->division(), driver::Division::native);
  EXPECT_NE(backend->description().find("native division"), std::string::npos) << backend->description();
}

TEST_F(Devices, AreSelectedByIndexOrCaseInsensitiveName) {
  const std::vector<DeviceInfo> devices = list_devices(diagnostics);
  ASSERT_FALSE(devices.empty());
  std::string part = devices[0].name.substr(0, 5);
  for (char& c : part) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  for (const std::string& selector : {std::string("0"), part}) {
    VulkanOptions options;
    options.device = selector;
    options.division = driver::Division::exact;
    const auto backend = create(options, diagnostics);
    ASSERT_NE(backend, nullptr) << diagnostics.text();
    EXPECT_EQ(backend->device().name, devices[0].name);
    EXPECT_EQ(backend->division(), driver::Division::exact) << "as the options say";
  }
}

TEST_F(Devices, MatchTheirIndexOrCaseInsensitiveName) {
  DeviceInfo info;
  info.index = 3;
  info.name = "NVIDIA H200";
  for (const char* selector : {"3", "03", "nvidia", "H200", "h2"})
    EXPECT_TRUE(matches(info, selector)) << selector;
  for (const char* selector : {"2", "33", "llvmpipe", "-3"})
    EXPECT_FALSE(matches(info, selector)) << selector;
}

TEST_F(Devices, UnknownSelectorsListTheAvailableDevices) {
  for (const std::string selector : {"no such device", "99", "-1", "12345678901234567890"}) {
    support::Diagnostics report;
    VulkanOptions options;
    options.device = selector;
    EXPECT_EQ(create(options, report), nullptr) << selector;
    ASSERT_EQ(report.all().size(), 1u) << report.text();
    EXPECT_EQ(report.all()[0].id, support::Id::no_device);
    EXPECT_FALSE(report.all()[0].notes.empty());
  }
}

TEST_F(Devices, MissingDriverErrorSaysWhatToInstall) {
  // Later loaders read the first, earlier ones the second.
  setenv("VK_DRIVER_FILES", "/nonexistent.json", 1);
  setenv("VK_ICD_FILENAMES", "/nonexistent.json", 1);
  EXPECT_EQ(create({}, diagnostics), nullptr);
  EXPECT_TRUE(list_devices(diagnostics).empty());
  unsetenv("VK_DRIVER_FILES");
  unsetenv("VK_ICD_FILENAMES");
  ASSERT_EQ(diagnostics.all().size(), 2u) << diagnostics.text();
  for (const support::Diagnostic& report : diagnostics.all()) {
    EXPECT_EQ(report.id, support::Id::no_device);
    EXPECT_NE(report.fix.find("mesa-vulkan-drivers"), std::string::npos);
  }
}

}  // namespace
}  // namespace isoshade::vulkan
