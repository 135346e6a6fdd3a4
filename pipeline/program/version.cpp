#include "pipeline/program/version.hpp"

namespace hotblade::pipeline {

std::string version() {
  return HOTBLADE_VERSION;
}

}  // namespace hotblade::pipeline
