#include "pipeline/program/forming_gap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace hotblade::pipeline {

std::optional<FormingGap> forming_gap(const Strip& strip) {
  const auto has_foam = [](const BladePose& pose) { return pose.foam.has_value(); };
  const auto forms = [](const BladePose& pose) { return pose.heat && pose.foam; };
  const auto begin = std::ranges::find_if(strip.poses, has_foam);
  const auto end = std::find_if(strip.poses.rbegin(), strip.poses.rend(), has_foam).base();
  const auto first = std::find_if_not(begin, std::max(begin, end), forms);
  if (first == std::max(begin, end)) return std::nullopt;
  const auto behind = std::find_if(first, end, forms);
  const auto index = [&](auto pose) { return static_cast<std::size_t>(pose - strip.poses.begin()); };
  return FormingGap{index(first), index(behind) - 1, !first->heat};
}

std::string describe(const Strip& strip, const FormingGap& gap) {
  const BladePose& from = strip.poses[gap.first];
  const double to_s = strip.poses[std::min(gap.last + 1, strip.poses.size() - 1)].t;
  return fmt::format(
      "{}: the blade {} for {:.2f} s of its cut in phase {} at {:.2f} s, pose {}: what it passes there stays "
      "uncut",
      strip.id, gap.cold ? "is cold (heat)" : "forms nothing (foam)", to_s - from.t, name(from.phase), from.t,
      gap.first);
}

}  // namespace hotblade::pipeline
