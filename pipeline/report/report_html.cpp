#include "pipeline/report/report_html.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>

#include "pipeline/advice/advice.hpp"
#include "pipeline/report/arms_section.hpp"
#include "pipeline/report/page_texts.hpp"
#include "pipeline/report/places_table.hpp"
#include "pipeline/report/reasons.hpp"
#include "pipeline/report/refusal_text.hpp"
#include "pipeline/report/report_plots.hpp"
#include "pipeline/report/strip_table.hpp"
#include "pipeline/report/viewer_html.hpp"
#include "pipeline/report/words.hpp"
#include "pipeline/settings/json_text.hpp"
#include "pipeline/verify/verdict.hpp"

namespace hotblade::pipeline {

namespace {

// The rest would fill a page with directions nobody takes.
constexpr std::size_t kDirectionsShown = 12, kTriesShown = 12;

std::string place(const Eigen::Vector3d& p) {
  return fmt::format("({:.1f}, {:.1f}, {:.1f})", p.x(), p.y(), p.z());
}

double total_duration_s(const PlanResult& result) {
  double sum = 0;
  for (const StripFacts& f : result.strips) sum += f.motion.duration_s;
  return sum;
}

std::string capital(std::string words) {
  words.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(words.front())));
  return words;
}

// The verdict's headline (pipeline/verify/verdict.hpp) in the page's language.
std::string headline_text(const Verdict& v, const Words& w) {
  if (w.table().empty()) return capital(headline(v));
  if (v.color == VerdictColor::kRed) return w("Not cuttable as asked");
  if (v.color == VerdictColor::kGreen) return w("Can be cut as planned");
  if (!v.needed)
    return w.format("Can be cut, but not within {:g} mm for certain, however exact the clamps are",
                    v.tolerance_mm);
  return w.format("Can be cut within {:g} mm if the clamps are within {:g} mm and {:g} mrad", v.tolerance_mm,
                  v.needed->position_mm, 1e3 * v.needed->angle_rad);
}

std::string verdict_section(const PlanResult& result, const Words& w) {
  const Verification& v = result.program.verification;
  const Verdict verdict = verdict_of(result.program);
  std::string html = fmt::format("<div class=\"verdict {}\"><b>{}</b><br>", name(verdict.color),
                                 escaped(headline_text(verdict, w)));
  if (result.verification.cut_samples == 0) {
    html += w("Nothing is cut: no deviation could be measured.");
  } else if (result.verification.capped) {
    html += w.format(
        "The surface the program cuts deviates from the design by at least <strong>{:.3f} mm</strong> "
        "(tolerance {:g} mm); worst at {}.",
        v.deviation_mm.max, v.tolerance_mm, place(v.deviation_mm.at));
  } else {
    html += w.format(
        "The largest deviation measured of the surface the program cuts is <strong>{:.3f} mm</strong>, and "
        "nowhere is it more than {:.3f} mm (tolerance {:g} mm); worst at {}.",
        v.deviation_mm.max, result.verification.bound_mm, v.tolerance_mm, place(v.deviation_mm.at));
  }
  html += " " + w.format("{:.2f} % of the design is left uncut.", 100 * result.verification.uncut_share());
  if (verdict.over_budget() && result.verification.cut_samples > 0) {
    html += " " + w.format(
                      "Together with the errors of clamps, weight and mesh that no measurement of the plan "
                      "can see, the error budget comes to <strong>{:.3f} mm</strong>, more than the "
                      "tolerance; {:.3f} mm of it are the clamps', which may err by {:g} mm and {:g} mrad.",
                      verdict.budget_mm, verdict.clamp_mm, verdict.planned.position_mm,
                      1e3 * verdict.planned.angle_rad);
  }
  return html + "</div>\n";
}

