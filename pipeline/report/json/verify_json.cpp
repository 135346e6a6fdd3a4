#include "pipeline/report/json/verify_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "pipeline/settings/json_text.hpp"
#include "pipeline/verify/verdict.hpp"

namespace hotblade::pipeline {

std::string verify_json(const Program& program, const VerifyReport& report, const VerifyOptions& options,
                        const nlohmann::ordered_json& joints) {
  const Deviation& d = report.deviation;
  nlohmann::ordered_json json;
  json["within_tolerance"] = report.within_tolerance;
  json["held"] = report.holds();
  json["status_of_plan"] = name(program.verification.status);
  json["verdict_of_plan"] = to_json(verdict_of(program));
  json["tolerance_mm"] = options.tolerance_mm;
  json["deviation_mm"] = {{"max", d.max},
                          {"p99", d.p99},
                          {"rms", d.rms},
                          {"mean", d.mean},
                          {"at", {d.at.x(), d.at.y(), d.at.z()}},
                          {"bound", report.bound_mm},
                          {"capped", report.capped}};
  json["uncut_mm2"] = report.uncut_mm2;
  json["uncut_share"] = report.uncut_share();
  json["samples"] = {{"cut", report.cut_samples}, {"design", report.design_samples}};
  json["clamp_mismatch_mm"] = report.clamp_mismatch_mm;
  json["rib_mismatches"] = report.ribs.mismatches.size();
  json["bezier_limit_mm"] = report.ribs.bezier_limit_mm;
  json["far_beziers"] = nlohmann::ordered_json::array();
  for (const FarBezier& b : report.ribs.far) {
    nlohmann::ordered_json far{{"strip", b.strip}, {"rib", b.rib}};
    if (std::isfinite(b.hausdorff_mm)) {
      far["hausdorff_mm"] = b.hausdorff_mm;
    } else {
      far["hausdorff_mm"] = nullptr;
    }
    json["far_beziers"].push_back(far);
  }
  json["motion_breaches"] = nlohmann::ordered_json::array();
  for (const MotionBreach& b : report.motion)
    json["motion_breaches"].push_back(
        {{"strip", b.strip}, {"pose", b.pose}, {"t_s", b.t_s}, {"text", b.text}});
  json["strips"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < program.strips.size(); ++i)
    json["strips"].push_back({{"id", program.strips[i].id},
                              {"deviation_max_mm", report.strip_max_mm[i]},
                              {"deviation_bound_mm", report.strip_bound_mm[i]}});
  if (!joints.is_null()) json["joints"] = joints;
  json["not_checked"] = program.verification.not_checked;
  return json_text(json, 2) + "\n";
}

}  // namespace hotblade::pipeline
