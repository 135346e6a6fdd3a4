#include "pipeline/program/freed_memory.hpp"

#include <cstdlib>  // says whether this is the GNU library
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace hotblade::pipeline {

void give_back_freed_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace hotblade::pipeline