std::string refusals_section(const PlanResult& result, const Words& w) {
  if (result.refusals.empty()) return "";
  std::string html = "<h2>" + w("Why it is refused") + "</h2><table><tr><th class=\"l\">" + w("where") +
                     "</th><th class=\"l\">" + w("limit") + "</th><th>" + w("is") + "</th><th>" +
                     w("allowed") + "</th><th class=\"l\">" + w("note") + "</th></tr>\n";
  for (const Refusal& r : result.refusals) {
    const AmountText amount = amount_text(r);
    html += fmt::format(
        "<tr><td class=\"l\">{} {} {}</td><td class=\"l\">{}</td><td class=\"bad\">{}{} "
        "{}</td><td>{} {}</td><td class=\"l say\">{}</td></tr>\n",
        escaped(w.said(r.strip)), escaped(r.rib), escaped(w.said(r.place)), escaped(limit_text(r, w)),
        r.capped ? "&ge; " : "", amount.value, escaped(unit(r, w)), amount.bound, escaped(unit(r, w)),
        escaped(note(r, w)));
  }
  html += "</table>\n";
  if (result.remedies.empty())
    html += "<p class=\"note\">" +
            w("No other settings were found to pass. plan --advise tries more of them.") + "</p>\n";
  return html;
}

std::string remedies_section(const PlanResult& result, const Words& w) {
  if (result.remedies.empty()) return "";
  std::string html = "<h2>" + w("What makes it cuttable") + "</h2>\n<table><tr><th class=\"l\">" + w("with") +
                     "</th><th>" + w("deviation") + "</th><th>" + w("tolerance") + "</th><th>" + w("strips") +
                     "</th><th>" + w("verdict") + "</th><th class=\"l\">" + w("because") + "</th></tr>\n";
  for (const TriedRemedy& m : result.remedies) {
    html += fmt::format(
        "<tr><td class=\"l\"><b>{}</b></td><td class=\"n\">{:.3f} mm</td><td class=\"n\">{:g} "
        "mm</td><td>{}</td><td>{}</td><td class=\"l say\">{}</td></tr>\n",
        escaped(w.said(as_options(m))), m.deviation_mm, m.tolerance_mm, m.strips, escaped(w(m.verdict)),
        escaped((m.narrowed ? w.said(describe(*m.narrowed)) + ": " : "") + w.said(m.why)));
  }
  return html + "</table>\n<p class=\"note\">" + w("Each was planned with all else as it is, and passed.") +
         "</p>\n";
}

std::string figure(const std::string& value, const std::string& name) {
  return fmt::format("<div><b>{}</b><span>{}</span></div>\n", value, name);
}

std::string figures_section(const PlanResult& result, const Words& w) {
  std::size_t ribs = 0;
  double foam_l = 0;
  for (const StripFacts& f : result.strips) {
    ribs += f.ribs;
    foam_l += f.stock_volume_mm3 * 1e-6;
  }
  const Deviation& d = result.program.verification.deviation_mm;
  std::string html = "<div class=\"figures\">";
  const bool cut = result.verification.cut_samples > 0;
  const auto deviation = [&](double mm) { return cut ? fmt::format("{:.3f} mm", mm) : w("nothing is cut"); };
  html += figure((result.verification.capped ? "&ge; " : "") + deviation(d.max), w("largest deviation"));
  html += figure(deviation(d.p99), w("deviation of 99 % of the area"));
  html += figure(fmt::format("{}", result.strips.size()), w("strips (blocks of foam)"));
  html += figure(fmt::format("{}", ribs), w.format("ribs, at most {:.3g} mm apart", result.spacing_mm));
  html += figure(duration(total_duration_s(result)), w("time on the machine"));
  html += figure(fmt::format("{:.1f} l", foam_l), w("foam in all blocks"));
  return html + "</div>\n";
}

std::string picture(const ReportPicture& p, const Words& w) {
  return fmt::format(
      "<figure><img alt=\"{0}\" src=\"data:image/png;base64,{1}\"><figcaption>{0}</figcaption></figure>\n",
      escaped(w.said(p.caption)), base64(p.png));
}

// The view stands in the first picture's place, around it; without a picture, a line stands in for it.
std::string pictures_section(const std::vector<ReportPicture>& pictures, const std::string& note,
                             const std::optional<ViewerScene>& view, const Words& w) {
  const std::string none = "<p>" + w("No pictures") + ": " + escaped(w.said(note)) + ".</p>\n";
  if (pictures.empty() && !view) return "<h2>" + w("Pictures") + "</h2>" + none;
  std::string html = "<h2>" + w("What is cut") + "</h2>\n";
  if (view) html += viewer_html(*view, pictures.empty() ? none : picture(pictures.front(), w), w);
  html += view ? "<div class=\"pictures more\">\n" : "<div class=\"pictures\">\n";
  for (std::size_t i = view ? 1 : 0; i < pictures.size(); ++i) html += picture(pictures[i], w);
  return html + "</div>\n";
}

