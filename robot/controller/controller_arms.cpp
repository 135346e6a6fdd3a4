// The arms that a job declares: who may say what they are, and what has to be known of them before anything
// moves.
#include <algorithm>

#include "robot/controller/controller.hpp"

namespace hotblade::robot {

using protocol::Result;
using protocol::State;

Result Controller::arms(const protocol::DecodedArms& decoded, Connection from, std::uint64_t now_us) {
  move_to(now_us);
  return last_result_ = judge_arms(decoded, from);
}

// Until the motion starts they may be said anew. A controller whose log knows none, as it was started without
// a cell before, takes them while it stands.
Result Controller::judge_arms(const protocol::DecodedArms& decoded, Connection from) {
  if (!decoded.crc_ok) return Result::kBadCrc;
  if (!loaded_ || !options_.arms) return Result::kState;
  if (!owns(decoded.arms.token)) return Result::kBadToken;
  feed(from);
  const bool same = job_.arms && job_.arms->cell_id == decoded.arms.cell_id &&
                    job_.arms->joints_rad == decoded.arms.joints_rad;
  if (same) return Result::kOk;
  if (state_ != State::kOpen && (state_ != State::kHeld || job_.arms)) return Result::kState;
  if (const Result taken = take_arms(decoded.arms); taken != Result::kOk) {
    job_.arms.reset();
    job_.accepted_arms = job_.moved_arms = {};
    return taken;
  }
  // What was missing has been said: the next STATE has another reason.
  if (fault_detail_ == info(Limit::kCell).code) {
    fault_detail_ = 0;
    fault_sequence_ = 0;
    fault_arms_ = {};
  }
  report("arms");
  return Result::kOk;
}

// What was accepted before is looked at now, without the blade, whose shape there is known no more: the
// motion asks for it.
Result Controller::take_arms(const protocol::Arms& declared) {
  job_.arms = declared;
  job_.accepted_arms =
      ArmCheck(options_.arms, declared, job_.id, job_.blade.width_mm, options_.blade.offsets.a);
  job_.moved_arms = job_.accepted_arms;
  for (std::uint32_t i = 0; i < job_.accepted(); ++i) {
    const Waypoint waypoint = protocol::decode_waypoint(job_.raw[i]).waypoint;
    const Breach broken = job_.accepted_arms.next(waypoint, std::nullopt);
    if (broken.limit != Limit::kNone) return limit(broken, i);
    if (i + 1 == job_.executed) job_.moved_arms = job_.accepted_arms;
  }
  // The blade may stand many waypoints back, where it went to be reheated.
  for (std::uint32_t i = job_.executed; i-- > step_;) {
    const Waypoint passed = protocol::decode_waypoint(job_.raw[i]).waypoint;
    (void)job_.moved_arms.move_to(passed.a, passed.b, std::nullopt, 0);
  }
  if (job_.accepted() < job_.count) return Result::kOk;
  const Breach broken = ArmCheck(job_.accepted_arms).finish();
  return broken.limit == Limit::kNone ? Result::kOk : limit(broken, job_.count - 1);
}

// Whether nothing may move because the arms were not declared, or are others.
bool Controller::arms_unknown() {
  if (!options_.arms || (job_.arms && job_.accepted_arms.fits())) return false;
  fault_detail_ = info(Limit::kCell).code;
  fault_sequence_ = 0;
  fault_arms_ = {};
  return true;
}

}  // namespace hotblade::robot
