#include "pipeline/cli/command.hpp"

int main(int argc, char** argv) {
  return hotblade::pipeline::run_command_line(argc, argv);
}
