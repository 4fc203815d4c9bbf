// SPDX-License-Identifier: Apache-2.0
#include "compiler/support/sha256.h"

#include <openssl/evp.h>

#include "compiler/support/assert.h"

namespace isoshade::support {
namespace {

void require(bool worked) { assert_that(worked, "OpenSSL cannot compute SHA-256"); }

EVP_MD_CTX* context_of(void* context) { return static_cast<EVP_MD_CTX*>(context); }

}  // namespace

void Sha256::Free::operator()(void* context) const { EVP_MD_CTX_free(context_of(context)); }

Sha256::Sha256() : context_(EVP_MD_CTX_new()) {
  require(context_ != nullptr && EVP_DigestInit_ex(context_of(context_.get()), EVP_sha256(), nullptr) == 1);
}

Sha256& Sha256::add(const void* data, size_t bytes) {
  require(EVP_DigestUpdate(context_of(context_.get()), data, bytes) == 1);
  return *this;
}

std::string Sha256::hex() const {
  // EVP_DigestFinal_ex invalidates its context, so finalise a copy.
  const std::unique_ptr<void, Free> copy(EVP_MD_CTX_new());
  require(copy != nullptr && EVP_MD_CTX_copy_ex(context_of(copy.get()), context_of(context_.get())) == 1);
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  require(EVP_DigestFinal_ex(context_of(copy.get()), digest, &size) == 1 && size == 32);
  std::string text;
  for (unsigned int i = 0; i < size; ++i) {
    constexpr char digits[] = "0123456789abcdef";
    text += digits[digest[i] >> 4];
    text += digits[digest[i] & 15];
  }
  return text;
}

std::string sha256(std::string_view text) { return Sha256().add(text).hex(); }

}  // namespace isoshade::support
