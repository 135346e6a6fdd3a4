#include "robot/arm/model_file.hpp"

#include <fstream>
#include <iterator>

namespace hotblade::robot {

std::string read_model_file(const std::filesystem::path& file) {
  std::error_code code;
  std::ifstream in(file, std::ios::binary);
  std::string bytes;
  if (in && !std::filesystem::is_directory(file, code))
    bytes.assign(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  else
    in.setstate(std::ios::failbit);
  if (in.fail() || in.bad()) throw ModelError(file.string() + ": cannot be read: does the file exist?", true);
  return bytes;
}

}  // namespace hotblade::robot
