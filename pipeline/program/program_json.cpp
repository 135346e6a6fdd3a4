// The canonical text of a program. Written straight into strings: a job has tens of thousands of poses.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "pipeline/program/number_text.hpp"
#include "pipeline/program/program_text.hpp"
#include "pipeline/settings/json_text.hpp"
#include "robot/blade/blade_section.hpp"

namespace hotblade::pipeline {
namespace {

using elastica::Elastica;

// Appends JSON values; begin/end, keys and separators are the caller's, `comma` belongs before the next item.
class Text {
 public:
  // Goes on behind `before`.
  explicit Text(std::string before = "") : out_(std::move(before)) {}

  Text& raw(std::string_view text) {
    out_ += text;
    return *this;
  }

  // Shortest text that reads back as the same number; -0 becomes 0, which JSON readers do not tell apart.
  Text& number(std::floating_point auto value) {
    if (!std::isfinite(value)) throw std::logic_error("to_json: a program's numbers have to be finite");
    char buffer[kNumberText];
    const char* const end = write_number(buffer, value + decltype(value){});
    return raw({buffer, static_cast<std::size_t>(end - buffer)});
  }
  Text& number(std::size_t value) { return raw(std::to_string(value)); }

  Text& string(std::string_view value) {
    const auto plain = [](char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; };
    if (std::all_of(value.begin(), value.end(), plain)) return raw("\"").raw(value).raw("\"");
    return raw(json_text(nlohmann::json(value)));
  }

  template <typename Items, typename Write>
  Text& list(const Items& items, Write&& write) {
    raw("[");
    bool first = true;
    for (const auto& item : items) {
      if (!std::exchange(first, false)) raw(",");
      write(item);
    }
    return raw("]");
  }

  // An array of objects, one a line.
  template <typename Items, typename Write>
  Text& lines(Items&& items, Write&& write) {
    raw("[\n");
    const std::size_t start = out_.size();
    for (std::size_t i = 0; i < items.size(); ++i) {
      if (i > 0) raw(",\n");
      write(*this, items[i]);
      if (i == kForecast) out_.reserve(start + (out_.size() - start) / kForecast * items.size() * 9 / 8);
    }
    return raw("]");
  }

  template <typename Vector>
  Text& vector(const Vector& v) {
    return list(std::span<const double>(v.data(), static_cast<std::size_t>(v.size())),
                [this](double c) { number(c); });
  }

  Text& field(std::string_view key_and_colon, std::floating_point auto value) {
    return raw(key_and_colon).number(value);
  }
  Text& string_field(std::string_view key_and_colon, std::string_view value) {
    return raw(key_and_colon).string(value);
  }

  Text& frame(const Frame& f) {
    raw("{\"origin\":").vector(f.origin);
    // Few planes of a job turn, so that nearly all axes are those before.
    if (axes_end_ > axes_ && f.x == x_ && f.y == y_) {
      out_.append(out_, axes_, axes_end_ - axes_);
      return *this;
    }
    x_ = f.x;
    y_ = f.y;
    axes_ = out_.size();
    raw(",\"x\":").vector(x_).raw(",\"y\":").vector(y_).raw("}");
    axes_end_ = out_.size();
    return *this;
  }

  Text& pose(const Pose& p) {
    const std::array<double, 4> q{p.q.w(), p.q.x(), p.q.y(), p.q.z()};
    return raw("{\"p\":").vector(p.p).raw(",\"q\":").vector(q).raw("}");
  }

  Text& elastica(const Elastica& e) {
    field("{\"x\":", e.x).field(",\"y\":", e.y).field(",\"theta\":", e.theta).field(",\"kappa\":", e.kappa);
    field(",\"lambda1\":", e.lambda1).field(",\"lambda2\":", e.lambda2).field(",\"length\":", e.length);
    return raw("}");
  }

