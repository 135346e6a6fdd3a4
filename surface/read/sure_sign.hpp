// The sign of an area that rounding cannot have made.
#pragma once

#include <cmath>

namespace hotblade::surface {

// The sign of left - right, where each is a product of two differences of coordinates; 0 where rounding may
// have made it. The area of two differences is off by less than 3.4e-16 of its terms; what is smaller than
// the least may have lost digits at the bottom.
inline int sure_sign(double left, double right) {
  constexpr double kRounding = 4e-16, kLeast = 1e-280;
  const double doubt = kRounding * (std::abs(left) + std::abs(right)) + kLeast, difference = left - right;
  return difference > doubt ? 1 : (difference < -doubt ? -1 : 0);
}

}  // namespace hotblade::surface