std::string deviation_section(const PlanResult& result, const Words& w) {
  const VerifyReport& v = result.verification;
  if (v.cut_samples == 0) return "";
  std::string html = "<h2>" + w("Deviation") + "</h2><p>" +
                     w.format("{} samples of the cut against the design, {} of the design against the cut.",
                              v.cut_samples - v.beyond_samples, v.design_samples);
  if (v.beyond_samples > 0)
    html +=
        " " +
        (result.faces.empty()
             ? w.format("{} samples of the cut lie beyond the design's border, in waste.", v.beyond_samples)
             : w.format("{} samples of the cut lie beyond the border or a crease of their face, in foam "
                        "that is not the part.",
                        v.beyond_samples));
  html += "</p>\n";
  html += histogram_svg(v.histogram, result.program.verification.tolerance_mm, w);
  std::string heads, cells;
  for (const auto& [percent, mm] : v.percentiles_mm) {
    heads += fmt::format("<th>{:g} %</th>", percent);
    cells += fmt::format("<td>{:.4f}</td>", mm);
  }
  return html + "<table><tr><th class=\"l\">" + w("share of the area") + "</th>" + heads +
         "</tr><tr><td class=\"l\">" + w("within, mm") + "</td>" + cells + "</tr></table>\n";
}

std::string budget_section(const PlanResult& result, const Words& w) {
  const Verification& v = result.program.verification;
  if (v.budget_mm.empty() || result.verification.cut_samples == 0) return "";
  return "<h2>" + w("Error budget") + "</h2><p>" +
         w("What each step of the chain may add, each measured on its own; the sum is the worst case, in "
           "which "
           "all add up. A measured deviation over the tolerance is refused; a sum over it makes the verdict "
           "amber.") +
         "</p>\n" + budget_svg(v.budget_mm, v.tolerance_mm, w);
}

// Adding zero takes the sign off a zero.
std::string vector_text(const Eigen::Vector3d& v, double digits) {
  const Eigen::Vector3d r = (digits * v).array().round().matrix() / digits + Eigen::Vector3d::Zero();
  return fmt::format("({:g}, {:g}, {:g})", r.x(), r.y(), r.z());
}

const char* way_text(SweepWay way) {
  switch (way) {
    case SweepWay::kEven:
      return "of the whole";
    case SweepWay::kRows:
      return "rows of blocks";
    case SweepWay::kSplit:
      return "split where the one before fails";
    case SweepWay::kMet:
      return "fitted together by what the one before found";
    case SweepWay::kUnsteady:
      return "with shorter blades where steadier ones fail";
    case SweepWay::kCalmer:
      return "calmer where the one before fails";
    case SweepWay::kTurned:
      return "planes turned on until the fit is nearer";
    case SweepWay::kFaces:
      return "all smooth faces together";
    case SweepWay::kParted:
      return "split where no strip serves, in the fewest parts";
  }
  return "";
}

// The number of the face that this entry of a list is about, from 1 on; 0: of the whole design.
std::size_t face_of(const PlanResult& result, FacePlanned::Range FacePlanned::*list, std::size_t entry) {
  for (std::size_t f = 0; f < result.faces.size(); ++f) {
    const FacePlanned::Range& range = result.faces[f].*list;
    if (entry - range.first < range.count) return f + 1;
  }
  return 0;
}

std::string of_face(std::size_t face, const std::string& text, const Words& w) {
  return face == 0 ? text : w.format("face {}: {}", face, text);
}

