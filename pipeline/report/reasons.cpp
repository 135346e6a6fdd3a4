#include "pipeline/report/reasons.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>

#include "pipeline/report/refusal_text.hpp"
#include "pipeline/report/report_plots.hpp"
#include "pipeline/report/strip_table.hpp"

namespace hotblade::pipeline {

namespace {

constexpr double kDegrees = 57.29577951308232;
// Planes turned by less were tried as the same direction (docs/planning.md, Swept families: 6, 3, 1.5).
constexpr double kOtherDirection_deg = 10;
constexpr std::size_t kFacesShown = 24;  // on the page

std::string vector_text(const Eigen::Vector3d& v) {
  // Adding zero takes the sign off a zero.
  const Eigen::Vector3d r = (1000 * v).array().round().matrix() / 1000 + Eigen::Vector3d::Zero();
  return fmt::format("({:g}, {:g}, {:g})", r.x(), r.y(), r.z());
}

// Between planes with these normals, whichever way they point.
double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return kDegrees * std::acos(std::min(1.0, std::abs(a.normalized().dot(b.normalized()))));
}

const Decision* taken(const PlanResult& result) {
  const auto found = std::find_if(result.decisions.begin(), result.decisions.end(),
                                  [](const Decision& d) { return d.taken && d.passed; });
  return found == result.decisions.end() ? nullptr : &*found;
}

// What was tried of a design, or of one of its faces, and what was taken.
struct Choice {
  std::span<const Decision> decisions;
  std::span<const PlanesTried> ranking;
  std::span<const StripFacts> strips;
  std::size_t strips_lower_bound = 1;
  const Decision* taken = nullptr;  // null: none passed
};

Choice choice_of(const PlanResult& result) {
  return {result.decisions, result.ranking, result.strips, result.strips_lower_bound, taken(result)};
}

Choice choice_of(const PlanResult& result, const FacePlanned& face) {
  const auto part = [](auto list, const FacePlanned::Range& range) {
    return list.subspan(range.first, range.count);
  };
  Choice choice{part(std::span(result.decisions), face.decisions),
                part(std::span(result.ranking), face.ranking), part(std::span(result.strips), face.strips),
                face.strips_lower_bound, nullptr};
  // A face's search ends with what passes; the plan that is taken is that of all together.
  if (!choice.decisions.empty() && choice.decisions.back().passed) choice.taken = &choice.decisions.back();
  return choice;
}

// Of which a strip is one.
Choice choice_of(const PlanResult& result, std::size_t strip) {
  for (const FacePlanned& face : result.faces) {
    if (strip - face.strips.first < face.strips.count) return choice_of(result, face);
  }
  return choice_of(result);
}

bool is_other(const PlanesTried& tried, const Decision& decision) {
  return tried.planes.turns() != decision.fan ||
         angle_deg(tried.planes.normal(0), decision.normal) > kOtherDirection_deg;
}

std::size_t parts(const PlanesTried& tried) {
  if (tried.strips_in_rows > 0) return tried.strips_in_rows;
  return tried.of_rows() ? static_cast<std::size_t>(std::ceil(tried.blocks))
                         : tried.along_sweep * tried.along_ribs;
}

// What a ranked family came to: its cheap fit, or what its sections' Beziers say that elastica miss.
std::string came_to(const PlanesTried& tried, const Words& w) {
  if (tried.of_rows()) return rows_text(tried, w);
  std::string text = parts(tried) == 1 ? w("one part") : w.format("{} parts", parts(tried));
  if (tried.fit_mm) return text + ", " + w.format("its cheap fit is off by {:.2f} mm", *tried.fit_mm);
  if (!std::isfinite(tried.missed_mm)) return text + ", " + w("no elastica follow its sections");
  return text + ", " + w.format("elastica miss its sections by {:.2f} mm", tried.missed_mm);
}

// Of those that `counts`: fitted ones first, and rows that were laid, then fewer parts, then what is less
// off. Null: none.
template <typename Counts>
const PlanesTried* best(const Choice& choice, const Counts& counts) {
  const auto rank = [](const PlanesTried& d) {
    const bool only_weighed = d.of_rows() && d.strips_in_rows == 0;
    return std::tuple(!d.fit_mm, only_weighed, parts(d), d.fit_mm ? *d.fit_mm : d.missed_mm);
  };
  const PlanesTried* found = nullptr;
  for (const PlanesTried& d : choice.ranking) {
    if (counts(d) && (found == nullptr || rank(d) < rank(*found))) found = &d;
  }
  return found;
}

std::string planes_text(const PlanesTried& d, const Words& w) {
  return (d.planes.turns() ? w("a fan about") + " " + vector_text(d.planes.axis())
                           : w("planes with the normal") + " " + vector_text(d.planes.normal(0)));
}

// Why these planes and not others.
std::string direction_text(const Choice& choice, const SliceSettings& given, const Words& w) {
  if (choice.taken == nullptr) return "";
  if (given.direction) return w("The planes were given by slice.direction.");
  if (given.fan_axis) return w("The planes were given by slice.fan_axis.");
  std::string text;
  const Decision& decision = *choice.taken;
  const auto other = [&](const PlanesTried& d) { return is_other(d, decision); };
  const PlanesTried* own = best(choice, [&](const PlanesTried& d) { return !other(d); });
  const PlanesTried* next = best(choice, other);
  if (own != nullptr && own->of_rows()) {
    text = w.format(
        "{} ways to lay planes were ranked by the strips that their rows of blocks take; of these: {}.",
        choice.ranking.size(), came_to(*own, w));
  } else if (own != nullptr)
    text =
        w.format("{} ways to lay planes were ranked; of these: {}.", choice.ranking.size(), came_to(*own, w));
  if (next != nullptr)
    text +=
        " " + w.format("The best of the other directions, {}: {}.", planes_text(*next, w), came_to(*next, w));
  for (const Decision& d : choice.decisions) {
    if (d.passed || (d.fan == decision.fan && angle_deg(d.normal, decision.normal) <= kOtherDirection_deg))
      continue;
    text += " " + w.format("Tried in full and refused, normal {}: {}.", vector_text(d.normal),
                           d.stopped_by ? escaped(describe(*d.stopped_by, w)) : "");
    break;
  }
  return text;
}

// Why so many strips.
std::string split_text(const Choice& choice, const Words& w) {
  if (choice.taken == nullptr || choice.strips.empty()) return "";
  const std::size_t count = choice.strips.size();
  std::string text;
  // The nearest try that would have taken less foam.
  const Decision* coarser = nullptr;
  for (const Decision& d : choice.decisions) {
    if (!d.passed && d.strips < count && (coarser == nullptr || d.strips >= coarser->strips)) coarser = &d;
  }
  if (coarser != nullptr) {
    text = w.format("{} instead of {} strips were tried and refused: {}.", coarser->strips, count,
                    coarser->stopped_by ? escaped(describe(*coarser->stopped_by, w)) : "");
  } else if (count == 1) {
    text = w("One strip does.");
  } else if (count <= choice.strips_lower_bound) {
    text = w.format("No fewer can cut it: by its area and size it takes {} at least.",
                    choice.strips_lower_bound);
  } else {
    text = w.format("By its area and size {} would be the least.", choice.strips_lower_bound) + " ";
    const PlanesTried* fewer = best(choice, [&](const PlanesTried& d) { return parts(d) < count; });
    const PlanesTried* rows = best(choice, [](const PlanesTried& d) { return d.of_rows(); });
    if (rows != nullptr)
      return text + w.format("Its rows of blocks come to about {} strips; what fails in one is split again.",
                             parts(*rows));
    text += fewer != nullptr && fewer->fit_mm
                ? w.format("The best cheap fit of fewer parts: {}.", came_to(*fewer, w))
                : w.format("Of fewer than {} parts no layout had a cheap fit of them all.", count);
  }
  return text;
}

// What one more strip would cost.
std::string cost_text(std::span<const StripFacts> strips, const Words& w) {
  const auto count = static_cast<double>(strips.size());
  double seconds = 0, foam_l = 0;
  for (const StripFacts& f : strips) {
    seconds += f.motion.duration_s / count;
    foam_l += 1e-6 * f.stock_volume_mm3 / count;
  }
  return w.format(
      "A strip takes {} on the machine and {:.1f} l of foam on average: about that is what one more "
      "would cost.",
      duration(seconds), foam_l);
}

std::string item(const std::string& name, const std::string& text) {
  return "<li><b>" + name + ".</b> " + text + "</li>";
}

// A row for each face, with what was chosen for it.
std::string faces_table(const PlanResult& result, const Words& w) {
  std::string html = "<div class=\"scroll\"><table><tr>";
  for (const char* column : {"face", "strips", "Direction", "Split"})
    html += "<th class=\"l\">" + w(column) + "</th>";
  html += "</tr>\n";
  const std::size_t shown = std::min(kFacesShown, result.faces.size());
  for (std::size_t i = 0; i < shown; ++i) {
    const FacePlanned& face = result.faces[i];
    const Choice choice = choice_of(result, face);
    if (choice.strips.empty()) continue;
    const std::string &first = choice.strips.front().id, &last = choice.strips.back().id;
    html += fmt::format(
        "<tr><td class=\"l\">{}</td><td class=\"l\">{}</td><td class=\"l say\">{}</td><td class=\"l "
        "say\">{}</td></tr>\n",
        i + 1, escaped(first == last ? first : first + " - " + last),
        direction_text(choice, result.program.settings.slice, w), split_text(choice, w));
  }
  html += "</table></div>\n";
  if (shown < result.faces.size())
    html += "<p class=\"note\">" + w.format("{} more stand in report.json.", result.faces.size() - shown) +
            "</p>\n";
  return html;
}

}  // namespace

