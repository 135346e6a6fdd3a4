#include "pipeline/report/sheets.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "pipeline/report/block_stand.hpp"
#include "pipeline/report/foam_sheet.hpp"
#include "pipeline/report/page_texts.hpp"
#include "pipeline/report/places_table.hpp"
#include "pipeline/report/report_plots.hpp"
#include "pipeline/report/sheet_drawings.hpp"
#include "pipeline/report/strip_table.hpp"
#include "pipeline/report/words.hpp"

namespace hotblade::pipeline {

namespace {

// Adding zero takes the sign off a zero.
std::string whole(double mm) {
  return fmt::format("{:.0f}", std::round(mm) + 0.0);
}

// The strips whose blocks touch this one's where they stand in the design.
std::vector<std::string> neighbours(const Program& program, std::size_t strip) {
  std::vector<std::string> ids;
  const Block& own = program.strips[strip].block;
  for (std::size_t k = 0; k < program.strips.size(); ++k) {
    if (k == strip) continue;
    const Block& other = program.strips[k].block;
    // Blocks have foam to spare around the design, so neighbours overlap: a point of a face lies in the
    // other.
    const auto meets = [](const Block& a, const Block& b) {
      for (int axis : {0, 2}) {
        for (const double share : {0.0, 1.0}) {
          Eigen::Vector3d q = 0.5 * a.size_mm;
          q[axis] = share * a.size_mm[axis];
          // Along the face's other ways, where blocks of unlike size or height meet.
          for (const double along : {0.15, 0.5, 0.85}) {
            for (const double deep : {0.15, 0.5, 0.85}) {
              q[2 - axis] = along * a.size_mm[2 - axis];
              q.y() = deep * a.size_mm.y();
              const Eigen::Vector3d p = a.frame.point(q.x(), q.y(), q.z());
              if (b.distance_mm(p) < 1) return true;
            }
          }
        }
      }
      return false;
    };
    if (meets(own, other) || meets(other, own)) ids.push_back(program.strips[k].id);
  }
  return ids;
}

std::string joined(const std::vector<std::string>& list, const std::string& none) {
  std::string text;
  for (const std::string& one : list) text += (text.empty() ? "" : ", ") + one;
  return text.empty() ? none : text;
}

class Sheets {
 public:
  Sheets(const PlanResult& result, const std::string& program_sha256)
      : result_(result),
        program_(result.program),
        w_(result.program.settings.job.language),
        sha256_(program_sha256.substr(0, 12)),
        assembly_(AssemblyPicture::all_of(result.program, 700, 820)) {
    for (const Strip& strip : program_.strips) stands_.push_back(stand_of(strip));
  }

  [[nodiscard]] std::string page() const {
    std::string html = fmt::format(
        "<!doctype html>\n<html lang=\"{}\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
        "content=\"width=device-width, initial-scale=1\"><title>{}</title><style>{}</style></head><body>\n",
        w_.language(), escaped(job_name() + ": " + w_("Parts list")), sheets_style());
    for (const AssemblyPicture& picture : assembly_) html += picture.definition();
    html += parts_list();
    if (result_.foam)
      html += "<section>" + head(w_("Foam to buy and to saw"), "") +
              foam_section(*result_.foam, program_, w_) + foot(text_id(w_("all")), {});
    for (std::size_t i = 0; i < assembly_.size(); ++i) html += assembly(i);
    for (std::size_t k = 0; k < program_.strips.size(); ++k) html += sheet(k);
    return html + "</body></html>\n";
  }

 private:
  [[nodiscard]] std::string job_name() const {
    const JobSettings& job = program_.settings.job;
    return job.number.empty() ? program_.design.file : job.number;
  }

  // What stands on top of every sheet, `name` the largest.
  [[nodiscard]] std::string head(const std::string& name, const std::string& number) const {
    const JobSettings& job = program_.settings.job;
    const auto line = [&](const char* word, const std::string& value) {
      return value.empty() ? std::string() : "<span>" + w_(word) + " <b>" + escaped(value) + "</b></span>";
    };
    std::string html = "<header><h1>" + escaped(name) + "</h1><div class=\"job\">" + line("Job", job.number) +
                       line("Design", program_.design.file) + line("Date", job.date) +
                       line("Author", job.author) + line("Sheet", number) + "</div></header>\n";
    if (program_.verification.status == VerificationStatus::kRefused)
      html += "<p class=\"refused\">" + w_("Not released: the plan was refused") + "</p>\n";
    return html;
  }