// Every try at the plan, in their order.
std::string decisions_section(const PlanResult& result, const Words& w) {
  if (result.decisions.empty()) return "";
  std::string html = "<h2>" + w("What was tried") + "</h2><table><tr><th class=\"l\">" + w("parts") +
                     "</th><th class=\"l\">" + w("planes") + "</th><th>" + w("strips") + "</th><th>" +
                     w("ribs") + "</th><th>" + w("fit mm") + "</th><th>" + w("deviation mm") +
                     "</th><th class=\"l\">" + w("found") + "</th></tr>\n";
  const std::size_t shown = std::min(kTriesShown, result.decisions.size());
  const auto mm = [](double value) { return value > 0 ? fmt::format("{:.3f}", value) : std::string("-"); };
  // The last ones: the one that was taken is the last of all.
  for (std::size_t i = result.decisions.size() - shown; i < result.decisions.size(); ++i) {
    const Decision& d = result.decisions[i];
    const std::string found = d.taken && d.passed ? w("passes, taken")
                              : d.passed          ? w("passes")
                              : d.stopped_by      ? describe(*d.stopped_by, w)
                                                  : "";
    html += fmt::format(
        "<tr><td class=\"l\">{}</td><td class=\"l\">{}{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td "
        "class=\"l say\">{}</td></tr>\n",
        of_face(face_of(result, &FacePlanned::decisions, i),
                w(way_text(d.way)) + (d.alone ? ", " + w("strips by themselves") : std::string()), w),
        d.fan ? w("a fan, in the middle") + " " : std::string(),
        d.way == SweepWay::kFaces ? w("each face's own") : vector_text(d.normal, 1e4), d.strips, d.ribs,
        mm(d.fit_mm), mm(d.deviation_mm), escaped(found));
  }
  html += "</table><p class=\"note\">" +
          w("Planes by their normals; slice.direction gives one, slice.fan_axis an axis.");
  if (shown < result.decisions.size())
    html += " " + w.format("{} earlier ones stand in report.json.", result.decisions.size() - shown);
  return html + "</p>\n";
}

std::string planes_text(const surface::PlaneFamily& planes, const Words& w) {
  if (!planes.turns()) return w("normal") + " " + vector_text(planes.normal(0), 1e4);
  return w("turn about") + " " + vector_text(planes.axis(), 1e4) + " " + w("at") + " " +
         vector_text(planes.centre(), 10) + " mm";
}

// The first of the ranking, of a design with creases the first of each face's.
std::vector<std::size_t> shown_of_ranking(const PlanResult& result) {
  std::vector<std::size_t> shown;
  std::vector<FacePlanned::Range> lists{{0, result.ranking.size()}};
  if (!result.faces.empty()) {
    lists.clear();
    for (const FacePlanned& face : result.faces) lists.push_back(face.ranking);
  }
  const std::size_t of_each = std::max<std::size_t>(1, kDirectionsShown / lists.size());
  for (const FacePlanned::Range& list : lists) {
    for (std::size_t i = 0; i < std::min(of_each, list.count); ++i) shown.push_back(list.first + i);
  }
  shown.resize(std::min(shown.size(), kDirectionsShown));
  return shown;
}

std::string ranking_section(const PlanResult& result, const Words& w) {
  if (result.ranking.empty()) return "";
  std::string html = "<h2>" + w("Directions ranked") + "</h2><table><tr><th class=\"l\">" + w("planes") +
                     "</th><th>" + w("parts along sweep x ribs") + "</th><th>" +
                     w("missed by elastica, from Beziers mm") + "</th><th>" + w("cheap fit mm") +
                     "</th></tr>\n";
  const std::vector<std::size_t> shown = shown_of_ranking(result);
  for (const std::size_t i : shown) {
    const PlanesTried& d = result.ranking[i];
    html += fmt::format("<tr><td class=\"l\">{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                        of_face(face_of(result, &FacePlanned::ranking, i), planes_text(d.planes, w), w),
                        d.of_rows() ? rows_text(d, w) : fmt::format("{} x {}", d.along_sweep, d.along_ribs),
                        std::isfinite(d.missed_mm) ? fmt::format("{:.2f}", d.missed_mm) : "-",
                        d.fit_mm ? fmt::format("{:.2f}", *d.fit_mm) : w("none"));
  }
  html +=
      "</table><p class=\"note\">" +
      w("The best are fitted closely and turned where they do not serve; slice.direction fixes the planes, "
        "slice.fan_axis an axis.");
  if (shown.size() < result.ranking.size())
    html += " " + w.format("{} more stand in report.json.", result.ranking.size() - shown.size());
  return html + "</p>\n";
}

std::string list_section(const std::string& title, const std::vector<std::string>& lines) {
  if (lines.empty()) return "";
  std::string html = "<h2>" + title + "</h2><ul>\n";
  for (const std::string& line : lines) html += "<li>" + escaped(line) + "</li>\n";
  return html + "</ul>\n";
}

std::vector<std::string> said(std::vector<std::string> lines, const Words& w) {
  for (std::string& line : lines) line = w.said(line);
  return lines;
}