std::string rows_text(const PlanesTried& tried, const Words& w) {
  if (tried.strips_in_rows == 0)
    return w.format("{:.1f} blocks or more, if none were wasted at the border", tried.blocks);
  return w.format("about {} strips", tried.strips_in_rows);
}

std::string direction_reason(const PlanResult& result, const Words& w) {
  return direction_text(choice_of(result), result.program.settings.slice, w);
}

std::string split_reason(const PlanResult& result, const Words& w) {
  const std::string text = split_text(choice_of(result), w);
  return text.empty() ? "" : text + " " + cost_text(result.strips, w);
}

std::string creases_reason(const PlanResult& result, const Words& w) {
  if (result.faces.empty() || taken(result) == nullptr) return "";
  return w.format(
             "The design has {} smooth faces that lie apart or meet in creases, which no strip follows far "
             "to "
             "both sides within the tolerance; each was planned as a design of its own.",
             result.faces.size()) +
         " " + cost_text(result.strips, w);
}

std::string blade_text(const BladeTrial& trial, const Words& w) {
  const std::string length = fmt::format("{:.0f} mm: ", trial.length_mm);
  if (trial.refusal.limit != Limit::kNone) return length + escaped(describe_amount(trial.refusal, w));
  if (!std::isfinite(trial.sag_mm)) return length + w("it does not hold its own weight");
  return length + w.format("weight moves the cut by {:.2f} mm", trial.sag_mm);
}

