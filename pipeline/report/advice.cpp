#include "pipeline/report/advice.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "pipeline/report/remedies.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/verify/verdict.hpp"

namespace hotblade::pipeline {

namespace {

// The sizes of the faces' areas seen along each axis, and their areas.
struct Normals {
  Eigen::Vector3d sizes{0, 0, 0};
  double area = 0;
};

Normals normals_of(const surface::TriangleMesh& mesh) {
  Normals sum;
  for (const auto& t : mesh.triangles()) {
    const auto at = [&](std::size_t i) { return mesh.vertices()[static_cast<std::size_t>(t[i])]; };
    const Eigen::Vector3d n = (at(1) - at(0)).cross(at(2) - at(0));
    sum.sizes += n.cwiseAbs();
    sum.area += n.norm();
  }
  return sum;
}

bool refused_for(const PlanResult& result, Limit limit) {
  return std::any_of(result.refusals.begin(), result.refusals.end(),
                     [&](const Refusal& r) { return r.limit == limit; });
}

SettingsChange keep_change(Keep keep) {
  return {fmt::format("design.keep={}", name(keep)), "the surface leans past the vertical",
          [keep](Settings& s) { s.design.keep = keep; }};
}

// A change of the refused plan's own settings.
SettingsChange change_of(const PlanResult& refused, const Remedy& remedy) {
  return {assignment_of(refused.program.settings, remedy), remedy.why,
          [remedy](Settings& s) { s = with_remedy(std::move(s), remedy); }};
}

TriedRemedy tried(const SettingsChange& change, const PlanResult& result) {
  return {change.assignment,
          change.why,
          result.program.verification.deviation_mm.max,
          result.program.verification.tolerance_mm,
          result.strips.size(),
          name(verdict_of(result.program).color)};
}

}  // namespace

std::vector<SettingsChange> changes_by_shape(const PlanResult& refused,
                                             const surface::DesignSurface& design) {
  std::vector<SettingsChange> changes;
  const DesignSettings& now = refused.program.settings.design;
  if (design.health.closed && !now.facing) {
    changes.push_back(
        {"design.facing=[0, 0, 1]", "the design is a closed solid: its upper faces alone", [](Settings& s) {
           s.design.facing = {{0, 0, 1}};
         }});
  }
  // A surface that a blade sweeps from above faces upwards for the most part.
  constexpr double kMostOfIt = 0.8;
  const Normals normals = normals_of(design.mesh);
  const bool along_z = now.keep == Keep::kBelow || now.keep == Keep::kAbove;
  if (along_z && now.up == "z" && normals.sizes.y() > kMostOfIt * normals.area) {
    changes.push_back({"design.up=y", "most of the design faces along y: y may be up in it",
                       [](Settings& s) { s.design.up = "y"; }});
  }
  return changes;
}

std::vector<SettingsChange> likely_changes(const PlanResult& refused, const surface::DesignSurface& design) {
  std::vector<SettingsChange> changes = changes_by_shape(refused, design);
  const Keep keep = refused.program.settings.design.keep;
  const bool along_z = keep == Keep::kBelow || keep == Keep::kAbove;
  if (refused_for(refused, Limit::kLean) && along_z) {
    changes.push_back(keep_change(Keep::kBack));
    changes.push_back(keep_change(Keep::kFront));
  }
  for (const Remedy& remedy : remedies(refused)) changes.push_back(change_of(refused, remedy));
  return changes;
}

std::vector<TriedRemedy> try_changes(const PlanResult& refused, const surface::DesignSurface& design,
                                     const PlanAgain& plan_again) {
  constexpr int kMostSteps = 3;
  std::vector<TriedRemedy> passed;
  int trials = 0;
  for (SettingsChange change : likely_changes(refused, design)) {
    for (int step = 0; step < kMostSteps && trials < kMostTrials; ++step) {
      Settings settings = refused.program.settings;
      change.apply(settings);
      ++trials;
      PlanResult again;
      try {
        again = plan_again(settings);
      } catch (const Error& error) {
        if (error.kind == ErrorKind::kInterrupted) throw;
        break;  // settings that do not go together, or a design that they leave nothing of
      }
      if (again.refusals.empty()) {
        passed.push_back(tried(change, again));
        break;
      }
      const std::string key = change.assignment.substr(0, change.assignment.find('='));
      const std::vector<Remedy> further = remedies(again);
      const auto next =
          std::find_if(further.begin(), further.end(), [&](const Remedy& r) { return r.setting == key; });
      if (next == further.end()) break;
      change = change_of(refused, *next);
    }
  }
  return passed;
}

std::string describe(const TriedRemedy& remedy) {
  return fmt::format("{}: passes, deviation {:.3f} mm (tolerance {:g} mm), {} strip{}, verdict {}",
                     remedy.assignment, remedy.deviation_mm, remedy.tolerance_mm, remedy.strips,
                     remedy.strips == 1 ? "" : "s", remedy.verdict);
}

}  // namespace hotblade::pipeline
