// The key of a plan: everything that its result depends on, hashed. A plan whose key has a result is not made
// again.
#pragma once

#include <cstdint>
#include <string>

namespace hotblade::pipeline::batch {

struct KeyParts {
  std::string version, commit;  // of the program
  std::string simd;             // results of different instruction sets differ by rounding
  std::string settings_sha256;  // of all settings, as `hotblade config show` prints them
  std::string design_sha256;    // of the panel's text
  std::string pictures, keep;   // what is drawn, and what is kept, packed or not
};

// Returns 64 hexadecimal digits.
[[nodiscard]] std::string key_of(const KeyParts& parts);

// Returns the chunk that a key belongs to: its first 32 bits modulo the number of chunks, so that a new panel
// changes one.
[[nodiscard]] int chunk_of(const std::string& key, int chunks);

}  // namespace hotblade::pipeline::batch