std::string reasons_section(const PlanResult& result, const Words& w) {
  const Decision* decision = taken(result);
  if (decision == nullptr) return "";
  std::string html = "<h2>" + w("Why this plan") + "</h2>";
  if (result.faces.empty()) {
    html += "<ul>" + item(w("Direction"), direction_reason(result, w)) +
            item(w("Split"), split_reason(result, w));
  } else {
    html +=
        "<ul>" + item(w("Faces"), creases_reason(result, w)) + "</ul>\n" + faces_table(result, w) + "<ul>";
  }
  html +=
      item(w("Blade"), w("The shortest that clears the block, bends within yield and holds its shape, or a "
                         "longer one where the "
                         "clamps' errors would move that most; the next lengths of "
                         "blade.free_lengths_mm come to this at the ribs, before weight is compensated:")) +
      "</ul>\n<div class=\"scroll\"><table><tr><th class=\"l\">" + w("strip") + "</th>";
  for (const char* column : {"planes", "fitted with", "blade", "a shorter one", "a longer one"})
    html += "<th class=\"l\">" + w(column) + "<small></small></th>";
  html += "</tr>\n";
  const bool all_fits = decision->fits.size() == result.strips.size();
  for (std::size_t i = 0; i < result.strips.size(); ++i) {
    const Strip& strip = result.program.strips[i];
    const Eigen::Vector3d normal = strip.ribs[strip.ribs.size() / 2].frame.normal();
    const Decision* own = choice_of(result, i).taken;
    const double turned = own == nullptr ? 0 : angle_deg(normal, own->normal);
    std::string planes = vector_text(normal);
    // Of a fan every strip has its own.
    if (own != nullptr && !own->fan && turned > 0.1)
      planes += ", " + w.format("turned by {:.0f} degrees from the plan's, which do not serve here", turned);
    std::string fit = w.format("{} ribs", strip.ribs.size());
    if (all_fits && decision->fits[i].coefficients > 0) {
      fit = w.format("{} coefficients, {:.3f} mm off", decision->fits[i].coefficients,
                     decision->fits[i].fit_mm);
      if (decision->fits[i].calm > 1) fit += ", " + w.format("{:g} times calmer", decision->fits[i].calm);
    }
    std::string chosen = result.strips[i].blades ? blade_text(result.strips[i].blades->chosen, w) : "";
    if (all_fits && decision->fits[i].before) {
      const SweptFit& steadied = decision->fits[i];
      chosen +=
          "; " + w.format("the clamps' errors move it by {:.2f} mm instead of {:.2f} mm with {:.0f} mm",
                          steadied.clamps_mm, steadied.before->clamps_mm, steadied.before->blade_length_mm);
    }
    html += fmt::format("<tr id=\"why-{0}\" data-strip=\"{0}\"><td class=\"l\">{0}</td>", escaped(strip.id));
    const auto& blades = result.strips[i].blades;
    const auto other = [&](const std::optional<BladeTrial>& trial) {
      return trial ? blade_text(*trial, w) : w("the list has none");
    };
    for (const std::string& cell : {planes, fit, chosen, blades ? other(blades->shorter) : std::string(),
                                    blades ? other(blades->longer) : std::string()})
      html += "<td class=\"l\">" + cell + "</td>";
    html += "</tr>\n";
  }
  return html + "</table></div>\n";
}

}  // namespace hotblade::pipeline
