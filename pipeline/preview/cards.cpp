// What the window says of a strip, a rib or a pose.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "elastica/curve/elastica.hpp"
#include "pipeline/preview/view_model.hpp"
#include "robot/blade/blade_section.hpp"

namespace hotblade::pipeline::preview {
namespace {

double largest_curvature(const elastica::Elastica& curve) {
  return elastica::ElasticaCurve(curve).max_abs_curvature();
}

std::string radius_line(double curvature, const robot::Blade& blade) {
  constexpr double kStraightMm = 1e5;  // a hundred metres: nobody reads more of it
  const double radius = curvature > 1 / kStraightMm ? 1 / curvature : kStraightMm;
  const double share = 100 * curvature / robot::max_curvature_per_mm(blade, 1);
  if (radius >= kStraightMm) return "smallest radius over 100 m";
  return fmt::format("smallest radius {:.0f} mm ({:.0f} % yield)", radius, share);
}

// Deviations of the cut at vertices that `belongs` takes.
template <class Belongs>
void add_deviation(const ViewModel& model, const Belongs& belongs, Card& card) {
  const auto found = model.colorings.find(Color::kDeviation);
  if (found == model.colorings.end()) {
    card.lines.emplace_back("deviation not measured: no design");
    return;
  }
  double low = 0, high = 0;
  bool any = false;
  for (std::size_t i = 0; i < found->second.values.size(); ++i) {
    if (!belongs(i)) continue;
    const double value = found->second.values[i];
    low = any ? std::min(low, value) : value;
    high = any ? std::max(high, value) : value;
    any = true;
  }
  card.lines.push_back(any ? fmt::format("deviation {:+.2f} to {:+.2f} mm", low, high)
                           : "deviation: nothing is cut here");
}

void add_worst(Card& card, std::span<const BladePose> poses, const robot::Blade& blade) {
  double curvature = 0, margin = poses.front().margin;
  float stress = 0, force = 0;
  bool loads = false;
  std::optional<double> margin_mm;
  for (const BladePose& pose : poses) {
    curvature = std::max(curvature, largest_curvature(pose.blade));
    margin = std::min(margin, pose.margin);
    if (pose.margin_mm) margin_mm = std::min(margin_mm.value_or(*pose.margin_mm), *pose.margin_mm);
    if (!pose.loads) continue;
    loads = true;
    stress = std::max(stress, pose.loads->stress_mpa);
    force = std::max(force, pose.loads->force_n);
  }
  card.lines.push_back(radius_line(curvature, blade));
  card.lines.push_back(loads ? fmt::format("force {:.2f} N, stress {:.0f} MPa", force, stress)
                             : "load not computed");
  card.lines.push_back(fmt::format("stability margin {:.1f}", margin) +
                       (margin_mm ? fmt::format(", {:.2f} mm", *margin_mm) : ""));
}

std::string degrees(double rad) {
  return fmt::format("{:.1f} deg", rad / robot::kDegree_rad);
}

// How both arms do through a strip: the joint nearest its limit, and what comes nearest to what.
void add_arms(const Strip& strip, Card& card) {
  if (!strip.arms) return;
  const StripArms& arms = *strip.arms;
  const StripArms::Nearest& joint = arms.joint_margin_rad;
  card.lines.push_back(fmt::format("{} at A, {} at B: {} J{} {} from its limit", arms.a.arm, arms.b.arm,
                                   joint.arm, joint.joint, degrees(joint.value)));
  const auto nearest = std::min_element(arms.nearest_mm.begin(), arms.nearest_mm.end(),
                                        [](const auto& a, const auto& b) { return a.mm < b.mm; });
  if (nearest != arms.nearest_mm.end())
    card.lines.push_back(fmt::format("nearest {} {:.0f} mm at {:.1f} s", robot::pair_words(nearest->kind),
                                     nearest->mm, nearest->t));
}

// The joint that is nearest to its limit at a pose.
void add_joint(const Program& program, const Strip& strip, std::size_t pose, Card& card) {
  if (!program.cell || !strip.arms || strip.joints.empty()) return;
  double least = 1e9;
  std::string which;
  for (const bool b : {false, true}) {
    const HeldClamp& held = b ? strip.arms->b : strip.arms->a;
    const ProgramArm& arm = program.cell->arms[program.cell->arms[0].id == held.arm ? 0 : 1];
    for (std::size_t i = 0; i < kArmJoints; ++i) {
      const double q = b ? strip.joints[pose].b[i] : strip.joints[pose].a[i];
      const double margin = std::min(q - arm.joints[i].min_rad, arm.joints[i].max_rad - q);
      if (margin >= least) continue;
      least = margin;
      which = fmt::format("{} J{}", arm.id, i + 1);
    }
  }
  card.lines.push_back(which + " " + degrees(least) + " from its limit");
}

Card strip_card(const ViewModel& model, const Selection& selection) {
  const Strip& strip = model.program.strips[static_cast<std::size_t>(selection.strip)];
  Card card{"strip " + strip.id, {}};
  card.lines.push_back(fmt::format("blade {:g} mm, {} ribs", strip.blade_length_mm, strip.ribs.size()));
  add_deviation(
      model, [&](std::size_t i) { return model.scene.cut.strip_of_vertex[i] == selection.strip; }, card);
  add_worst(card, strip.poses, model.program.blade);
  card.lines.push_back(
      fmt::format("{:.1f} s, {} poses", strip.poses.back().t - strip.poses.front().t, strip.poses.size()));
  add_arms(strip, card);
  return card;
}

Card rib_card(const ViewModel& model, const Selection& selection) {
  const Strip& strip = model.program.strips[static_cast<std::size_t>(selection.strip)];
  const Rib& rib = strip.ribs[static_cast<std::size_t>(selection.index)];
  Card card{"rib " + rib.id, {}};
  card.lines.push_back(fmt::format("deviation {:.2f} mm from its section", rib.design_deviation_mm));
  card.lines.push_back(
      fmt::format("length {:.0f} mm, residual {:.2g}", rib.elastica.length, rib.lambda_residual));
  const auto at = std::find_if(strip.poses.begin(), strip.poses.end(), [&](const BladePose& pose) {
    return pose.rib == std::optional<int>(selection.index);
  });
  if (at == strip.poses.end()) {
    card.lines.push_back(radius_line(largest_curvature(rib.elastica), model.program.blade));
    card.lines.emplace_back("no pose is at this rib");
    return card;
  }
  add_worst(card, {&*at, 1}, model.program.blade);
  card.lines.push_back(fmt::format("at {:.2f} s", at->t - strip.poses.front().t));
  return card;
}

Card pose_card(const ViewModel& model, const Selection& selection) {
  const Strip& strip = model.program.strips[static_cast<std::size_t>(selection.strip)];
  const BladePose& pose = strip.poses[static_cast<std::size_t>(selection.index)];
  Card card{fmt::format("{} pose {} of {}", strip.id, selection.index + 1, strip.poses.size()), {}};
  card.lines.push_back(fmt::format("at {:.2f} s, {}", pose.t - strip.poses.front().t, name(pose.phase)));
  // The surface has a row every few poses: the nearest one before is meant.
  int row = -1;
  const CutSurface& cut = model.scene.cut;
  for (std::size_t i = 0; pose.foam && i < cut.vertices.size(); ++i) {
    if (cut.strip_of_vertex[i] == selection.strip && cut.pose_of_vertex[i] <= selection.index)
      row = std::max(row, cut.pose_of_vertex[i]);
  }
  const auto belongs = [&](std::size_t i) {
    return cut.strip_of_vertex[i] == selection.strip && cut.pose_of_vertex[i] == row;
  };
  add_deviation(model, belongs, card);
  add_worst(card, {&pose, 1}, model.program.blade);
  if (pose.loads) {
    card.lines.push_back(
        fmt::format("moments {:.0f}, {:.0f} N mm", pose.loads->moment_a_n_mm, pose.loads->moment_b_n_mm));
    card.lines.push_back(fmt::format("droop {:.2f} mm", pose.loads->droop_mm));
  }
  add_joint(model.program, strip, static_cast<std::size_t>(selection.index), card);
  return card;
}

}  // namespace

Card card_of(const ViewModel& model, const Selection& selection) {
  if (selection.part == Part::kStrip) return strip_card(model, selection);
  if (selection.part == Part::kRib) return rib_card(model, selection);
  if (selection.part == Part::kPose) return pose_card(model, selection);
  return {};
}

}  // namespace hotblade::pipeline::preview
