#include "pipeline/calibrate/cell_errors.hpp"

#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "elastica/blade/continuation.hpp"
#include "elastica/curve/placement.hpp"
#include "robot/blade/blade_section.hpp"

namespace hotblade::pipeline {

namespace {

constexpr std::size_t at(CellError error) {
  return static_cast<std::size_t>(error);
}

constexpr std::array<CellErrorInfo, kCellErrors> kInfos{{
    {"clamp_a_along_mm", "clamp A along the blade", "mm", 1.5},
    {"clamp_a_across_mm", "clamp A across the blade in its plane", "mm", 1.5},
    {"clamp_a_aside_mm", "clamp A out of the blade's plane", "mm", 1.5},
    {"clamp_a_twist_rad", "clamp A turned about the blade", "rad", 0.006},
    {"clamp_a_tilt_rad", "clamp A turned out of the blade's plane", "rad", 0.006},
    {"clamp_a_turn_rad", "clamp A turned in the blade's plane", "rad", 0.006},
    {"clamp_b_along_mm", "clamp B along the blade", "mm", 1.5},
    {"clamp_b_across_mm", "clamp B across the blade in its plane", "mm", 1.5},
    {"clamp_b_aside_mm", "clamp B out of the blade's plane", "mm", 1.5},
    {"clamp_b_twist_rad", "clamp B turned about the blade", "rad", 0.006},
    {"clamp_b_tilt_rad", "clamp B turned out of the blade's plane", "rad", 0.006},
    {"clamp_b_turn_rad", "clamp B turned in the blade's plane", "rad", 0.006},
    {"blade_length_mm", "the blade's length", "mm", 2},
    {"blade_stiffness", "the blade's stiffness E t^3", "", 0.15},
    {"band_mm", "the melted band at the feed", "mm", 0.4},
    {"band_slowing", "how the melted band depends on the speed", "", 0.25},
}};

// Slowing 1 would melt without end at rest.
constexpr double kMostSlowing = 0.95;

robot::ClampOffset offset_of(const ErrorVector& errors, CellError shift, CellError turn) {
  robot::ClampOffset offset;
  for (std::size_t i = 0; i < 3; ++i) {
    offset.shift_mm[i] = errors[static_cast<Eigen::Index>(at(shift) + i)];
    offset.turn_rad[i] = errors[static_cast<Eigen::Index>(at(turn) + i)];
  }
  return offset;
}

robot::ClampOffsets offsets_of(const ErrorVector& errors) {
  return {offset_of(errors, CellError::kShiftA, CellError::kTurnA),
          offset_of(errors, CellError::kShiftB, CellError::kTurnB)};
}

void put_offset(const robot::ClampOffset& offset, CellError shift, CellError turn, ErrorVector& errors) {
  for (std::size_t i = 0; i < 3; ++i) {
    errors[static_cast<Eigen::Index>(at(shift) + i)] = offset.shift_mm[i];
    errors[static_cast<Eigen::Index>(at(turn) + i)] = offset.turn_rad[i];
  }
}

double& number(ErrorVector& errors, CellError error) {
  return errors[static_cast<Eigen::Index>(at(error))];
}
double number(const ErrorVector& errors, CellError error) {
  return errors[static_cast<Eigen::Index>(at(error))];
}

// A plane through both clamps, as near to both clamps' own as that allows, and the clamps in it and out of
// it.
struct CommonPlane {
  Frame frame;  // from clamp A, x along its tangent
  elastica::PlanarPose b;
  elastica::EndTurns turns;
};

CommonPlane common_plane(const robot::ClampPoses& clamps, double near_theta) {
  const auto axis = [](const Pose& pose, int i) -> Eigen::Vector3d {
    return pose.q * Eigen::Vector3d::Unit(i);
  };
  const Eigen::Vector3d chord = clamps.b.p - clamps.a.p, along = chord.stableNormalized();
  const Eigen::Vector3d both = axis(clamps.a, 2) + axis(clamps.b, 2);
  const Eigen::Vector3d normal = (both - both.dot(along) * along).normalized();
  const auto in_plane = [&](const Eigen::Vector3d& v) -> Eigen::Vector3d {
    return (v - v.dot(normal) * normal).normalized();
  };
  CommonPlane plane;
  plane.frame.origin = clamps.a.p;
  plane.frame.x = in_plane(axis(clamps.a, 0));
  plane.frame.y = normal.cross(plane.frame.x);
  const Eigen::Vector3d tangent = axis(clamps.b, 0);
  const double theta = std::atan2(tangent.dot(plane.frame.y), tangent.dot(plane.frame.x));
  plane.b = {chord.dot(plane.frame.x), chord.dot(plane.frame.y),
             near_theta + std::remainder(theta - near_theta, 2 * std::numbers::pi)};
  const auto turn = [&](const Pose& pose, double& phi, double& psi) {
    const Eigen::Vector3d t = in_plane(axis(pose, 0));
    phi = -axis(pose, 2).dot(normal.cross(t));
    psi = -axis(pose, 0).dot(normal);
  };
  turn(clamps.a, plane.turns.phi_a, plane.turns.psi_a);
  turn(clamps.b, plane.turns.phi_b, plane.turns.psi_b);
  return plane;
}

// The same shape with another length.
elastica::Elastica stretched(const elastica::Elastica& e, double length) {
  const double by = length / e.length;
  return {e.x, e.y, e.theta, e.kappa / by, e.lambda1 / (by * by), e.lambda2 / (by * by), length};
}

// Moves the vertices of a row to where ends turned out of the plane take the blade, and to the edge of the
// band of the section that they twist.
void bend_aside(const BladePose& pose, const elastica::EndTurns& turns, const robot::Blade& blade,
                std::size_t first, std::size_t columns, SweptSurface& surface) {
  const elastica::Droop aside =
      elastica::turned_ends(elastica::at_origin(pose.blade), turns, robot::stiffness_ratios(blade));
  if (!aside.stable) return;  // it tips out of its plane by itself, and no first order says where to
  const elastica::ElasticaCurve curve(pose.blade);
  const Eigen::Vector3d normal = pose.frame.normal();
  for (std::size_t j = 0; j < columns; ++j) {
    const std::size_t v = first + j;
    const double share = static_cast<double>(j) / static_cast<double>(columns - 1);
    const double s = (*pose.foam)[0] + share * ((*pose.foam)[1] - (*pose.foam)[0]);
    const double place = std::clamp(s / pose.blade.length, 0.0, 1.0) * elastica::kGravityCells;
    const auto k = std::min(static_cast<std::size_t>(place), std::size_t{elastica::kGravityCells - 1});
    const double t = place - static_cast<double>(k);
    const auto between = [&](const std::vector<double>& values) {
      return (1 - t) * values[k] + t * values[k + 1];
    };
    const Eigen::Vector2d tangent = curve.at(s).tangent();
    const Eigen::Vector3d left = -tangent.y() * pose.frame.x() + tangent.x() * pose.frame.y();
    const Eigen::Vector3d& n = surface.normals[v];
    const Eigen::Vector3d twisted = (surface.plane_normals[v] - between(aside.twist) * left).normalized();
    const double speed = surface.speeds_mm_s[v];
    const double bend = surface.width_bends_per_mm[v];
    const double wider = half_band_mm(blade, n, twisted, speed, bend) -
                         half_band_mm(blade, n, surface.plane_normals[v], speed, bend);
    surface.vertices[v] += between(aside.shift) * normal - wider * n;
    surface.plane_normals[v] = twisted;
  }
}

}  // namespace

const CellErrorInfo& info_of(std::size_t error) {
  return kInfos.at(error);
}

BandModel::BandModel(const Program& program)
    : reference_mm_s(program.settings.motion.feed_mm_s), nominal(program.blade) {}

double BandModel::slowing() const {
  if (tabled() || !nominal.melt.by_speed()) return 0;
  return reference_mm_s / (reference_mm_s + nominal.melt.loss_mm_s);
}

void BandModel::apply(double band, double slowing, robot::Blade& blade) const {
  blade.melt = {};
  if (tabled()) {
    blade.melt = nominal.melt;
    for (auto& pair : blade.melt.band_mm_at_mm_s) pair[1] *= band / band_mm();
    return;
  }
  // Constants of foam stay constants, within what their settings take.
  constexpr double kLeastSlowing = 0.01, kMostLossMmS = 900;
  if (nominal.melt.by_speed())
    slowing = std::max({slowing, kLeastSlowing, reference_mm_s / (reference_mm_s + kMostLossMmS)});
  slowing = std::min(slowing, kMostSlowing);
  if (!(slowing > 0)) {
    blade.kerf_mm = band;
    return;
  }
  blade.melt.loss_mm_s = reference_mm_s * (1 / slowing - 1);
  blade.melt.melt_mm2_s = band * (reference_mm_s + blade.melt.loss_mm_s);
}

ErrorVector planned_errors(const Program& program) {
  return errors_of(program, program.settings);
}

ErrorVector errors_of(const Program& program, const Settings& settings) {
  ErrorVector errors = ErrorVector::Zero();
  put_offset(settings.machine.clamps.a, CellError::kShiftA, CellError::kTurnA, errors);
  put_offset(settings.machine.clamps.b, CellError::kShiftB, CellError::kTurnB, errors);
  number(errors, CellError::kLength) = settings.blade.length_error_mm;
  number(errors, CellError::kStiffness) = settings.blade.stiffness_error;
  BandModel band(program);
  band.nominal = settings.blade;
  number(errors, CellError::kBand) = band.band_mm();
  number(errors, CellError::kSlowing) = band.slowing();
  return errors;
}

const std::vector<std::string>& cell_keys() {
  static const std::vector<std::string> keys{"machine.clamp_a_shift_mm",
                                             "machine.clamp_a_turn_rad",
                                             "machine.clamp_b_shift_mm",
                                             "machine.clamp_b_turn_rad",
                                             "blade.length_error_mm",
                                             "blade.stiffness_error",
                                             "blade.kerf_mm",
                                             "foam.band_mm_at_mm_s",
                                             "foam.melt_mm2_s",
                                             "foam.loss_mm_s"};
  return keys;
}

Settings with_errors(const Program& program, const ErrorVector& errors) {
  Settings settings = program.settings;
  settings.machine.clamps = offsets_of(errors);
  settings.blade.length_error_mm = number(errors, CellError::kLength);
  settings.blade.stiffness_error = number(errors, CellError::kStiffness);
  BandModel(program).apply(number(errors, CellError::kBand), number(errors, CellError::kSlowing),
                           settings.blade);
  return settings;
}

HeldStrip held_strip(const Program& program, const Strip& strip, const ErrorVector& errors) {
  const robot::ClampOffsets offsets = offsets_of(errors);
  HeldStrip out{strip, {}, 0};
  out.turns.resize(strip.poses.size());
  out.strip.blade_length_mm += number(errors, CellError::kLength) - program.settings.blade.length_error_mm;
  std::vector<char> lost(strip.poses.size(), 0);
  tbb::parallel_for(std::size_t{0}, strip.poses.size(), [&](std::size_t i) {
    BladePose& pose = out.strip.poses[i];
    const double length = out.strip.blade_length_mm;
    const elastica::Elastica planned = elastica::at_origin(pose.blade);
    const double theta = elastica::clamps_of(planned).b.theta;
    const CommonPlane plane = common_plane(robot::held({pose.a, pose.b}, offsets), theta);
    const elastica::FollowReport way = elastica::follow(stretched(planned, length), {{0, 0, 0}, plane.b});
    lost[i] = way.status == elastica::FollowStatus::kFollowed ? 0 : 1;
    pose.blade = way.shape.elastica;
    pose.frame = plane.frame;
    if (pose.foam) (*pose.foam)[1] = std::min((*pose.foam)[1], length);
    out.turns[i] = plane.turns;
  });
  out.lost = static_cast<std::size_t>(std::count(lost.begin(), lost.end(), 1));
  return out;
}

// Rows of the thinned strip lie at least so much of the sample apart, whatever the errors do to them.
constexpr double kRowShare = 0.6;

Program thinned_to(const Program& program, std::size_t strip, double sample_mm) {
  Program one = program;
  one.strips = {program.strips.at(strip)};
  const SweptSurface all = swept_surface(one, sample_mm);
  std::vector<BladePose> poses;
  int last = -1;
  for (const int pose : all.pose_of_vertex) {
    if (pose == last) continue;
    last = pose;
    poses.push_back(one.strips[0].poses[static_cast<std::size_t>(pose)]);
  }
  one.strips[0].poses = std::move(poses);
  one.strips[0].joints.clear();
  return one;
}

SweptSurface cut_with(const Program& thinned, const ErrorVector& errors, double sample_mm) {
  if (thinned.strips.size() != 1) throw std::logic_error("cut_with takes a program of one strip");
  HeldStrip held = held_strip(thinned, thinned.strips[0], errors);
  Program cut;
  cut.settings = with_errors(thinned, errors);
  cut.blade = thinned.blade;
  cut.blade.stiffness_error = cut.settings.blade.stiffness_error;
  cut.blade.melt = cut.settings.blade.melt;
  cut.blade.kerf_mm = cut.settings.blade.kerf_mm;
  cut.strips = {std::move(held.strip)};
  SweptSurface surface = swept_surface(cut, kRowShare * sample_mm);
  const std::vector<BladePose>& poses = cut.strips[0].poses;
  if (surface.vertices.empty()) return surface;
  const std::size_t columns = surface.vertices.size() / poses.size();
  if (columns * poses.size() != surface.vertices.size())
    throw std::logic_error("the rows of a cut are not its poses");
  tbb::parallel_for(std::size_t{0}, poses.size(), [&](std::size_t i) {
    const elastica::EndTurns& turns = held.turns[i];
    if (turns.phi_a == 0 && turns.psi_a == 0 && turns.phi_b == 0 && turns.psi_b == 0) return;
    bend_aside(poses[i], turns, cut.blade, i * columns, columns, surface);
  });
  return surface;
}

}  // namespace hotblade::pipeline
