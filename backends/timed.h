// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace isoshade::backends {

/// Adds the seconds that it lives to a sum, which outlives it.
class Timed {
 public:
  explicit Timed(double& sum) : sum_(sum) {}
  ~Timed() { sum_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count(); }
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;

 private:
  double& sum_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace isoshade::backends
