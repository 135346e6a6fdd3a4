#include "pipeline/plan/motion/blade_path.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <tuple>

#include "elastica/blade/blade_batch.hpp"
#include "elastica/blade/stability.hpp"
#include "pipeline/plan/motion/blocks.hpp"
#include "pipeline/plan/motion/travel.hpp"
#include "pipeline/plan/ribs/fade.hpp"
#include "pipeline/plan/ribs/rib_spline.hpp"
#include "pipeline/program/clamps.hpp"
#include "robot/pose/flat_arc.hpp"

namespace hotblade::pipeline {

namespace {

using elastica::Elastica;
using elastica::MidState;

// Half of what the flat arc turns by that every strip starts and ends with.
constexpr double kFlatHalfTurn = 0.13;
static_assert(kFlatHalfTurn > robot::kFlatArcLeastHalfTurn_rad &&
              kFlatHalfTurn < robot::kFlatArcMostHalfTurn_rad);

// The blade at a place of the sweep: the rib there, extended.
BladePlace place_at(const StripPlan& strip, const RibSpline& spline, double offset_mm) {
  const MidState mid = spline.mid_at(offset_mm);
  const double before = strip.share_a * (strip.blade_length_mm - mid.length);
  const DesignPart formed = strip.formed_at(offset_mm);
  return {offset_mm,
          half_from_middle(mid),
          -0.5 * mid.length - before,
          strip.blade_length_mm,
          before + formed.first * mid.length,
          before + formed.last * mid.length,
          true,
          before,
          before + mid.length};
}

BladeShape shape_of(const BladePlace& place) {
  return shapes_of({&place, 1}).front();
}

BladePlace place_of(const BladeShape& shape) {
  return {shape.offset_mm, shape.blade,   0,          shape.blade.length, shape.foam0,
          shape.foam1,     shape.in_foam, shape.rib0, shape.rib1};
}

// Flat arc and a working shape joined by a line in the state at the blade's middle, straight where nothing
// else is said.
struct Forming {
  BladeShape worked;
  MidState mid, flat;

  // Of the share: the tensions come behind the curvature by this, or before it. At 1 the way is a straight
  // line in the state, on which a blade that its tension holds straight would bow the more the more it is
  // bent at once.
  double tension_power = 1;

  Forming(const BladeShape& shape, double side) : worked(shape), mid(mid_state(shape.blade)) {
    flat = mid;
    flat.kappa = side * 2 * kFlatHalfTurn / shape.blade.length;
    flat.tension1 = flat.tension2 = 0;
  }

