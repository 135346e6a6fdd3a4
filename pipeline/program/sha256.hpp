// The SHA-256 of a text, whole or in pieces.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace hotblade::pipeline {

class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void add(std::string_view text);
  // Returns it in lower-case hex, once.
  [[nodiscard]] std::string hex();

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

[[nodiscard]] std::string sha256_hex(std::string_view text);

}  // namespace hotblade::pipeline