// Those of the plan that its program was written all the same.
std::vector<std::string> overridden(const PlanResult& result, const Words& w) {
  std::vector<std::string> lines;
  if (result.program.overrides.empty()) return lines;
  for (const Refusal& refusal : result.refusals) lines.push_back(describe(refusal, w));
  return lines;
}

// What it means that a setting is absent.
std::string absent_text(const std::string& key, const nlohmann::ordered_json& settings, const Words& w) {
  if (key == "direction" && settings["slice"]["fan_axis"].is_null()) return w("searched");
  return w(key == "facing" ? "all faces" : "none");
}

std::string settings_section(const PlanResult& result, const Words& w) {
  std::string html = "<h2>" + w("Settings") + "</h2><div class=\"settings\">\n";
  const nlohmann::ordered_json settings = to_json(result.program.settings);
  for (const auto& [section, values] : settings.items()) {
    html += "<div><b>[" + escaped(section) + "]</b>";
    for (const auto& [key, value] : values.items()) {
      html += escaped(key) + " = " +
              (value.is_null() ? absent_text(key, settings, w) : escaped(json_text(value))) + "<br>";
    }
    html += "</div>\n";
  }
  return html + "</div>\n";
}

// Number, date and author of the job and the line to sign, where the job has any of them.
std::string job_line(const JobSettings& job, const Words& w) {
  std::string html;
  for (const auto& [word, value] :
       {std::pair{"Job", &job.number}, std::pair{"Date", &job.date}, std::pair{"Author", &job.author}}) {
    if (!value->empty()) html += "<span>" + w(word) + " <b>" + escaped(*value) + "</b></span>";
  }
  if (html.empty()) return "";
  return "<div class=\"job\">" + html + "<span class=\"sign\">" + w("Released by") + " (" +
         w("date, signature") + ")</span></div>\n";
}

std::string heading(const PlanResult& result, const std::string& program_sha256, const Words& w) {
  const DesignData& d = result.program.design;
  const Eigen::Vector3d size = d.bbox_mm[1] - d.bbox_mm[0];
  std::string html = "<h1>" + escaped(d.file) + "</h1>" + job_line(result.program.settings.job, w) +
                     "<p class=\"sub\">" +
                     w.format("{:.1f} x {:.1f} x {:.1f} mm, {} faces, read in {}; foam kept: {}.", size.x(),
                              size.y(), size.z(), d.faces, escaped(d.source_units), w.said(name(d.keep))) +
                     fmt::format(" SHA-256 {}. {}.", escaped(d.sha256), escaped(result.program.created_by));
  if (!program_sha256.empty())
    html += " " + w("SHA-256 of program.json") + ": " + escaped(program_sha256) + ".";
  html += "</p>\n";
  if (!program_sha256.empty())
    html += "<p><a href=\"sheets.html\">" + w("Sheets for the floor") + "</a>: " + w("one for each block") +
            "</p>\n";
  return html;
}

}  // namespace

std::string report_html(const PlanResult& result, const std::vector<ReportPicture>& pictures,
                        const std::string& picture_note, const std::string& program_sha256,
                        const std::optional<ViewerScene>& view) {
  const Words w(result.program.settings.job.language);
  std::string html = "<!doctype html>\n<html lang=\"" + w.language() +
                     "\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
                     "content=\"width=device-width, initial-scale=1\"><title>" +
                     escaped(result.program.design.file) + ": " +
                     w.said(name(result.program.verification.status)) + "</title><style>" +
                     std::string(page_style()) + "</style></head><body>\n";
  html += heading(result, program_sha256, w) + verdict_section(result, w) + refusals_section(result, w) +
          remedies_section(result, w);
  html += figures_section(result, w);
  html += pictures_section(pictures, picture_note, view, w) + strips_section(result, w) +
          places_section(result, w, !program_sha256.empty()) + arms_section(result, w) +
          reasons_section(result, w) + deviation_section(result, w);
  html += budget_section(result, w) + list_section(w("Warnings"), said(result.warnings, w));
  html += list_section(w("Refusals overridden"), overridden(result, w));
  html += list_section(w("Not checked"), said(result.program.verification.not_checked, w));
  html += decisions_section(result, w) + ranking_section(result, w) + settings_section(result, w);
  if (view) html += "<script>" + std::string(viewer_script()) + "</script>\n";
  return html + "</body></html>\n";
}

}  // namespace hotblade::pipeline