  [[nodiscard]] std::string foot(const std::string& text_id, const std::vector<const char*>& signs) const {
    std::string html = "<footer><div class=\"id\">" + escaped(text_id) + "</div>";
    for (const char* sign : signs)
      html += "<div class=\"sign\"><i></i>" + w_(sign) + " (" + w_("date, signature") + ")</div>";
    return html + "</footer></section>\n";
  }

  [[nodiscard]] std::string count() const {
    return fmt::format("{}", program_.strips.size() + assembly_.size() + 1);
  }

  // A block's id in words: of which job, which block, of which program.
  [[nodiscard]] std::string text_id(const std::string& block) const {
    std::string id = job_name() + " / " + block;
    if (!sha256_.empty()) id += " / " + w_("Program") + " " + sha256_;
    return id;
  }

  [[nodiscard]] std::string parts_list() const {
    double seconds = 0, cut_s = 0, foam_mm3 = 0;
    std::map<double, std::size_t> blades;
    std::string rows;
    for (std::size_t k = 0; k < program_.strips.size(); ++k) {
      const Strip& strip = program_.strips[k];
      const StripFacts& facts = result_.strips.at(k);
      const Eigen::Vector3d size = stands_[k].box.sizes();
      seconds += facts.motion.duration_s;
      cut_s += facts.motion.cut_s;
      foam_mm3 += size.prod();
      ++blades[strip.blade_length_mm];
      rows += fmt::format(
          "<tr><td>{}</td><td "
          "class=\"l\"><b>{}</b></td><td>{}</td><td>{:.0f}</td><td>{:.1f}</td><td>{}</td><td>{}</td></tr>\n",
          k + 1, escaped(strip.id), size_text(size), strip.blade_length_mm, facts.motion.duration_s / 60,
          place_text(middle_of(strip.block)), corner_text(stands_[k], w_));
    }
    std::string blade_text;
    for (const auto& [length, number] : blades)
      blade_text += fmt::format("{}{:.0f} mm ({})", blade_text.empty() ? "" : ", ", length, number);
    std::string html = "<section>" + head(w_("Parts list"), "1 " + w_("of") + " " + count());
    html += fmt::format(
        "<p class=\"sums\"><span>{} <b>{}</b></span><span>{} <b>{:.1f} l</b></span><span>{} <b>{}</b></span>"
        "<span>{} <b>{}</b></span><span>{} <b>{}</b></span></p>\n",
        w_("blocks"), program_.strips.size(), w_("Foam"), 1e-6 * foam_mm3, w_("Blades"), blade_text,
        w_("time on the machine"), duration(seconds), w_("cut"), duration(cut_s));
    html += "<table class=\"n\"><thead><tr><th>" + w_("order") + "</th><th class=\"l\">" + w_("block") +
            "</th><th>" + w_("size as it stands: width x depth x height") + "<small>mm</small></th><th>" +
            w_("blade") + "<small>mm</small></th><th>" + w_("minutes") + "</th><th>" +
            w_("its middle in the design x, y, z") + "<small>mm</small></th><th>" +
            w_("its left front lower corner on the table x, y, z") + "<small>mm</small></th></tr></thead>\n" +
            rows + "</table>\n";
    html += "<p class=\"note\">" +
            w_("Axes of a block size: width along the blade, depth towards the back of the table, height "
               "along the cut.") +
            "</p>\n";
    return html + foot(text_id(w_("all")), {"Released by", "Checked by"});
  }

  [[nodiscard]] std::string assembly(std::size_t i) const {
    const AssemblyPicture& picture = assembly_[i];
    const std::string title = w_("Assembly") + (i > 0 ? fmt::format(" {}", i + 1) : std::string());
    return "<section>" + head(title, fmt::format("{} {} {}", i + 2, w_("of"), count())) +
           "<p class=\"note\">" +
           w_(assembly_.size() > 1 ? "the blocks of this side in their places, seen from the waste side"
                                   : "all blocks in their places, seen from the waste side") +
           ", " + w_("looking along") + " " + picture.view() + "; " +
           w_("an arrow points up as the block stood on the table") + "</p><div class=\"assembly\">" +
           picture.svg({}, title) + "</div>" + foot(text_id(w_("all")), {});
  }

  // The picture on a block's sheet of where it goes.
  [[nodiscard]] std::string place(std::size_t k) const {
    const auto shown = std::find_if(assembly_.begin(), assembly_.end(),
                                    [&](const AssemblyPicture& picture) { return picture.shows(k); });
    return shown->svg(k, w_("Assembly")) + "<p class=\"note\">" + w_("looking along") + " " + shown->view() +
           "</p>";
  }

