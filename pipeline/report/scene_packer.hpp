// Packs lists of numbers and a header into the bytes of a view's scene (viewer_scene.hpp says how).
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

namespace hotblade::pipeline {

// How an array's numbers follow each other: each as it is, as the step from the one before, or as the change
// of that step.
enum class Follows { kAlone, kSteps, kBends };

class ScenePacker {
 public:
  // Adds an array of numbers of 1, 2 or 4 bytes under a name.
  void add(const std::string& name, std::span<const std::uint32_t> numbers, int bytes, Follows follows);

  // Returns header and arrays, packed as pipeline/program/gzip.hpp packs.
  [[nodiscard]] std::string packed(nlohmann::ordered_json header) const;

 private:
  nlohmann::ordered_json list_ = nlohmann::ordered_json::array();
  std::string arrays_;
};

}  // namespace hotblade::pipeline
