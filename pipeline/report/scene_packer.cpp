#include "pipeline/report/scene_packer.hpp"

#include <stdexcept>
#include <vector>

#include "pipeline/program/gzip.hpp"
#include "pipeline/settings/json_text.hpp"

namespace hotblade::pipeline {

namespace {

// Small numbers of either sign become small numbers: 0, -1, 1, -2 become 0, 1, 2, 3.
std::uint32_t zigzag(std::uint32_t step, int bits) {
  const std::uint32_t mask = bits == 32 ? ~0u : (1u << bits) - 1;
  step &= mask;
  const bool negative = ((step >> (bits - 1)) & 1u) != 0;
  return (negative ? ~(step << 1) : step << 1) & mask;
}

void add_number(std::string& bytes, std::uint32_t number) {
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((number >> shift) & 0xff);
}

}  // namespace

void ScenePacker::add(const std::string& name, std::span<const std::uint32_t> numbers, int bytes,
                      Follows follows) {
  if (bytes != 1 && bytes != 2 && bytes != 4) throw std::logic_error("numbers of 1, 2 or 4 bytes");
  list_.push_back(
      {{"name", name}, {"count", numbers.size()}, {"bytes", bytes}, {"follows", static_cast<int>(follows)}});
  std::vector<std::uint32_t> coded(numbers.size());
  std::uint32_t last = 0, step = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::uint32_t now_step = numbers[i] - last;
    if (follows == Follows::kAlone) coded[i] = numbers[i];
    if (follows == Follows::kSteps) coded[i] = zigzag(now_step, 8 * bytes);
    if (follows == Follows::kBends) coded[i] = zigzag(now_step - step, 8 * bytes);
    last = numbers[i];
    step = now_step;
  }
  for (int plane = 0; plane < bytes; ++plane) {
    for (const std::uint32_t number : coded) arrays_ += static_cast<char>((number >> (8 * plane)) & 0xff);
  }
}

std::string ScenePacker::packed(nlohmann::ordered_json header) const {
  header["arrays"] = list_;
  const std::string text = json_text(header);
  std::string bytes = "HBV1";
  add_number(bytes, static_cast<std::uint32_t>(text.size()));
  return pipeline::packed(bytes + text + arrays_);
}

}  // namespace hotblade::pipeline
