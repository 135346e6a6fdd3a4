// The generated table behind valleys_near (project_valleys.hpp).
#pragma once

#include <cstdint>

#include "elastica/projection/project_valleys.hpp"

namespace hotblade::elastica {

// Valleys of cell (i, j), i of a1: kValleys[kFirstValley[k]] to before kValleys[kFirstValley[k + 1]], with
// k = (branch * kValleyNodes + i) * kValleyNodes + j and branch the number of the WantedBranch.
extern const Valley kValleys[];
extern const std::uint32_t kFirstValley[];

}  // namespace hotblade::elastica
