// SPDX-License-Identifier: Apache-2.0
// SHA-256 (FIPS 180-4), computed by OpenSSL.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace isoshade::support {

/// Hashes the bytes added, in order. Aborts if OpenSSL does not provide SHA-256.
class Sha256 {
 public:
  Sha256();

  Sha256& add(const void* data, size_t bytes);
  Sha256& add(std::string_view text) { return add(text.data(), text.size()); }

  /// The digest of the bytes added so far, as 64 lower-case hex digits; more may be added afterwards.
  std::string hex() const;

 private:
  struct Free {
    void operator()(void* context) const;
  };
  std::unique_ptr<void, Free> context_;  ///< an EVP_MD_CTX
};

std::string sha256(std::string_view text);

}  // namespace isoshade::support
