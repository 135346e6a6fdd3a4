// Memory that the allocator keeps between the pieces of a plan.
#pragma once

namespace hotblade::pipeline {

// Gives the pages of freed memory back to the system where the process holds 128 MB or more, before what
// takes large pieces, which none of the gaps between small ones hold; nothing where the C library cannot. Of
// a smaller process most would soon come back anew, each for a microsecond to ten.
void give_back_freed_memory();

}  // namespace hotblade::pipeline
