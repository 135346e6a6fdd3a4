#include "robot/arm/model_file.hpp"

#include <array>
#include <fstream>

namespace hotblade::robot {

std::string read_model_file(const std::filesystem::path& file, std::size_t most) {
  std::error_code code;
  std::ifstream in(file, std::ios::binary);
  std::string bytes;
  const bool opened = in && !std::filesystem::is_directory(file, code);
  std::array<char, 1 << 14> block;
  while (opened && bytes.size() <= most && (in.read(block.data(), block.size()) || in.gcount() > 0))
    bytes.append(block.data(), static_cast<std::size_t>(in.gcount()));
  if (!opened || in.bad()) throw ModelError(file.string() + ": cannot be read: does the file exist?", true);
  if (bytes.size() > most)
    throw ModelError(file.string() + ": longer than " + std::to_string(most) + " bytes: is this the file?");
  return bytes;
}

}  // namespace hotblade::robot
