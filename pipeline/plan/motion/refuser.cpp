#include "pipeline/plan/motion/refuser.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/sayings/saying.hpp"

namespace hotblade::pipeline {

void Refuser::operator()(std::size_t i, Limit limit, double value, double bound, std::string note) {
  const BladePose& pose = motion_.poses[i];
  Refusal refusal{strip_.id, pose.foam ? rib_name(pose) : "", limit, value, bound, std::move(note)};
  refusal.when = say(Saying::kInPhase, {name(pose.phase), pose.t});
  refusal.at = middle_of(pose);
  motion_.refusals.push_back(std::move(refusal));
}

std::string Refuser::rib_name(const BladePose& pose) const {
  const double offset = strip_.offset(pose.frame);
  const auto nearest =
      std::min_element(strip_.ribs.begin(), strip_.ribs.end(), [&](const RibFit& p, const RibFit& q) {
        return std::abs(p.offset_mm - offset) < std::abs(q.offset_mm - offset);
      });
  return rib_id(strip_.id, static_cast<std::size_t>(nearest - strip_.ribs.begin()));
}

}  // namespace hotblade::pipeline
