// Memory that the allocator keeps between the pieces of a plan.
#pragma once

namespace hotblade::pipeline {

// Gives the pages of freed memory back to the system, which takes 4 to 10 ms of a plan; nothing where the
// C library cannot. Before what takes large pieces, which none of the gaps between small ones hold.
void give_back_freed_memory();

}  // namespace hotblade::pipeline
