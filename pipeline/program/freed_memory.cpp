#include "pipeline/program/freed_memory.hpp"

#include <cstdlib>  // says whether this is the GNU library
#ifdef __GLIBC__
#include <malloc.h>
#include <unistd.h>

#include <fstream>
#endif

namespace hotblade::pipeline {

#ifdef __GLIBC__
namespace {

// 0 where the system does not say.
long resident_bytes() {
  std::ifstream sizes("/proc/self/statm");
  long all = 0, resident = 0;
  return sizes >> all >> resident ? resident * sysconf(_SC_PAGESIZE) : 0;
}

}  // namespace
#endif

void give_back_freed_memory() {
#ifdef __GLIBC__
  constexpr long kMuch = 128L << 20;
  if (resident_bytes() >= kMuch) malloc_trim(0);
#endif
}

}  // namespace hotblade::pipeline
