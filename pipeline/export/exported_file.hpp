// A file made for another program: its name below the directory asked for, and its text.
#pragma once

#include <string>
#include <vector>

namespace hotblade::pipeline {

struct ExportedFile {
  std::string name;
  std::string text;
};

}  // namespace hotblade::pipeline