  template <typename Value>
  Text& optional(const CompactOptional<Value>& value) {
    return value ? number(static_cast<double>(*value)) : raw("null");
  }

  Text& strings(const std::vector<std::string>& values) {
    return list(values, [this](const std::string& value) { string(value); });
  }

  [[nodiscard]] std::string take() { return std::move(out_); }

 private:
  // So many lines tell how much room all of them take, with an eighth to spare.
  static constexpr std::size_t kForecast = 64;

  std::string out_;
  Eigen::Vector3d x_, y_;                // the axes written last,
  std::size_t axes_ = 0, axes_end_ = 0;  // and where
};

void write_design(Text& out, const DesignData& design) {
  out.string_field("\"design\": {\"file\":", design.file).string_field(",\"sha256\":", design.sha256);
  if (design.format) out.string_field(",\"format\":", surface::name(*design.format));
  out.string_field(",\"source_units\":", design.source_units).field(",\"scale_to_mm\":", design.scale_to_mm);
  out.string_field(",\"up\":", std::string_view(&design.up, 1)).string_field(",\"keep\":", name(design.keep));
  out.raw(",\"vertices\":").number(design.vertices).raw(",\"faces\":").number(design.faces);
  out.raw(",\"bbox_mm\":").list(design.bbox_mm, [&](const Eigen::Vector3d& corner) { out.vector(corner); });
  out.raw("},\n");
}

void write_settings(Text& out, const Settings& settings) {
  out.raw("\"settings\": ").raw(json_text(to_json(settings))).raw(",\n");
}

void write_blade(Text& out, const robot::BladeSet& blade) {
  out.raw("\"blade\": {\"free_lengths_mm\":").vector(blade.free_lengths_mm);
  out.field(",\"width_mm\":", blade.width_mm).field(",\"thickness_mm\":", blade.thickness_mm);
  out.field(",\"youngs_modulus_mpa\":", blade.youngs_modulus_mpa);
  out.field(",\"yield_strength_mpa\":", blade.yield_strength_mpa).field(",\"safety\":", blade.safety);
  out.field(",\"max_curvature_per_mm\":", robot::max_curvature_per_mm(blade))
      .field(",\"kerf_mm\":", blade.kerf_mm);
  out.field(",\"density_kg_m3\":", blade.density_kg_m3);
  if (!blade.melt.band_mm_at_mm_s.empty()) {
    out.raw(",\"band_mm_at_mm_s\":").list(blade.melt.band_mm_at_mm_s, [&](const std::array<double, 2>& pair) {
      out.vector(pair);
    });
  } else if (blade.melt.by_speed()) {
    out.field(",\"melt_mm2_s\":", blade.melt.melt_mm2_s).field(",\"loss_mm_s\":", blade.melt.loss_mm_s);
  }
  out.raw("},\n");
}

void write_cell(Text& out, const ProgramCell& cell) {
  out.string_field("\"cell\": {\"name\":", cell.name).string_field(",\"sha256\":", cell.sha256);
  out.raw(",\"arms\":").lines(cell.arms, [](Text& text, const ProgramArm& arm) {
    text.string_field("{\"id\":", arm.id).string_field(",\"model\":", arm.model);
    text.string_field(",\"files_sha256\":", arm.files_sha256).raw(",\"base\":").pose(arm.base);
    text.raw(",\"jaw\":").pose(arm.jaw).raw(",\"joints\":").list(arm.joints, [&](const ProgramJoint& joint) {
      text.string_field("{\"name\":", joint.name).field(",\"min\":", joint.min_rad);
      text.field(",\"max\":", joint.max_rad).field(",\"speed\":", joint.speed_rad_s);
      text.field(",\"acceleration\":", joint.acceleration_rad_s2)
          .field(",\"jerk\":", joint.jerk_rad_s3)
          .raw("}");
    });
    text.raw("}");
  });
  out.raw("},\n");
}

void write_held(Text& out, const HeldClamp& held) {
  const auto number = [&](int n) { out.raw(std::to_string(n)); };
  out.string_field("{\"arm\":", held.arm).raw(",\"branch\":").list(held.branch, number);
  out.raw(held.flip ? ",\"flip\":true" : ",\"flip\":false")
      .raw(",\"turns\":")
      .list(held.turns, number)
      .raw("}");
}

void write_arms(Text& out, const StripArms& arms) {
  write_held(out.raw("\"arms\":{\"a\":"), arms.a);
  write_held(out.raw(",\"b\":"), arms.b);
  const auto nearest = [&](const char* key, const StripArms::Nearest& n, bool joint) {
    out.field(key, n.value).string_field(",", n.arm);
    if (joint) out.raw(",").raw(std::to_string(n.joint));
    out.field(",", n.t).raw("]");
  };
  out.raw(",\"nearest_mm\":{");
  for (const StripArms::NearestPair& pair : arms.nearest_mm) {
    if (&pair != arms.nearest_mm.data()) out.raw(",");
    out.raw("\"" + pair.kind + "\":[").field("", pair.mm).field(",", pair.t).raw("]");
  }
  out.raw("}");
  nearest(",\"joint_margin_rad\":[", arms.joint_margin_rad, true);
  nearest(",\"wrist_rad\":[", arms.wrist_rad, false);
  if (arms.reach) nearest(",\"reach\":[", *arms.reach, false);
  out.field(",\"place\":{\"raise_mm\":", arms.raise_mm);
  if (arms.dx_mm != 0 || arms.dy_mm != 0 || arms.yaw_rad != 0) {
    out.field(",\"dx_mm\":", arms.dx_mm)
        .field(",\"dy_mm\":", arms.dy_mm)
        .field(",\"yaw_rad\":", arms.yaw_rad);
  }
  out.field("},\"added_s\":{\"jerk\":", arms.jerk_s).field(",\"joints\":", arms.joints_s).raw("}");
  if (!arms.clamp_times_s.empty())
    out.raw(",\"clamp_times_s\":").list(arms.clamp_times_s, [&](double t) { out.field("", t); });
  out.raw("},\n");
}

void write_rib(Text& out, const Rib& rib) {
  const auto point = [&](const Eigen::Vector2d& p) { out.vector(p); };
  out.string_field("{\"id\":", rib.id).raw(",\"frame\":").frame(rib.frame);
  out.raw(",\"target\":").list(rib.target, point).raw(",\"bezier\":").list(rib.bezier, point);
  out.field(",\"lambda_residual\":", rib.lambda_residual).raw(",\"elastica\":").elastica(rib.elastica);
  out.field(",\"l2\":", rib.l2).field(",\"h1\":", rib.h1).field(",\"hausdorff_mm\":", rib.hausdorff_mm);
  out.field(",\"design_deviation_mm\":", rib.design_deviation_mm).raw("}");
}

void write_loads(Text& out, const PoseLoads& l) {
  out.field("{\"force_n\":", l.force_n).field(",\"moment_a_n_mm\":", l.moment_a_n_mm);
  out.field(",\"moment_b_n_mm\":", l.moment_b_n_mm).field(",\"stress_mpa\":", l.stress_mpa);
  out.field(",\"droop_mm\":", l.droop_mm).field(",\"in_plane_sag_mm\":", l.in_plane_sag_mm).raw("}");
}

void write_pose(Text& out, const BladePose& pose, const ClampJoints* joints) {
  out.field("{\"t\":", pose.t).string_field(",\"phase\":", name(pose.phase));
  out.raw(pose.heat ? ",\"heat\":true" : ",\"heat\":false").raw(",\"frame\":").frame(pose.frame);
  out.raw(",\"blade\":").elastica(pose.blade).raw(",\"foam\":");
  if (pose.foam) {
    out.vector(*pose.foam);
  } else {
    out.raw("null");
  }
  out.raw(",\"a\":").pose(pose.a).raw(",\"b\":").pose(pose.b).field(",\"margin\":", pose.margin);
  out.raw(",\"margin_mm\":").optional(pose.margin_mm);
  if (pose.loads) write_loads(out.raw(",\"loads\":"), *pose.loads);
  out.raw(",\"rib\":").optional(pose.rib);
  if (joints != nullptr) {
    const auto number = [&](double angle) { out.number(angle); };
    out.raw(",\"joints\":{\"a\":").list(joints->a, number);
    out.raw(",\"b\":").list(joints->b, number).raw("}");
  }
  out.raw("}");
}

void write_strip(Text& out, const Strip& strip) {
  out.string_field("{\"id\":", strip.id).field(",\"blade_length_mm\":", strip.blade_length_mm);
  out.raw(",\"design_to_cell\":").pose(strip.design_to_cell).raw(",\"stock\":{\"frame\":");
  out.frame(strip.block.frame).raw(",\"size_mm\":").vector(strip.block.size_mm).raw("},\n");
  if (strip.arms) write_arms(out, *strip.arms);
  out.raw("\"ribs\":").lines(strip.ribs, write_rib).raw(",\n");
  const ClampJoints* joints = strip.joints.empty() ? nullptr : strip.joints.data();
  const auto pose_with_joints = [&](Text& text, const BladePose& pose) {
    write_pose(text, pose, joints);
    if (joints != nullptr) ++joints;
  };
  out.raw("\"poses\":").lines(strip.poses, pose_with_joints).raw("}");
}

void write_verification(Text& out, const Verification& verification) {
  const Deviation& deviation = verification.deviation_mm;
  out.string_field("\"verification\": {\"status\":", name(verification.status));
  out.field(",\"tolerance_mm\":", verification.tolerance_mm)
      .field(",\"deviation_mm\":{\"max\":", deviation.max);
  out.field(",\"p99\":", deviation.p99).field(",\"rms\":", deviation.rms).field(",\"mean\":", deviation.mean);
  out.raw(",\"at\":").vector(deviation.at).field("},\"uncut_mm2\":", verification.uncut_mm2);
  out.raw(",\"budget_mm\":{");
  for (std::size_t i = 0; i < verification.budget_mm.size(); ++i) {
    const auto& [name, value] = verification.budget_mm[i];
    out.raw(i ? "," : "").string(name).field(":", value);
  }
  out.raw("},\"samples\":").number(verification.samples);
  out.raw(",\"not_checked\":").strings(verification.not_checked).raw("},\n");
}

}  // namespace

ProgramFrame program_frame(const Program& program) {
  Text before, after;
  const std::size_t version = program.design.format ? 2 : 1;
  before.raw("{\"format\": \"hotblade-program\",\n\"version\": ").number(version).raw(",\n");
  before.string_field("\"created_by\": ", program.created_by).raw(",\n");
  write_design(before, program.design);
  write_settings(before, program.settings);
  write_blade(before, program.blade);
  if (program.cell) write_cell(before, *program.cell);
  before.raw("\"strips\": [\n");
  after.raw("],\n");
  write_verification(after, program.verification);
  after.raw("\"overrides\": ").strings(program.overrides).raw("}\n");
  return {before.take(), after.take()};
}

std::string to_json(const Strip& strip, std::string before) {
  Text text(std::move(before));
  write_strip(text, strip);
  return text.take();
}

std::string to_json(const Program& program) {
  const ProgramFrame frame = program_frame(program);
  std::vector<std::string> strips(program.strips.size());
  tbb::parallel_for(std::size_t{0}, strips.size(),
                    [&](std::size_t i) { strips[i] = to_json(program.strips[i]); });
  std::string text = frame.before;
  for (std::size_t i = 0; i < strips.size(); ++i) text.append(i > 0 ? ",\n" : "").append(strips[i]);
  return text + frame.after;
}

}  // namespace hotblade::pipeline
