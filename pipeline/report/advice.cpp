#include "pipeline/report/advice.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "pipeline/report/remedies.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/verify/verdict.hpp"

namespace hotblade::pipeline {

namespace {

// Whether y rather than z is up in a design: a surface that a blade sweeps from above faces upwards for the
// most part; a solid has sides as well.
bool faces_along_y(const surface::DesignSurface& design) {
  const surface::TriangleMesh& mesh = design.mesh;
  Eigen::Vector3d seen{0, 0, 0};  // areas, seen along each axis
  double area = 0;
  for (const auto& t : mesh.triangles()) {
    const auto at = [&](std::size_t i) { return mesh.vertices()[static_cast<std::size_t>(t[i])]; };
    const Eigen::Vector3d n = (at(1) - at(0)).cross(at(2) - at(0));
    seen += n.cwiseAbs();
    area += n.norm();
  }
  constexpr double kMostOfIt = 0.8, kMoreThanTheSides = 1.5;
  if (!design.health.closed) return seen.y() > kMostOfIt * area;
  return seen.y() > kMoreThanTheSides * std::max(seen.x(), seen.z());
}

bool refused_for(const PlanResult& result, Limit limit) {
  return std::any_of(result.refusals.begin(), result.refusals.end(),
                     [&](const Refusal& r) { return r.limit == limit; });
}

SettingsChange keep_change(Keep keep) {
  return {{fmt::format("design.keep={}", name(keep))},
          "",
          "the surface leans past the vertical",
          [keep](Settings& s) { s.design.keep = keep; }};
}

// A change of the refused plan's own settings.
SettingsChange change_of(const PlanResult& refused, const Remedy& remedy) {
  return {{assignment_of(refused.program.settings, remedy)}, "", remedy.why, [remedy](Settings& s) {
            s = with_remedy(std::move(s), remedy);
          }};
}

// Planes that were given, left to the search.
std::vector<SettingsChange> changes_of_planes(const SliceSettings& slice) {
  std::vector<SettingsChange> changes;
  const std::string why = "the planes that were given: others may do";
  const auto search = [](Settings& s) {
    s.slice.direction.reset();
    s.slice.fan_axis.reset();
  };
  if (slice.direction) changes.push_back({{}, "slice.direction", why, search});
  if (slice.fan_axis) changes.push_back({{}, "slice.fan_axis", why, search});
  return changes;
}

// The number of one setting, as the plan that was refused with another asks for; absent where it does not.
std::optional<SettingsChange> next_number(const SettingsChange& change, const PlanResult& refused,
                                          const PlanResult& again) {
  if (change.assignments.size() != 1) return std::nullopt;
  const std::string& assignment = change.assignments.front();
  const std::string key = assignment.substr(0, assignment.find('='));
  for (const Remedy& remedy : remedies(again)) {
    if (remedy.setting == key) return change_of(refused, remedy);
  }
  return std::nullopt;
}

TriedRemedy tried(const SettingsChange& change, const PlanResult& result) {
  return {change.assignments,
          change.without,
          change.why,
          result.program.verification.deviation_mm.max,
          result.program.verification.tolerance_mm,
          result.strips.size(),
          name(verdict_of(result.program).color)};
}

std::string as_option(const std::string& assignment) {
  for (const auto& [key, flag] :
       {std::pair{"design.up=", "--up "}, std::pair{"design.tolerance_mm=", "--tolerance "}}) {
    const std::string_view start(key);
    if (assignment.starts_with(start)) return flag + assignment.substr(start.size());
  }
  return "--set \"" + assignment + "\"";
}

}  // namespace

std::vector<SettingsChange> changes_by_shape(const PlanResult& refused,
                                             const surface::DesignSurface& design) {
  std::vector<SettingsChange> changes;
  const DesignSettings& now = refused.program.settings.design;
  const auto upper_faces = [](Settings& s) { s.design.facing = {{0, 0, 1}}; };
  const auto y_up = [](Settings& s) { s.design.up = "y"; };
  const std::string facing = "design.facing=[0, 0, 1]", up = "design.up=y";
  const bool solid = design.health.closed && !now.facing;
  const bool along_z = now.keep == Keep::kBelow || now.keep == Keep::kAbove;
  const bool lies = along_z && now.up == "z" && faces_along_y(design);
  if (solid && lies) {
    changes.push_back({{up, facing},
                       "",
                       "the design is a closed solid, and most of it faces along y: its upper faces alone",
                       [=](Settings& s) {
                         y_up(s);
                         upper_faces(s);
                       }});
  } else if (solid) {
    changes.push_back({{facing}, "", "the design is a closed solid: its upper faces alone", upper_faces});
  } else if (lies) {
    changes.push_back({{up}, "", "most of the design faces along y: y may be up in it", y_up});
  }
  return changes;
}

std::vector<SettingsChange> likely_changes(const PlanResult& refused, const surface::DesignSurface& design) {
  std::vector<SettingsChange> changes = changes_by_shape(refused, design);
  const Settings& settings = refused.program.settings;
  for (SettingsChange& change : changes_of_planes(settings.slice)) changes.push_back(std::move(change));
  const Keep keep = settings.design.keep;
  const bool along_z = keep == Keep::kBelow || keep == Keep::kAbove;
  if (refused_for(refused, Limit::kLean) && along_z) {
    changes.push_back(keep_change(Keep::kBack));
    changes.push_back(keep_change(Keep::kFront));
  }
  for (const Remedy& remedy : remedies(refused)) changes.push_back(change_of(refused, remedy));
  return changes;
}

std::vector<TriedRemedy> try_changes(const PlanResult& refused, const std::vector<SettingsChange>& changes,
                                     const PlanAgain& plan_again) {
  constexpr int kMostSteps = 3;
  std::vector<TriedRemedy> passed;
  int trials = 0;
  for (SettingsChange change : changes) {
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
      } catch (const surface::MeshError&) {
        break;  // no face looks that way
      }
      if (again.refusals.empty()) {
        passed.push_back(tried(change, again));
        break;
      }
      const std::optional<SettingsChange> next = next_number(change, refused, again);
      if (!next) break;
      change = *next;
    }
  }
  return passed;
}

std::string as_options(const TriedRemedy& remedy) {
  if (!remedy.without.empty()) return "without " + remedy.without;
  std::string text;
  for (const std::string& assignment : remedy.assignments)
    text += (text.empty() ? "" : " ") + as_option(assignment);
  return text;
}

std::string describe(const TriedRemedy& remedy) {
  return fmt::format("{}: passes, deviation {:.3f} mm (tolerance {:g} mm), {} strip{}, verdict {}",
                     as_options(remedy), remedy.deviation_mm, remedy.tolerance_mm, remedy.strips,
                     remedy.strips == 1 ? "" : "s", remedy.verdict);
}

}  // namespace hotblade::pipeline
