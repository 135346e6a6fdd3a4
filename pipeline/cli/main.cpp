#include <cstdlib>  // says whether this is the GNU library
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "pipeline/cli/command.hpp"

namespace {

// A plan makes and drops pieces of memory all the time. Kept by the allocator they serve again: handed back,
// a fifth of all pages came anew from the system, 0.02 s of 0.7. Those of a megabyte and more, a strip's
// poses among them, are mapped by themselves and leave no gaps (docs/benchmarks.md).
void keep_memory() {
#ifdef __GLIBC__
  constexpr int kMb = 1 << 20;
  mallopt(M_MMAP_THRESHOLD, kMb);
  mallopt(M_TRIM_THRESHOLD, 32 * kMb);
  mallopt(M_TOP_PAD, 16 * kMb);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  keep_memory();
  return hotblade::pipeline::run_command_line(argc, argv);
}
