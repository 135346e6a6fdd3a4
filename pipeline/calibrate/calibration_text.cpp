// A calibration as text: the settings file, the report for people and for programs.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "pipeline/calibrate/calibration.hpp"
#include "pipeline/settings/json_text.hpp"
#include "pipeline/settings/settings_fields.hpp"

namespace hotblade::pipeline {

namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

std::string_view placement_word(ScanPlacement placement) {
  return placement == ScanPlacement::kSearch ? "search"
         : placement == ScanPlacement::kNear ? "near"
                                             : "fixed";
}

// Angles to a microradian, all else to a tenth of a micrometre.
double rounded(std::size_t error, double value) {
  const double unit = info_of(error).unit == "rad" ? 1e-6 : 1e-4;
  return std::round(value / unit) * unit;
}

std::string number_of(std::size_t error, double value) {
  return info_of(error).unit == "rad" ? fmt::format("{:.6f}", value) : fmt::format("{:.4f}", value);
}

// What is known of one number.
std::string known(const Estimate& e, std::size_t error) {
  const auto i = static_cast<Eigen::Index>(error);
  if (!(e.expected[i] > 0)) return "not asked for";
  if (e.told_alone(error)) return "told";
  constexpr double kNothing = 0.95;
  return e.sd(error) > kNothing * e.expected[i] ? "not told" : "told with others only";
}

// What a number does not change is no fault of the scan.
constexpr std::string_view kStiffnessNote =
    "The stiffness E t^3 changes forces and sag only: the shape of a blade between its clamps does not "
    "depend on it but by "
    "weight.";

std::string with_uncertainty(const Estimate& e, std::size_t error) {
  return fmt::format("+- {} ({})", number_of(error, e.sd(error)), known(e, error));
}

std::string triple(const Estimate& e, CellError first) {
  std::string text = "[";
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t error = static_cast<std::size_t>(first) + k;
    text += (k > 0 ? ", " : "") + number_of(error, rounded(error, e.value[static_cast<Eigen::Index>(error)]));
  }
  return text + "]";
}

std::string triple_comment(const Estimate& e, CellError first) {
  std::string text;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t error = static_cast<std::size_t>(first) + k;
    text +=
        fmt::format("#   {}: {} {}\n", info_of(error).words,
                    number_of(error, e.value[static_cast<Eigen::Index>(error)]), with_uncertainty(e, error));
  }
  return text;
}

std::string foam_section(const Program& program, const Calibration& calibration) {
  const Settings settings = calibrated(program, calibration);
  const Estimate& e = calibration.estimate;
  constexpr auto kBand = static_cast<std::size_t>(CellError::kBand),
                 kSlowing = static_cast<std::size_t>(CellError::kSlowing);
  std::string text =
      fmt::format("# {}, {:g} mm/s: {} mm {}\n", info_of(kBand).words, program.settings.motion.feed_mm_s,
                  number_of(kBand, e.value[static_cast<Eigen::Index>(kBand)]), with_uncertainty(e, kBand));
  if (e.expected[static_cast<Eigen::Index>(kSlowing)] > 0)
    text += fmt::format("# {}: {} {}\n", info_of(kSlowing).words,
                        number_of(kSlowing, e.value[static_cast<Eigen::Index>(kSlowing)]),
                        with_uncertainty(e, kSlowing));
  const robot::Melt& melt = settings.blade.melt;
  if (!melt.band_mm_at_mm_s.empty()) {
    text += "band_mm_at_mm_s = [";
    for (std::size_t i = 0; i < melt.band_mm_at_mm_s.size(); ++i)
      text += fmt::format("{}[{:g}, {:.4f}]", i > 0 ? ", " : "", melt.band_mm_at_mm_s[i][0],
                          melt.band_mm_at_mm_s[i][1]);
    return text + "]\n";
  }
  return text + fmt::format("melt_mm2_s = {:.4f}\nloss_mm_s = {:.4f}\n", melt.melt_mm2_s, melt.loss_mm_s);
}

nlohmann::ordered_json misfit_json(const Misfit& misfit) {
  return {{"rms", misfit.rms_mm}, {"p95", misfit.p95_mm}, {"max", misfit.max_mm}};
}

}  // namespace

std::string calibration_toml(const Program& program, const Calibration& calibration) {
  const Estimate& e = calibration.estimate;
  const Settings settings = calibrated(program, calibration);
  constexpr auto kLength = static_cast<std::size_t>(CellError::kLength),
                 kStiffness = static_cast<std::size_t>(CellError::kStiffness),
                 kBand = static_cast<std::size_t>(CellError::kBand);
  const auto value = [&](std::size_t error) { return e.value[static_cast<Eigen::Index>(error)]; };
  std::string text = fmt::format(
      "# What hotblade calibrate found of the cell. Use: hotblade plan ... --config job.toml --config "
      "THIS_FILE\n"
      "# Scanned points off by {:.3f} mm (rms) of the cut as planned, {:.3f} mm of the cut as found here.\n"
      "# Each number with its standard deviation. What is told with others only is right in its blend with "
      "them,\n"
      "# not alone: take all of this file or nothing.\n",
      e.before.rms_mm, e.after.rms_mm);
  text += "\n[blade]\n";
  text += fmt::format("# {}: {} mm {}\nlength_error_mm = {}\n", info_of(kLength).words,
                      number_of(kLength, value(kLength)), with_uncertainty(e, kLength),
                      number_of(kLength, rounded(kLength, value(kLength))));
  text +=
      fmt::format("# {}: {} {}\n{}stiffness_error = {}\n", info_of(kStiffness).words,
                  number_of(kStiffness, value(kStiffness)), with_uncertainty(e, kStiffness),
                  known(e, kStiffness) == "not told" ? "# " : "", number_of(kStiffness, value(kStiffness)));
  if (!settings.blade.melt.by_speed())
    text +=
        fmt::format("# {}: {} mm {}\nkerf_mm = {}\n", info_of(kBand).words, number_of(kBand, value(kBand)),
                    with_uncertainty(e, kBand), number_of(kBand, rounded(kBand, settings.blade.kerf_mm)));
  if (settings.blade.melt.by_speed()) text += "\n[foam]\n" + foam_section(program, calibration);
  text += "\n[machine]\n";
  for (const auto& [key, first] :
       {std::pair{"clamp_a_shift_mm", CellError::kShiftA}, std::pair{"clamp_a_turn_rad", CellError::kTurnA},
        std::pair{"clamp_b_shift_mm", CellError::kShiftB}, std::pair{"clamp_b_turn_rad", CellError::kTurnB}})
    text += triple_comment(e, first) + fmt::format("{} = {}\n", key, triple(e, first));
  if (!e.untold.empty()) {
    text += "\n# Not to be told apart by the scan:\n";
    for (const Blend& blend : e.untold)
      text += fmt::format("#   {} ({:.0f} % of what it may be off by is left)\n", blend.describe(),
                          100 * blend.left);
  }
  return text;
}

