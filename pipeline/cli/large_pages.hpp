// Memory in pages of 2 MB, where the system gives those to who asks ("madvise" in
// /sys/kernel/mm/transparent_hugepage/enabled).
#pragma once

namespace hotblade::pipeline {

// Has the process ask for large pages from then on, and keep what it frees: call it once, before threads are
// started. Does nothing where the C library is not the GNU one, or a sanitizer allocates.
void use_large_pages();

}  // namespace hotblade::pipeline
