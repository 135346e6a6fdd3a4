#include "pipeline/batch/key.hpp"

#include <fmt/format.h>

#include "pipeline/program/sha256.hpp"

namespace hotblade::pipeline::batch {

std::string key_of(const KeyParts& parts) {
  return sha256_hex(fmt::format("hotblade-batch 1\n{} {}\n{}\n{}\n{}\n{}\n{}\n", parts.version, parts.commit,
                                parts.simd, parts.settings_sha256, parts.design_sha256, parts.pictures,
                                parts.keep));
}

int chunk_of(const std::string& key, int chunks) {
  const auto first = static_cast<std::uint32_t>(std::stoul(key.substr(0, 8), nullptr, 16));
  return static_cast<int>(first % static_cast<std::uint32_t>(chunks));
}

}  // namespace hotblade::pipeline::batch
