#include "pipeline/program/sha256.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <stdexcept>

namespace hotblade::pipeline {

namespace {

[[noreturn]] void fail_sha256() {
  throw std::runtime_error("SHA-256 cannot be computed");
}

}  // namespace

struct Sha256::Context {
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> digest{EVP_MD_CTX_new(), &EVP_MD_CTX_free};
};

Sha256::Sha256() : context_(std::make_unique<Context>()) {
  if (!context_->digest || EVP_DigestInit_ex(context_->digest.get(), EVP_sha256(), nullptr) != 1)
    fail_sha256();
}

Sha256::~Sha256() = default;

void Sha256::add(std::string_view text) {
  if (EVP_DigestUpdate(context_->digest.get(), text.data(), text.size()) != 1) fail_sha256();
}

std::string Sha256::hex() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> bytes{};
  unsigned size = 0;
  if (EVP_DigestFinal_ex(context_->digest.get(), bytes.data(), &size) != 1) fail_sha256();
  std::string text;
  for (unsigned i = 0; i < size; ++i) text += fmt::format("{:02x}", bytes[i]);
  return text;
}

std::string sha256_hex(std::string_view text) {
  Sha256 sha256;
  sha256.add(text);
  return sha256.hex();
}

}  // namespace hotblade::pipeline
