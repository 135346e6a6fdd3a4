#include "pipeline/calibrate/calibration.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "pipeline/calibrate/registration.hpp"
#include "pipeline/calibrate/scan_file.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/settings/settings_fields.hpp"
#include "pipeline/verify/clamp_error.hpp"

namespace hotblade::pipeline {

namespace {

[[noreturn]] void refuse_scan(const MeasuredCut& scan, const std::string& what) {
  throw Error(ErrorKind::kBadInput, scan.file + ": " + what);
}

// Diagonal of the box that holds all but the outermost hundredth of points along each axis.
double size_of(std::vector<Eigen::Vector3d> points) {
  Eigen::Vector3d size;
  const auto count = static_cast<std::ptrdiff_t>(points.size());
  for (int k = 0; k < 3; ++k) {
    const auto by_axis = [k](const Eigen::Vector3d& p, const Eigen::Vector3d& q) { return p[k] < q[k]; };
    const auto place = [&](double share) {
      const auto at = points.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(count - 1));
      std::nth_element(points.begin(), at, points.end(), by_axis);
      return (*at)[k];
    };
    const double high = place(0.99), low = place(0.01);
    size[k] = high - low;
  }
  return size.norm();
}

// A scan as a wrong unit makes it, or of something else, is told by its size.
void expect_size(const MeasuredCut& scan, double scan_mm, double cut_mm) {
  constexpr double kLargest = 4, kSmallest = 0.12, kNear = 1.35;
  const double ratio = scan_mm / cut_mm;
  if (ratio <= kLargest && ratio >= kSmallest) return;
  struct Slip {
    double by;
    const char* hint;
  };
  constexpr std::array<Slip, 8> kSlips{{{1e-3, "it looks like metres: say --units m"},
                                        {0.1, "it looks like centimetres: say --units cm"},
                                        {1 / 25.4, "it looks like inches: say --units in"},
                                        {1 / 304.8, "it looks like feet: say --units ft"},
                                        {1e3, "it looks like mm read as metres: say --units mm"},
                                        {25.4, "it looks like mm read as inches: say --units mm"},
                                        {304.8, "it looks like mm read as feet: say --units mm"},
                                        {10, "it looks like mm read as cm: say --units mm"}}};
  std::string hint = ratio > 1 ? "cut away what is not of the block" : "a scan is of most of the cut";
  for (const Slip& slip : kSlips)
    if (std::abs(std::log(ratio / slip.by)) < std::log(kNear)) hint = slip.hint;
  refuse_scan(scan, fmt::format("the scan is {} than the cut ({:.4g} mm across, the cut {:.4g}): {}",
                                ratio > 1 ? "larger" : "smaller", scan_mm, cut_mm, hint));
}

void expect_bent(const Program& program, const MeasuredCut& scan) {
  const Strip& strip = program.strips[scan.strip];
  std::size_t straight = 0, forming = 0;
  for (const BladePose& pose : strip.poses) {
    if (!pose.foam) continue;
    ++forming;
    straight += nearly_straight(pose, program.settings.machine) ? 1 : 0;
  }
  if (forming < 2)
    refuse_scan(scan, "no pose of strip " + strip.id + " forms the design: nothing of it can be measured");
  if (straight == 0) return;
  refuse_scan(
      scan, fmt::format(
                "strip {} is cut with a blade that is nearly straight ({} of {} poses): errors of its clamps "
                "move it with their square roots, which a scan does not tell back: calibrate by a "
                "strip that bends",
                strip.id, straight, forming));
}

double turn_rad(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) {
  return Eigen::AngleAxisd(from.linear().transpose() * to.linear()).angle();
}

constexpr double kOtherSideRad =
    std::numbers::pi / 12;  // placements turned by less are one, as registration slides

// Of placements, the first of each side.
std::vector<Placement> sides_of(const std::vector<Placement>& found) {
  std::vector<Placement> sides;
  for (const Placement& p : found) {
    const bool known = std::any_of(sides.begin(), sides.end(), [&](const Placement& s) {
      return turn_rad(s.scan_to_design, p.scan_to_design) < kOtherSideRad;
    });
    if (!known) sides.push_back(p);
  }
  return sides;
}

// Which of the sides a scan was taken from: the one that what the cell is off by explains best. Sides that
// are explained as well are told, as only the caller can know.
Eigen::Isometry3d side_of(const Program& program, const StripScan& given, const MeasuredCut& scan,
                          const std::vector<Placement>& sides) {
  if (sides.size() == 1) return sides.front().scan_to_design;
  constexpr int kSideRounds = 12;  // enough to see which side comes down to the noise
  constexpr double kSideSampleMm = 2 * kCutSampleMm;
  StripScan from{thinned_to(program, scan.strip, kSideSampleMm), given.points, {}, kSideSampleMm};
  std::optional<Estimate> best;
  Eigen::Isometry3d from_there = Eigen::Isometry3d::Identity();
  std::vector<Estimate> all;
  for (const Placement& side : sides) {
    from.scan_to_design = side.scan_to_design;
    try {
      all.push_back(estimate({from}, {.most_rounds = kSideRounds}));
    } catch (const Error&) {
      continue;  // hardly a point lies on the cut from this side
    }
    if (best && all.back().noise_mm >= best->noise_mm) continue;
    best = all.back();
    from_there = side.scan_to_design;
  }
  if (!best) refuse_scan(scan, "does not fit the cut of its strip: is it a scan of another one?");
  constexpr double kAsWell = 1.15, kAsMany = 0.9;
  for (const Estimate& other : all) {
    const Eigen::Isometry3d &is = best->scan_to_design[0], &also = other.scan_to_design[0];
    if (turn_rad(is, also) < kOtherSideRad || other.noise_mm > kAsWell * best->noise_mm ||
        static_cast<double>(other.used) < kAsMany * static_cast<double>(best->used))
      continue;
    refuse_scan(
        scan,
        fmt::format("fits the cut as well {} (to {:.3f} mm and {:.3f} mm): the cut looks the same from both "
                    "sides: turn the scan about as the design lies and say --placement near",
                    turn_between(is, also), best->noise_mm, other.noise_mm));
  }
  return from_there;
}

// The place of a scan that stands near its own. What is drawn far off had little to hold it by, and stays;
// one that does not lie on the cut where it stands is of another place.
Eigen::Isometry3d near_place(const CutMesh& cut, const StripScan& given, const MeasuredCut& scan) {
  constexpr int kRounds = 60;
  constexpr double kMostMm = 60, kMostRad = std::numbers::pi / 6, kLeastShare = 0.25;
  const Eigen::Isometry3d stands = Eigen::Isometry3d::Identity(),
                          drawn = drawn_to(cut, given.points, stands, kRounds).scan_to_design;
  const Eigen::Vector3d middle =
      std::accumulate(given.points.begin(), given.points.end(), Eigen::Vector3d::Zero().eval()) /
      static_cast<double>(given.points.size());
  const double moved_mm = (drawn * middle - middle).norm();
  if (moved_mm <= kMostMm && turn_rad(stands, drawn) <= kMostRad) return drawn;
  const std::vector<double> distances = cut.distances(given.points);
  const auto on = std::count_if(distances.begin(), distances.end(), [](double d) { return d <= kMostMm; });
  if (static_cast<double>(on) < kLeastShare * static_cast<double>(distances.size()))
    refuse_scan(
        scan,
        fmt::format("lies elsewhere than the cut ({} of {} points within {:g} mm of it; it fits {:.4g} mm "
                    "away): turn it as the design lies, or say --placement search",
                    on, distances.size(), kMostMm, moved_mm));
  return stands;
}

StripScan placed_scan(const Program& program, const MeasuredCut& scan, ScanPlacement placement) {
  expect_bent(program, scan);
  StripScan given{thinned_to(program, scan.strip, kCutSampleMm), some_of(scan.points, kMostScanPoints),
                  Eigen::Isometry3d::Identity()};
  const CutMesh cut(cut_with(given.program, planned_errors(program), kCutSampleMm));
  expect_size(scan, size_of(scan.points), size_of(cut.surface().vertices));
  if (placement == ScanPlacement::kFixed) return given;
  if (placement == ScanPlacement::kNear) {
    given.scan_to_design = near_place(cut, given, scan);
    return given;
  }
  given.scan_to_design = side_of(program, given, scan, sides_of(placements(cut, given.points)));
  return given;
}

// A scan may show much that is not of the cut, but not mostly.
void expect_fit(const Calibration& calibration) {
  const Estimate& e = calibration.estimate;
  constexpr double kLeastShare = 0.25;
  const double share = static_cast<double>(e.used) / static_cast<double>(e.points);
  if (share < kLeastShare)
    throw Error(
        ErrorKind::kBadInput,
        fmt::format(
            "{}: does not fit the cut ({:.0f} % of its points lie on it, at least {:.0f} %): is it a scan of "
            "this strip? cut away what is not of the block",
            calibration.files.front(), 100 * share, 100 * kLeastShare));
  if (e.tells_nothing())
    throw Error(
        ErrorKind::kBadInput,
        fmt::format(
            "{}: tells nothing of the cell (points {}, off by {:.3f} mm each; no blend of the {} numbers is "
            "known better than to half of what it may be off by): scan more of the cut, more exactly, or a "
            "strip "
            "that bends more",
            calibration.files.front(), e.used, e.noise_mm, kCellErrors));
}

// A scan that the cell explains is off by noise. Of points within reach of the cut that cannot be told from
// what lies anywhere there: past a part of the reach, it would decide the noise.
void expect_explained(const Calibration& calibration) {
  const Estimate& e = calibration.estimate;
  constexpr double kMostNoiseMm = kFarMm / kTukey;
  if (e.noise_mm <= kMostNoiseMm) return;
  throw Error(
      ErrorKind::kBadInput,
      fmt::format("{}: does not fit the cut (points are off by {:.2f} mm each, at most {:.2f}; {:.3f} mm "
                  "rms as planned, {:.3f} as found): is it a scan of this strip{}",
                  calibration.files.front(), e.noise_mm, kMostNoiseMm, e.before.rms_mm, e.after.rms_mm,
                  calibration.placement == ScanPlacement::kFixed
                      ? ", in the design's frame? where it stands elsewhere say --placement near"
                      : "? cut away what is not of the block"));
}

// What settings do not take is no cell: clamps that are held centimetres beside.
void expect_in_range(const Program& program, const Calibration& calibration) {
  Settings found = calibrated(program, calibration);
  for (const SettingField& field : setting_fields()) {
    const std::vector<std::string>& keys = cell_keys();
    if (std::find(keys.begin(), keys.end(), full_key(field)) == keys.end()) continue;
    const SettingPlace place = field.place(found);
    std::vector<double> values;
    if (const auto* one = std::get_if<double*>(&place)) values = {**one};
    if (const auto* three = std::get_if<std::array<double, 3>*>(&place))
      values.assign((*three)->begin(), (*three)->end());
    for (const double value : values) {
      if (value >= field.min && value <= field.max) continue;
      throw Error(
          ErrorKind::kBadInput,
          fmt::format("{}: does not fit the cut: {} would be {:.4g} ({}): is it a scan of this strip, and "
                      "where --placement says?",
                      calibration.files.front(), full_key(field), value, range_text(field)));
    }
  }
}

}  // namespace

Calibration calibrate(const Program& executed, const std::vector<MeasuredCut>& scans,
                      ScanPlacement placement) {
  Calibration calibration;
  calibration.placement = placement;
  std::vector<StripScan> given;
  for (const MeasuredCut& scan : scans) {
    calibration.strips.push_back(executed.strips.at(scan.strip).id);
    calibration.files.push_back(scan.file);
    given.push_back(placed_scan(executed, scan, placement));
  }
  try {
    calibration.estimate = estimate(given, {.fixed = placement == ScanPlacement::kFixed});
  } catch (const Error& error) {
    throw Error(error.kind, calibration.files.front() + ": " + error.what());
  }
  expect_fit(calibration);
  expect_explained(calibration);
  expect_in_range(executed, calibration);
  return calibration;
}

Settings calibrated(const Program& program, const Calibration& calibration) {
  return with_errors(program, calibration.estimate.value);
}

}  // namespace hotblade::pipeline
