#include "pipeline/verify/as_cut.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "pipeline/settings/error.hpp"
#include "pipeline/settings/json_text.hpp"
#include "pipeline/verify/as_cut_budget.hpp"
#include "pipeline/verify/blade_speeds.hpp"
#include "pipeline/verify/branch.hpp"
#include "pipeline/verify/budget.hpp"
#include "pipeline/verify/largest_text.hpp"
#include "robot/controller/execution_log.hpp"
#include "robot/controller/execution_poses.hpp"

namespace hotblade::pipeline {

namespace {

using robot::LoggedPose;

[[noreturn]] void refuse(const std::filesystem::path& log, const std::string& why) {
  throw Error(ErrorKind::kBadInput, log.string() + ": " + why);
}

void require_proof(const robot::Job& job, const std::map<std::uint64_t, robot::LoggedJob>& logged,
                   const std::filesystem::path& log) {
  const auto found = logged.find(job.id);
  if (found == logged.end())
    refuse(log,
           fmt::format("has nothing of strip {} of this program (job {}): it is the log of another program, "
                       "or the strip was not run",
                       job.strip, robot::to_hex(job.id)));
  const robot::ExecutionProof proof = robot::prove(job, found->second);
  if (proof.executed < proof.planned)
    refuse(log, fmt::format("strip {} is incomplete (waypoints {}, planned {}): run it to its end", job.strip,
                            proof.executed, proof.planned));
  if (!proof.holds())
    refuse(log, fmt::format("strip {}: {}: not what was planned", job.strip,
                            !proof.in_order      ? "sequence numbers are not 0 to N-1, once each"
                            : !proof.bytes_equal ? "the bytes of a waypoint differ"
                                                 : "the hash chain does not follow"));
}

Pose to_design(const Pose& design_to_cell, const Pose& p) {
  const Eigen::Quaterniond back = design_to_cell.q.conjugate();
  return {back * (p.p - design_to_cell.p), back * p.q};
}

// The part that forms the design: as planned at the waypoints before and after, in between by place.
std::optional<std::array<double, 2>> foam_between(const BladePose& from, const BladePose& to, double share) {
  if (from.foam && to.foam) {
    std::array<double, 2> foam{};
    for (std::size_t i = 0; i < 2; ++i) foam[i] = (1 - share) * (*from.foam)[i] + share * (*to.foam)[i];
    return foam;
  }
  // On the way into the foam and out of it the nearer waypoint says.
  return share < 0.5 ? from.foam : to.foam;
}

// Poses of the path farther apart than this leave a part of the cut untold; a log has one every 10 ms.
constexpr double kMostGapS = 1;
// A shape that ends farther from its clamp is none of it. Clamps that are off hold it out of its plane by
// less.
constexpr double kMostEndMm = 5;

// What a log tells of a pose has to be whole: its shape ends where clamp B holds it, and while foam is formed
// the next pose follows soon.
void expect_whole(const Strip& planned, const ExecutedStrip& strip, const BladePose& pose, const Pose& held_b,
                  double path_s, const std::filesystem::path& log) {
  const elastica::CurvePoint end = elastica::point_at(pose.blade, pose.blade.length);
  const double off_mm = (pose.frame.point(end.x, end.y) - held_b.p).norm();
  if (!(off_mm <= kMostEndMm))
    refuse(log,
           fmt::format(
               "strip {} at {:.2f} s: the blade's shape ends {:.3g} mm from clamp B (limit {} mm): the log "
               "is damaged",
               planned.id, pose.t, off_mm, kMostEndMm));
  if (!pose.foam || strip.poses.empty() || !strip.poses.back().foam) return;
  if (path_s - strip.path_s.back() > kMostGapS)
    refuse(log,
           fmt::format(
               "strip {}: no pose from {:.2f} to {:.2f} s of the path (at most {} s): a part of the cut is "
               "not told of",
               planned.id, strip.path_s.back(), path_s, kMostGapS));
}

ExecutedStrip executed_strip(const Strip& planned, const robot::ClampOffsets& clamps,
                             const std::vector<LoggedPose>& logged, const std::filesystem::path& log) {
  ExecutedStrip strip;
  for (const LoggedPose& l : logged) {
    if (!strip.poses.empty() && l.t < strip.poses.back().t)
      refuse(log,
             fmt::format("strip {}: time goes back from {} to {} s", planned.id, strip.poses.back().t, l.t));
    if (!l.blade)
      refuse(log,
             fmt::format("strip {} at {:.2f} s: no blade shape: the controller has to solve the equilibrium "
                         "(sim without --no-equilibrium)",
                         planned.id, l.t));
    if (l.sequence >= planned.poses.size())
      refuse(log, fmt::format("strip {}: pose after waypoint {} of {}", planned.id, l.sequence,
                              planned.poses.size()));
    BladePose pose;
    pose.t = l.t;
    pose.heat = l.heat;
    pose.a = to_design(planned.design_to_cell, l.a);
    pose.b = to_design(planned.design_to_cell, l.b);
    // The log's shapes start where clamp A holds the blade.
    const Pose from_a = robot::held(pose.a, clamps.a);
    pose.frame = Frame{from_a.p, from_a.q * Eigen::Vector3d::UnitX(), from_a.q * Eigen::Vector3d::UnitY()};
    pose.blade = *l.blade;
    const std::size_t next = std::min<std::size_t>(l.sequence + 1, planned.poses.size() - 1);
    const BladePose &from = planned.poses[l.sequence], &to = planned.poses[next];
    if (l.heat) pose.foam = foam_between(from, to, share_of_step(from, to, l.path_s));
    expect_whole(planned, strip, pose, robot::held(pose.b, clamps.b), l.path_s, log);
    strip.poses.push_back(std::move(pose));
    strip.after.push_back(l.sequence);
    strip.path_s.push_back(l.path_s);
    strip.executed_s = std::max(strip.executed_s, l.t);
  }
  return strip;
}

// Points of hot blades inside the stock that do not form the design, poses about `sample_mm` apart.
void add_touches(const Strip& planned, const ExecutedStrip& strip, int index, double sample_mm,
                 BladeTouches& touches) {
  constexpr int kMarks = 3;
  std::array<Eigen::Vector3d, kMarks> last;
  last.fill(Eigen::Vector3d::Zero());
  bool any = false;
  for (std::size_t i = 0; i < strip.poses.size(); ++i) {
    const BladePose& pose = strip.poses[i];
    if (!pose.heat) continue;
    const int points = static_cast<int>(std::ceil(pose.blade.length / sample_mm)) + 1;
    std::array<Eigen::Vector3d, kMarks> marks;
    const auto ends = elastica::sample(pose.blade, kMarks);
    double moved = 0;
    for (std::size_t k = 0; k < kMarks; ++k) {
      marks[k] = pose.frame.point(ends[k].x, ends[k].y);
      if (any) moved = std::max(moved, (marks[k] - last[k]).norm());
    }
    if (any && moved < sample_mm) continue;
    any = true;
    last = marks;
    const elastica::ElasticaCurve curve(pose.blade);
    const BladePose& next = strip.poses[i + 1 < strip.poses.size() ? i + 1 : i - std::min<std::size_t>(i, 1)];
    const elastica::ElasticaCurve then(next.blade);
    for (int k = 0; k < points; ++k) {
      const double s = pose.blade.length * k / (points - 1);
      if (pose.foam && s >= (*pose.foam)[0] && s <= (*pose.foam)[1]) continue;
      const auto q = curve.at(s);
      const Eigen::Vector3d p = pose.frame.point(q.x, q.y);
      if (!planned.block.contains(p)) continue;
      touches.points.push_back(p);
      touches.plane_normals.push_back(pose.frame.normal());
      const auto moved_to = then.at(s);
      touches.speeds_mm_s.push_back(
          speed_across(p, next.frame.point(moved_to.x, moved_to.y), std::abs(next.t - pose.t),
                       std::cos(q.theta) * pose.frame.x() + std::sin(q.theta) * pose.frame.y()));
      touches.strip_of_point.push_back(index);
    }
  }
}

BladePose cold(BladePose pose) {
  pose.heat = false;
  pose.foam.reset();
  return pose;
}

// Poses that form the design, or all that are hot, in the order of the path, without what was gone over again
// after a retraction. Their times are those of the motion: where it was interrupted, the path's. A hot blade
// reaches a pose by way of the one before it in time: where that one is none of them, what lies between on
// the path was not passed so, and a cold pose stands there.
enum class Which { kForming, kHot };

std::vector<BladePose> along_path(const ExecutedStrip& strip, Which which) {
  std::vector<BladePose> poses;
  double reached = -1, clock = 0;
  bool going = false, formed = false;
  for (std::size_t i = 0; i < strip.poses.size(); ++i) {
    const BladePose& pose = strip.poses[i];
    const bool forms = which == Which::kHot ? pose.heat : pose.foam.has_value();
    const bool farther = forms && strip.path_s[i] > reached;
    if (farther) {
      if (!poses.empty()) {
        if (!formed) poses.push_back(cold(poses.back()));
        clock += going ? strip.poses[i].t - strip.poses[i - 1].t : strip.path_s[i] - reached;
      }
      reached = strip.path_s[i];
      poses.push_back(pose);
      poses.back().t = clock;
    }
    going = farther;
    formed = forms;
  }
  return poses;
}

Program executed_program(const Program& program, const std::vector<ExecutedStrip>& executed, Which which) {
  Program cut = program;
  for (std::size_t i = 0; i < executed.size(); ++i) {
    cut.strips[i].poses = along_path(executed[i], which);
    cut.strips[i].joints.clear();
  }
  return cut;
}

// By how much half the melted band differs where the blade went at another speed than planned, at most.
double melt_speed_mm(const Program& program, const Program& cut) {
  double worst = 0;
  for (std::size_t i = 0; i < cut.strips.size() && program.blade.melt.by_speed(); ++i) {
    const BladeSpeeds planned(program.strips[i].poses), executed(cut.strips[i].poses);
    if (planned.empty()) continue;
    executed.for_each([&](const Eigen::Vector3d& point, double speed_mm_s) {
      const double more = program.blade.band_mm(speed_mm_s) - program.blade.band_mm(planned.at(point));
      worst = std::max(worst, 0.5 * std::abs(more));
    });
  }
  return worst;
}

}  // namespace

std::vector<ExecutedStrip> read_executed(const StripJobs& work, const std::filesystem::path& log_file) {
  if (std::error_code ignored; std::filesystem::is_directory(log_file, ignored))
    throw Error(ErrorKind::kFile, log_file.string() + ": is a directory: give the execution log");
  try {
    const auto logged = robot::read_execution_log(log_file);
    for (const robot::Job& job : work.jobs) require_proof(job, logged, log_file);
    const auto poses = robot::read_execution_poses(log_file);
    std::vector<ExecutedStrip> executed;
    for (std::size_t i = 0; i < work.jobs.size(); ++i) {
      const auto found = poses.find(work.jobs[i].id);
      if (found == poses.end() || found->second.empty())
        refuse(log_file, "strip " + work.jobs[i].strip + " has no poses: the log was kept without them");
      executed.push_back(executed_strip(work.program.strips[i], work.program.settings.machine.clamps,
                                        found->second, log_file));
    }
    return executed;
  } catch (const robot::LogError& error) {
    throw Error(std::filesystem::exists(log_file) ? ErrorKind::kBadInput : ErrorKind::kFile, error.what());
  }
}

double AsCutReport::budget_sum_mm() const {
  double sum = 0;
  for (const auto& [name, mm] : budget_mm) sum += mm;
  return sum;
}

double AsCutReport::in_cell_mm() const {
  constexpr std::array<std::string_view, 4> kUntold{"mesh", "gravity_droop", "gravity_in_plane",
                                                    kClampErrorLine};
  double sum = cut.deviation.max;
  for (const auto& [name, mm] : budget_mm) {
    if (std::find(kUntold.begin(), kUntold.end(), name) != kUntold.end()) sum += mm;
  }
  return sum;
}

Program as_executed(const Program& program, const std::vector<ExecutedStrip>& executed) {
  return executed_program(program, executed, Which::kForming);
}

AsCutReport as_cut(const Program& program, const std::vector<ExecutedStrip>& executed,
                   const surface::DesignSurface& design, const VerifyOptions& options) {
  AsCutReport report;
  // What is hot beside the part in foam melts there as well: over its first and last places the width passes
  // from outside.
  const Program cut = executed_program(program, executed, Which::kHot);
  VerifyOptions by_every_pose = options;
  by_every_pose.by_every_pose = true;
  BladeTouches touches;
  for (std::size_t i = 0; i < executed.size(); ++i) {
    add_touches(program.strips[i], executed[i], static_cast<int>(i), options.sample_mm, touches);
    report.executed_s += executed[i].executed_s;
    for (const BladePose& pose : executed[i].poses) report.hot_poses += pose.heat ? 1 : 0;
  }
  report.touch_samples = touches.points.size();
  report.cut = measure(cut, touches, design, by_every_pose);
  if (report.cut.worst_strip >= 0) {
    const Strip& worst = program.strips[static_cast<std::size_t>(report.cut.worst_strip)];
    report.strip = worst.id;
    report.rib = nearest_rib(worst, report.cut.deviation.at);
  }
  const AsCutBudget budget = as_cut_budget(program, executed, design, report.cut.half_band_mm, options);
  report.budget_mm = budget.lines_mm;
  if (program.blade.melt.by_speed()) report.budget_mm.emplace_back("melt_speed", melt_speed_mm(program, cut));
  report.not_in_budget = budget.missing;
  report.shape_mismatch_mm = budget.shape_mismatch_mm;
  return report;
}

std::string to_json(const AsCutReport& report, const VerifyOptions& options) {
  const VerifyReport& c = report.cut;
  const Deviation& d = c.deviation;
  nlohmann::ordered_json json;
  json["within_tolerance"] = c.within_tolerance;
  json["tolerance_mm"] = options.tolerance_mm;
  json["deviation_mm"] = {{"max", d.max},
                          {"p99", d.p99},
                          {"rms", d.rms},
                          {"mean", d.mean},
                          {"at", {d.at.x(), d.at.y(), d.at.z()}},
                          {"bound", c.bound_mm},
                          {"capped", c.capped}};
  json["worst"] = {{"strip", report.strip}, {"rib", report.rib}};
  json["gouge_mm"] = c.gouge_mm;
  json["uncut_mm2"] = c.uncut_mm2;
  json["uncut_share"] = c.uncut_share();
  json["budget_mm"] = nlohmann::ordered_json::object();
  for (const auto& [name, mm] : report.budget_mm) json["budget_mm"][name] = mm;
  json["budget_sum_mm"] = report.budget_sum_mm();
  json["in_cell_mm"] = report.in_cell_mm();
  json["not_in_budget"] = report.not_in_budget;
  json["shape_mismatch_mm"] = report.shape_mismatch_mm;
  json["samples"] = {{"cut", c.cut_samples},
                     {"beyond_design", c.beyond_samples},
                     {"design", c.design_samples},
                     {"touches", report.touch_samples}};
  json["hot_poses"] = report.hot_poses;
  json["executed_s"] = report.executed_s;
  return json_text(json, 2);
}

std::string describe(const AsCutReport& report, const VerifyOptions& options) {
  const Deviation& d = report.cut.deviation;
  std::string text = fmt::format(
      "as cut: deviation max {}, p99 {:.3f} mm, rms {:.3f} mm, mean {:.3f} mm (tolerance {:.3g} mm), worst "
      "at "
      "({:.1f}, {:.1f}, {:.1f}) in {} near {}\n",
      largest_and_bound_text(report.cut), d.p99, d.rms, d.mean, options.tolerance_mm, d.at.x(), d.at.y(),
      d.at.z(), report.strip, report.rib);
  text += fmt::format("as cut: uncut {:.0f} mm2 ({:.2f} % of the design, limit {:.2f} %)\n",
                      report.cut.uncut_mm2, 100 * report.cut.uncut_share(), 100 * options.max_uncut_share);
  text += fmt::format("as cut: {} hot blade poses, deepest cut beside the design's {:.3f} mm\n",
                      report.hot_poses, report.cut.gouge_mm);
  text += fmt::format(
      "as cut: with the design's facets, the blade's weight and its clamps' errors, of which no log tells, "
      "{:.3f} mm\n",
      report.in_cell_mm());
  text += "budget, mm, of every line the most at any place:";
  for (const auto& [name, mm] : report.budget_mm) text += fmt::format(" {} {:.3f},", name, mm);
  text += fmt::format(" together {:.3f}\n", report.budget_sum_mm());
  for (const std::string& line : report.not_in_budget) text += "not in the budget: " + line + "\n";
  return text;
}

}  // namespace hotblade::pipeline