std::string describe(const Calibration& calibration, const ErrorVector* truth) {
  const Estimate& e = calibration.estimate;
  std::string text;
  for (std::size_t s = 0; s < calibration.strips.size(); ++s) {
    const Eigen::AngleAxisd turn(e.scan_to_design[s].linear());
    const Eigen::Vector3d& shift = e.scan_to_design[s].translation();
    text += fmt::format(
        "scan of {}: {}, turned by {:.2f} degrees and moved by ({:.2f}, {:.2f}, {:.2f}) mm to the design\n",
        calibration.strips[s], calibration.files[s], turn.angle() / kDegree, shift.x(), shift.y(), shift.z());
  }
  text += fmt::format(
      "points {}, on the cut {}, beside it {}, far from it {}; {:.3f} mm of noise each{}\n", e.points, e.used,
      e.beside, e.far, e.noise_mm,
      e.correlation > 1.5 ? fmt::format(", {:.1f} neighbours say as much as one", e.correlation) : "");
  text += fmt::format("off the cut as planned: rms {:.3f}, 95 % {:.3f}, max {:.3f} mm\n", e.before.rms_mm,
                      e.before.p95_mm, e.before.max_mm);
  text += fmt::format("off the cut as found:   rms {:.3f}, 95 % {:.3f}, max {:.3f} mm\n", e.after.rms_mm,
                      e.after.p95_mm, e.after.max_mm);
  text += fmt::format("{:42}{:>12}{:>12}{:>12}{}  {}\n", "", "planned", "found", "+-",
                      truth ? "       truth" : "", "known");
  for (std::size_t i = 0; i < kCellErrors; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const CellErrorInfo& info = info_of(i);
    text += fmt::format("{:42}{:>12}{:>12}{:>12}{}  {}\n",
                        std::string(info.words) + (info.unit.empty() ? "" : ", " + std::string(info.unit)),
                        number_of(i, e.planned[k]), number_of(i, e.value[k]), number_of(i, e.sd(i)),
                        truth ? fmt::format("{:>12}", number_of(i, (*truth)[k])) : "", known(e, i));
  }
  if (!e.untold.empty()) text += "not to be told apart by this scan, and what is left of the doubt:\n";
  for (const Blend& blend : e.untold)
    text += fmt::format("  {:3.0f} %  {}\n", 100 * blend.left, blend.describe());
  if (known(e, static_cast<std::size_t>(CellError::kStiffness)) == "not told")
    text += std::string(kStiffnessNote) + "\n";
  return text;
}

std::string to_json(const Calibration& calibration, const ErrorVector* truth) {
  const Estimate& e = calibration.estimate;
  nlohmann::ordered_json json;
  json["scans"] = nlohmann::ordered_json::array();
  for (std::size_t s = 0; s < calibration.strips.size(); ++s) {
    const Eigen::Quaterniond q(e.scan_to_design[s].linear());
    const Eigen::Vector3d& p = e.scan_to_design[s].translation();
    json["scans"].push_back(
        {{"strip", calibration.strips[s]},
         {"file", calibration.files[s]},
         {"scan_to_design", {{"p", {p.x(), p.y(), p.z()}}, {"q", {q.w(), q.x(), q.y(), q.z()}}}}});
  }
  json["placement"] = placement_word(calibration.placement);
  json["points"] = {{"all", e.points}, {"on_cut", e.used}, {"beside", e.beside}, {"far", e.far}};
  json["noise_mm"] = e.noise_mm;
  json["correlation"] = e.correlation;
  json["misfit_mm"] = {{"planned", misfit_json(e.before)}, {"found", misfit_json(e.after)}};
  json["numbers"] = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < kCellErrors; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    nlohmann::ordered_json number{{"planned", e.planned[k]},
                                  {"found", e.value[k]},
                                  {"sd", e.sd(i)},
                                  {"expected", e.expected[k]},
                                  {"known", known(e, i)}};
    if (truth) number["truth"] = (*truth)[k];
    json["numbers"][std::string(info_of(i).key)] = std::move(number);
  }
  json["told"] = e.told;
  json["untold"] = nlohmann::ordered_json::array();
  for (const Blend& blend : e.untold) {
    nlohmann::ordered_json parts = nlohmann::ordered_json::object();
    for (const Blend::Part& part : blend.parts) parts[std::string(info_of(part.error).key)] = part.share;
    json["untold"].push_back({{"left", blend.left}, {"parts", std::move(parts)}, {"text", blend.describe()}});
  }
  return json_text(json, 2);
}

}  // namespace hotblade::pipeline
