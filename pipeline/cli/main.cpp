#include "pipeline/cli/command.hpp"
#include "pipeline/cli/large_pages.hpp"

int main(int argc, char** argv) {
  hotblade::pipeline::use_large_pages();
  return hotblade::pipeline::run_command_line(argc, argv);
}
