// From where a blade counts as pulled straight by its clamps.
#pragma once

namespace hotblade::elastica {

// Chord over length from which a blade is straight but for less than its thickness or so: the equations for
// its force become singular, errors along it move it to second order, and its shape is a straight line
// whatever the force.
inline constexpr double kTautChord = 1 - 1e-6;

// Slack over length below which a blade is nearly straight: ten times that of a taut one. Its shape still
// follows from its clamps, but registers and clamps' errors move it more than first derivatives say.
inline constexpr double kNearlyTautSlack = 1e-5;

}  // namespace hotblade::elastica