  // share 0 is the flat arc, 1 the working shape.
  [[nodiscard]] BladePlace place(double share) const {
    MidState m = mid;
    m.kappa = flat.kappa + share * (mid.kappa - flat.kappa);
    const double tension = tension_power == 1 ? share : std::pow(share, tension_power);
    m.tension1 = tension * mid.tension1;
    m.tension2 = tension * mid.tension2;
    return {worked.offset_mm, half_from_middle(m), -0.5 * m.length, m.length, 0, 0, false};
  }
  [[nodiscard]] BladeShape at(double share) const { return shape_of(place(share)); }
};

// What a way between the flat arc and the working shape asks of the blade.
struct FormingFacts {
  double margin = 0;      // least stability margin
  double sharpening = 0;  // largest curvature, over that of the working shape
  double slack = 0;  // least share of its length that the clamps are nearer by, over that of the flat arc
};

double slack_share(const Elastica& blade) {
  const elastica::CurvePoint end = elastica::point_at(blade, blade.length);
  return 1 - std::hypot(end.x - blade.x, end.y - blade.y) / blade.length;
}

FormingFacts facts_of(const Forming& forming) {
  constexpr std::size_t kShapes = 24;
  std::array<Elastica, kShapes> blades;
  std::array<double, kShapes> margins{};
  double sharpest = 0, slack = 1;
  for (std::size_t i = 0; i < kShapes; ++i) {
    // The closer together the nearer they are to the flat arc, where little turns the blade's side.
    const double u = (static_cast<double>(i) + 0.5) / kShapes;
    blades[i] = forming.at(u * u).blade;
    sharpest = std::max(sharpest, elastica::ElasticaCurve(blades[i]).max_abs_curvature());
    slack = std::min(slack, slack_share(blades[i]));
  }
  elastica::stability_margins(blades, margins);
  return {*std::min_element(margins.begin(), margins.end()),
          sharpest / elastica::ElasticaCurve(forming.worked.blade).max_abs_curvature(),
          slack / slack_share(forming.at(0).blade)};
}

// The flat arc bends to the side the working shape turns to, and the way is a straight line. Where the blade
// would be pulled straight on that way, from where it may bow to either side, would be bent more sharply or
// come nearer to a snap than in its working shape, the way is the best of both sides with tensions that come
// later or sooner.
Forming form(const BladeShape& shape, double min_margin) {
  constexpr double kSharper = 1.2, kSlack = 0.5;
  // Shapes as far from a snap as this are as good as any.
  constexpr double kFar = 8, kShare = 0.8;
  constexpr std::array<double, 4> kPowers{1, 6, 2, 0.5};
  const double turn = elastica::point_at(shape.blade, shape.blade.length).theta - shape.blade.theta,
               own = turn < 0 ? -1 : 1;
  const double wanted =
      std::max(min_margin, std::min(kFar, kShare * elastica::stability_margin(shape.blade)));
  const std::tuple good(-kSlack, kSharper, -wanted);
  const auto cost = [&](const FormingFacts& f) {
    return std::tuple(std::max(-kSlack, -f.slack), std::max(kSharper, f.sharpening),
                      std::max(-wanted, -f.margin));
  };
  std::optional<Forming> best;
  auto least = good;
  for (const double power : kPowers) {
    for (const double side : {own, -own}) {
      Forming forming(shape, side);
      forming.tension_power = power;
      const auto costs = cost(facts_of(forming));
      if (best && !(costs < least)) continue;
      best = forming;
      least = costs;
      if (!(good < least)) return *best;
    }
  }
  return *best;
}

// Of parallel planes: where the block ends on the waste side.
double stock_top_mm(const StripPlan& strip) {
  const Frame& frame = strip.block.frame;
  return (frame.origin + strip.block.size_mm.y() * frame.y - strip.planes.centre()).dot(strip.y);
}

// How far the block reaches beyond the plane at an offset: against and along the sweep and to the waste side.
struct Reach {
  double before_mm = 0, behind_mm = 0, top_mm = 0;
};

Reach fan_reach(const StripPlan& strip, double offset_mm) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const Frame plane = strip.swept_plane(offset_mm);
  const bool along = strip.x.cross(strip.y).dot(strip.sweep) > 0;
  const Eigen::Vector3d normal = (along ? 1.0 : -1.0) * plane.normal();
  Reach reach{-kInf, -kInf, -kInf};
  for (const Eigen::Vector3d& p : strip.block.corners()) {
    const Eigen::Vector3d corner = p - plane.origin;
    reach.before_mm = std::max(reach.before_mm, -corner.dot(normal));
    reach.behind_mm = std::max(reach.behind_mm, corner.dot(normal));
    reach.top_mm = std::max(reach.top_mm, corner.dot(plane.y));
  }
  return reach;
}

// How far before the first and behind the last rib the blade's plane is clear of the block.
std::array<double, 2> ends_of_block(const StripPlan& strip, double border_mm) {
  if (!strip.planes.turns()) return {border_mm, border_mm};
  const double first = strip.ribs.front().offset_mm, last = strip.ribs.back().offset_mm;
  // Far enough out for the planes to go straight; what is missing there is made up along their normals. The
  // planes have turned a little on, so that the way along the last rib's normal is longer by less than this.
  constexpr double kStraightMm = 20, kLonger = 1.01;
  const double before = fan_reach(strip, first - kStraightMm).before_mm,
               behind = fan_reach(strip, last + kStraightMm).behind_mm;
  return {kStraightMm + kLonger * std::max(0.0, before), kStraightMm + kLonger * std::max(0.0, behind)};
}

// Sideways on the waste side until the whole blade, worked or flat, is clear of the block.
double way_out_mm(const StripPlan& strip, const Forming& forming, double end_mm, const StockSettings& stock) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const double share : {0.0, 0.5, 1.0}) {
    for (const elastica::CurvePoint& p : elastica::sample(forming.at(share).blade, 65))
      lowest = std::min(lowest, p.y);
  }
  const double top = strip.planes.turns() ? fan_reach(strip, end_mm).top_mm : stock_top_mm(strip);
  // A tenth more than the clearance: the three shapes stand for all between them.
  return std::max(0.0, top + 1.1 * stock.clearance_mm - lowest);
}

BladeShape in_air(BladeShape shape, double offset_mm) {
  shape.offset_mm = offset_mm;
  shape.foam0 = shape.foam1 = shape.rib0 = shape.rib1 = 0;
  shape.in_foam = false;
  return shape;
}

// The blade withdraws beside the block, shape and all, and is flattened there; u in [0, 1] is the way of
// both.
BladePlace withdrawn(const Forming& last, double aside_mm, double u) {
  BladePlace place = u <= 0.5 ? place_of(last.worked) : last.place(2 - 2 * u);
  place.curve.y += std::min(1.0, 2 * u) * aside_mm;
  return place;
}

// Where a strip's way out of the block ends along the sweep, and how far to the side it then goes.
struct WayOut {
  double end_mm = 0, aside_mm = 0;
};

// Feed and blade settle over this way.
constexpr double kLeastLeadMm = 20;
// From there on the shape no longer changes, however long the way out is.
static_assert(kLeastLeadMm >= kMostOnMm + kFadeMm);

// The shortest way on behind the block.
double least_lead_mm(const MotionSettings& motion) {
  return motion.lead_mm > 0 ? motion.lead_mm : kLeastLeadMm;
}