  [[nodiscard]] std::string ends(const std::array<std::optional<EdgePlace>, 2>& places) const {
    std::string text;
    for (std::size_t k = 0; k < 2; ++k) {
      text += (k == 0 ? "" : "; ") + w_(k == 0 ? "left end" : "right end") + " ";
      if (!places[k]) {
        text += w_("beside the block");
        continue;
      }
      const char* words = nullptr;
      switch (places[k]->face) {
        case Face::kLeft:
          words = "on the left edge, from the base face";
          break;
        case Face::kRight:
          words = "on the right edge, from the base face";
          break;
        case Face::kFront:
          words = "on the front edge, from the left edge";
          break;
        case Face::kBack:
          words = "on the back edge, from the left edge";
          break;
      }
      text += w_(words) + fmt::format(" <b>{:.1f} mm</b>", places[k]->mm);
    }
    return text;
  }

  [[nodiscard]] std::string sheet(std::size_t k) const {
    const Strip& strip = program_.strips[k];
    const BlockStand& stand = stands_[k];
    const Eigen::Vector3d size = stand.box.sizes(), low = stand.box.min();
    const std::string base_y = whole(stand.base_at_back ? stand.box.max().y() : low.y());
    std::string rows;
    const auto row = [&](const char* word, const std::string& value) {
      rows += "<tr><th class=\"l\">" + w_(word) + "</th><td class=\"l\">" + value + "</td></tr>\n";
    };
    row("Block size",
        fmt::format("<b>{} mm</b>: {}, {}, {}", size_text(size), w_("width, along the blade (x)"),
                    w_("depth (y)"), w_("height, along the cut (z)")));
    row("Stands", fmt::format("{} <b>{:.0f} x {:.0f} mm</b>, {:.0f} mm {}", w_("on its face of"), size.x(),
                              size.y(), low.z(), w_("above the table")));
    const std::string axes =
        stand.turned_rad == 0
            ? fmt::format("{} <b>{}</b>, {} <b>{}</b>, {} <b>{}</b> mm ({})",
                          w_("bottom edges, bold: left edge at x"), whole(low.x()), w_("base face at y"),
                          base_y, w_("underside at z"), whole(low.z()), w_("from the middle of the table"))
            : fmt::format("{} <b>{}</b> mm ({})", w_("its left front lower corner on the table x, y, z"),
                          corner_text(stand, w_), w_("from the middle of the table"));
    row("Datum", axes);
    row("Base face", "<b>" + w_(stand.base_at_back ? "at the back" : "at the front") + "</b>; " +
                         w_("write the block's name there, arrow up") + "; " +
                         w_(stand.base_cut ? "the blade comes through it at its ends" : "it stays whole"));
    row("Blade to mount",
        fmt::format("<b>{:.0f} mm</b> {}, {} {:g} x {:g} mm, {}", strip.blade_length_mm, w_("free length"),
                    w_("section"), program_.blade.width_mm, program_.blade.thickness_mm,
                    w_(stand.clamp_a_left ? "clamp A on the left" : "clamp A on the right")));
    row("Blade enters", w_("on top") + ": " + ends(stand.enters_at));
    row("Blade leaves", w_("below") + ": " + ends(stand.leaves_at));
    row("Part", w_("the foam on the base face's side is the part, the rest is waste"));
    row("Cut", fmt::format("{} <b>{}</b> {} {}, <b>{:.1f} {}</b> {}; {} {}", w_("number"), k + 1, w_("of"),
                           program_.strips.size(), result_.strips.at(k).motion.duration_s / 60, w_("minutes"),
                           w_("on the machine"), w_("strip"), escaped(strip.id)));
    std::string templates = "ribs/" + escaped(strip.id) + ".dxf";
    if (!strip.ribs.empty())
      templates += ": " + escaped(strip.ribs.front().id) +
                   (strip.ribs.size() > 1 ? " … " + escaped(strip.ribs.back().id) : std::string());
    row("Templates", templates);
    row("Neighbours", escaped(joined(neighbours(program_, k), w_("none"))));
    return fmt::format("<section id=\"sheet-{}\">", escaped(strip.id)) +
           head(strip.id, fmt::format("{} {} {}", k + assembly_.size() + 2, w_("of"), count())) +
           "<div class=\"pictures\">" + stand_svg(stand, strip.id, w_) + "<div class=\"place\">" + place(k) +
           "</div></div><table class=\"facts\">" + rows + "</table>" +
           foot(text_id(strip.id), {"Cut by", "Checked by"});
  }

  const PlanResult& result_;
  const Program& program_;
  Words w_;
  std::string sha256_;
  std::vector<AssemblyPicture> assembly_;
  std::vector<BlockStand> stands_;
};

}  // namespace

std::string sheets_html(const PlanResult& result, const std::string& program_sha256) {
  return Sheets(result, program_sha256).page();
}

}  // namespace hotblade::pipeline