WayOut way_out(const StripPlan& strip, Forming& last, double behind_mm, const Settings& settings) {
  // As the block lies on one side of the blade's plane, a lead of the clearance keeps the clamps clear
  // wherever they pass below it. A little more is for rounding.
  constexpr double kReserve = 1.01;
  const double given = settings.motion.lead_mm, clear = settings.stock.clearance_mm,
               least = least_lead_mm(settings.motion);
  const auto with_lead = [&](double lead) -> WayOut {
    const double end = strip.ribs.back().offset_mm + behind_mm + lead;
    last.worked.offset_mm = end;
    return {end, way_out_mm(strip, last, end, settings.stock)};
  };
  const WayOut out = with_lead(least);
  if (given > 0 || clear <= least) return out;
  constexpr int kLooks = 64;
  for (int i = 0; i <= kLooks; ++i) {
    const BladeShape shape = shape_of(withdrawn(last, out.aside_mm, static_cast<double>(i) / kLooks));
    if (clamp_clearance_mm(clamps(shape.blade, strip.swept_plane(out.end_mm)), strip.block) <
        kReserve * clear)
      return with_lead(kReserve * clear);
  }
  return out;
}

double lead_in_mm(const MotionSettings& motion) {
  return motion.lead_mm > 0 ? motion.lead_mm : std::min(kLeastLeadMm, motion.approach_mm);
}

}  // namespace

std::vector<BladeShape> shapes_of(std::span<const BladePlace> places) {
  std::vector<Elastica> curves;
  std::vector<double> from;
  for (const BladePlace& place : places) {
    curves.push_back(place.curve);
    from.push_back(place.from_mm);
  }
  std::vector<elastica::CurvePoint> starts(places.size());
  elastica::points_at(curves, from, starts);
  std::vector<BladeShape> shapes;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const BladePlace& place = places[i];
    const elastica::CurvePoint& p = starts[i];
    shapes.push_back({place.offset_mm,
                      {p.x, p.y, p.theta, p.kappa, place.curve.lambda1, place.curve.lambda2, place.length_mm},
                      place.foam0,
                      place.foam1,
                      place.in_foam,
                      place.rib0,
                      place.rib1});
  }
  return shapes;
}

std::vector<BladeShape> shapes_at(const Stretch& stretch, std::span<const double> parameters) {
  std::vector<BladePlace> places(parameters.size());
  std::vector<BladeShape> shapes(parameters.size());
  in_blocks(parameters.size(), [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) places[i] = stretch.place(parameters[i]);
    const std::vector<BladeShape> block = shapes_of(std::span(places).subspan(from, to - from));
    std::copy(block.begin(), block.end(), shapes.begin() + static_cast<std::ptrdiff_t>(from));
  });
  return shapes;
}

BladePath make_path(const StripPlan& strip, const Settings& settings) {
  const auto spline = std::make_shared<RibSpline>(strip.ribs, strip.on_mm);
  BladePath path;
  SweepMarks& marks = path.marks;
  marks.first_rib_mm = strip.ribs.front().offset_mm;
  marks.last_rib_mm = strip.ribs.back().offset_mm;
  const auto [before, behind] = ends_of_block(strip, settings.stock.border_mm);
  marks.start_mm = marks.first_rib_mm - (before + lead_in_mm(settings.motion));
  const double above = marks.first_rib_mm - before - settings.motion.approach_mm;
  const double min_margin = settings.blade.min_margin;
  const auto rib_at = [&](double offset_mm) { return shape_of(place_at(strip, *spline, offset_mm)); };
  // Shapes as the cut begins and ends with: past the end ribs they change a little more.
  const Forming first = form(in_air(rib_at(marks.start_mm), above), min_margin);
  const double least_end = marks.last_rib_mm + behind + least_lead_mm(settings.motion);
  Forming last = form(in_air(rib_at(least_end), least_end), min_margin);
  const WayOut out = way_out(strip, last, behind, settings);
  marks.end_mm = out.end_mm;
  path.stretches.push_back({StripPhase::kForm, false, 200, [first](double u) { return first.place(u); }});
  path.stretches.push_back({StripPhase::kApproach, true, 50, [first, marks, above](double u) {
                              return place_of(in_air(first.worked, above + u * (marks.start_mm - above)));
                            }});
  const int resolved = std::clamp(static_cast<int>(8 * strip.ribs.size()), 400, 4000);
  path.stretches.push_back({StripPhase::kCut, true, resolved, [&strip, spline, marks](double u) {
                              return place_at(strip, *spline,
                                              marks.start_mm + u * (marks.end_mm - marks.start_mm));
                            }});
  path.stretches.push_back({StripPhase::kRetract, false, 50,
                            [last, out](double u) { return withdrawn(last, out.aside_mm, 0.5 * u); }});
  path.stretches.push_back({StripPhase::kRetract, false, 200,
                            [last, out](double u) { return withdrawn(last, out.aside_mm, 0.5 + 0.5 * u); }});
  if (auto travel = travel_home(strip, shape_of(withdrawn(last, out.aside_mm, 1)), first.at(0), settings))
    path.stretches.push_back(std::move(*travel));
  return path;
}

}  // namespace hotblade::pipeline
