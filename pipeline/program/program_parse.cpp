// Reading a program back: every number is checked before anything uses it.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "pipeline/program/json_node.hpp"
#include "pipeline/program/parse_arms.hpp"
#include "pipeline/program/program.hpp"
#include "pipeline/program/program_limits.hpp"
#include "pipeline/program/program_scan.hpp"
#include "pipeline/program/program_settings.hpp"
#include "pipeline/program/program_text.hpp"
#include "pipeline/settings/error.hpp"
#include "robot/blade/blade_section.hpp"

namespace hotblade::pipeline {
namespace {

using elastica::Elastica;

constexpr std::array kFormats{"obj", "stl", "ply", "gltf"};
constexpr std::array kUnits{"mm", "cm", "m", "in", "ft"};
constexpr std::array kUps{"z", "y"};
constexpr std::array kKeeps{Keep::kBelow, Keep::kAbove, Keep::kBack, Keep::kFront};
constexpr std::array kStatuses{VerificationStatus::kPassed, VerificationStatus::kRefused};

double number(const JsonNode& node, const char* key, Range range = kAny) {
  return node.field(key).number(range);
}
std::string text(const JsonNode& node, const char* key) {
  return node.field(key).text();
}

// The value whose name stands there.
template <typename Enum, std::size_t N>
Enum named(const JsonNode& node, const std::array<Enum, N>& values) {
  std::array<std::string, N> names;
  std::array<const char*, N> words;
  for (std::size_t i = 0; i < N; ++i) words[i] = (names[i] = name(values[i])).c_str();
  const std::string& word = node.one_of(words);
  return values[static_cast<std::size_t>(std::find(names.begin(), names.end(), word) - names.begin())];
}

template <int N>
Eigen::Matrix<double, N, 1> vector(const JsonNode& node, Range range = kAny) {
  [[maybe_unused]] const std::size_t size = node.items(N, true);
  Eigen::Matrix<double, N, 1> v;
  for (int i = 0; i < N; ++i) v[i] = node.item(static_cast<std::size_t>(i)).number(range);
  return v;
}

template <int N>
Eigen::Matrix<double, N, 1> vector(const JsonNode& node, const char* key, Range range = kAny) {
  return vector<N>(node.field(key), range);
}

void expect_unit(const JsonNode& node, double norm) {
  if (!is_unit(norm)) node.fail(fmt::format("is not of length 1 ({}, +-{})", norm, kUnitError));
}

Eigen::Vector3d unit_vector(const JsonNode& node, const char* key) {
  const JsonNode field = node.field(key);
  const Eigen::Vector3d v = vector<3>(field);
  expect_unit(field, v.norm());
  return v;
}

Frame frame(const JsonNode& node) {
  node.expect_keys(std::array{"origin", "x", "y"});
  const Frame frame{vector<3>(node, "origin"), unit_vector(node, "x"), unit_vector(node, "y")};
  const double dot = frame.x.dot(frame.y);
  if (!is_square(dot)) node.fail(fmt::format("x and y are not square ({}, +-{})", dot, kUnitError));
  return frame;
}

Pose pose(const JsonNode& node) {
  node.expect_keys(std::array{"p", "q"});
  const JsonNode q = node.field("q");
  const Eigen::Vector4d wxyz = vector<4>(q);
  expect_unit(q, wxyz.norm());
  return {vector<3>(node, "p"), Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3])};
}

Elastica elastica_of(const JsonNode& node) {
  node.expect_keys(std::array{"x", "y", "theta", "kappa", "lambda1", "lambda2", "length"});
  return {number(node, "x"),
          number(node, "y"),
          number(node, "theta"),
          number(node, "kappa"),
          number(node, "lambda1"),
          number(node, "lambda2"),
          number(node, "length", kPositive)};
}

std::vector<std::string> strings(const JsonNode& node) {
  std::vector<std::string> values(node.items(0));
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = node.item(i).text();
  return values;
}

std::string sha256_of(const JsonNode& node) {
  const std::string& digits = node.text();
  const bool hex = digits.find_first_not_of("0123456789abcdef") == std::string::npos;
  if (digits.size() != 64 || !hex) node.fail("is not a SHA-256 (64 lower-case hex digits)");
  return digits;
}

DesignData design_of(const JsonNode& node, std::size_t version) {
  std::vector<const char*> keys{"file", "sha256",   "source_units", "scale_to_mm", "up",
                                "keep", "vertices", "faces",        "bbox_mm"};
  if (version > 1) keys.push_back("format");
  node.expect_keys(keys);
  DesignData design;
  const JsonNode file = node.field("file");
  design.file = file.text();
  if (design.file.empty() || design.file.find('/') != std::string::npos) {
    file.fail(fmt::format("is not a base name (\"{}\"): the path is in run.json", design.file));
  }
  design.sha256 = sha256_of(node.field("sha256"));
  if (version > 1) design.format = surface::format_named(node.field("format").one_of(kFormats));
  design.source_units = node.field("source_units").one_of(kUnits);
  design.scale_to_mm = number(node, "scale_to_mm", kPositive);
  design.up = node.field("up").one_of(kUps)[0];
  design.keep = named(node.field("keep"), kKeeps);
  design.vertices = node.field("vertices").count();
  design.faces = node.field("faces").count();
  const JsonNode box = node.field("bbox_mm");
  [[maybe_unused]] const std::size_t corners = box.items(2, true);
  design.bbox_mm = {vector<3>(box.item(0)), vector<3>(box.item(1))};
  if ((design.bbox_mm[0].array() > design.bbox_mm[1].array()).any()) {
    box.fail("the first corner is above the second");
  }
  return design;
}

// The band by speed, where a program has one.
robot::Melt melt_of(const JsonNode& node) {
  robot::Melt melt;
  if (node.json().contains("band_mm_at_mm_s")) {
    const JsonNode pairs = node.field("band_mm_at_mm_s");
    melt.band_mm_at_mm_s.resize(pairs.items(1));
    for (std::size_t i = 0; i < melt.band_mm_at_mm_s.size(); ++i) {
      const JsonNode pair = pairs.item(i);
      [[maybe_unused]] const std::size_t numbers = pair.items(2, true);
      melt.band_mm_at_mm_s[i] = {pair.item(0).number(kPositive), pair.item(1).number(kPositive)};
      if (i == 0) continue;
      const auto& [speed, band] = melt.band_mm_at_mm_s[i];
      const auto& [slower, wider] = melt.band_mm_at_mm_s[i - 1];
      if (!(speed > slower) || band > wider) pair.fail("speeds rise from pair to pair, and bands do not");
    }
  } else if (node.json().contains("melt_mm2_s")) {
    melt.melt_mm2_s = number(node, "melt_mm2_s", kPositive);
    melt.loss_mm_s = number(node, "loss_mm_s", kPositive);
  }
  return melt;
}

robot::BladeSet blade_of(const JsonNode& node) {
  std::vector<const char*> keys{
      "free_lengths_mm",    "width_mm", "thickness_mm",         "youngs_modulus_mpa",
      "yield_strength_mpa", "safety",   "max_curvature_per_mm", "kerf_mm",
      "density_kg_m3"};
  if (node.json().contains("band_mm_at_mm_s")) {
    keys.push_back("band_mm_at_mm_s");
  } else if (node.json().contains("melt_mm2_s")) {
    keys.insert(keys.end(), {"melt_mm2_s", "loss_mm_s"});
  }
  node.expect_keys(keys);
  robot::BladeSet blade;
  const JsonNode lengths = node.field("free_lengths_mm");
  blade.free_lengths_mm = lengths.numbers(1, kPositive);
  for (std::size_t i = 1; i < blade.free_lengths_mm.size(); ++i) {
    if (blade.free_lengths_mm[i] <= blade.free_lengths_mm[i - 1]) {
      lengths.item(i).fail(fmt::format("is not above the one before ({}, above {})", blade.free_lengths_mm[i],
                                       blade.free_lengths_mm[i - 1]));
    }
  }
  blade.width_mm = number(node, "width_mm", kPositive);
  blade.thickness_mm = number(node, "thickness_mm", kPositive);
  blade.youngs_modulus_mpa = number(node, "youngs_modulus_mpa", kPositive);
  blade.yield_strength_mpa = number(node, "yield_strength_mpa", kPositive);
  blade.safety = number(node, "safety", kPositive);
  blade.kerf_mm = number(node, "kerf_mm", kPositive);
  blade.density_kg_m3 = number(node, "density_kg_m3", kPositive);
  blade.melt = melt_of(node);
  const JsonNode written = node.field("max_curvature_per_mm");
  const double curvature = written.number(kPositive), follows = robot::max_curvature_per_mm(blade);
  if (std::abs(curvature - follows) > kUnitError * follows) {
    written.fail(fmt::format("does not follow from the yield strength ({}, {}): plan the program again",
                             curvature, follows));
  }
  return blade;
}

Rib rib_of(const JsonNode& node) {
  node.expect_keys(std::array{"id", "frame", "target", "bezier", "lambda_residual", "elastica", "l2", "h1",
                              "hausdorff_mm", "design_deviation_mm"});
  Rib rib;
  rib.id = text(node, "id");
  rib.frame = frame(node.field("frame"));
  const JsonNode target = node.field("target");
  rib.target.resize(target.items(2));
  for (std::size_t i = 0; i < rib.target.size(); ++i) rib.target[i] = vector<2>(target.item(i));
  const JsonNode bezier = node.field("bezier");
  rib.bezier.resize(bezier.items(4));
  if (rib.bezier.size() % 3 != 1 || rib.bezier.size() > 3 * kMostCubics + 1)
    bezier.fail(fmt::format("wrong number of items ({}, 3 n + 1 for n = 1 to {} cubics)", rib.bezier.size(),
                            kMostCubics));
  for (std::size_t i = 0; i < rib.bezier.size(); ++i) rib.bezier[i] = vector<2>(bezier.item(i));
  rib.lambda_residual = number(node, "lambda_residual", kNotNegative);
  rib.elastica = elastica_of(node.field("elastica"));
  rib.l2 = number(node, "l2", kNotNegative);
  rib.h1 = number(node, "h1", kNotNegative);
  rib.hausdorff_mm = number(node, "hausdorff_mm", kNotNegative);
  rib.design_deviation_mm = number(node, "design_deviation_mm", kNotNegative);
  return rib;
}

std::optional<std::array<double, 2>> foam_of(const JsonNode& node, double length) {
  if (node.is_null()) return std::nullopt;
  const Eigen::Vector2d foam = vector<2>(node, foam_range(length));
  if (foam[0] >= foam[1]) node.fail(fmt::format("ends before it starts ({} to {})", foam[0], foam[1]));
  return std::array{foam[0], foam[1]};
}

// What the poses of a strip are held against.
struct BladesAtHand {
  robot::BladeSet set;
  double clamp_reach_mm = 0;  // that the clamps are told to be farther apart than they hold the blade
};

void expect_chord(const JsonNode& node, const BladePose& pose, double length, double clamp_reach_mm) {
  const double chord = (pose.a.p - pose.b.p).norm();
  if (!within_reach(chord, length + clamp_reach_mm)) {
    node.fail(
        fmt::format("clamps a and b are farther apart than the blade is long ({} mm, {})", chord, length));
  }
}

PoseLoads loads_of(const JsonNode& node) {
  node.expect_keys(
      std::array{"force_n", "moment_a_n_mm", "moment_b_n_mm", "stress_mpa", "droop_mm", "in_plane_sag_mm"});
  const auto load = [&](const char* key, Range range) {
    return static_cast<float>(number(node, key, range));
  };
  PoseLoads loads;
  loads.force_n = load("force_n", kLoadSize);
  loads.moment_a_n_mm = load("moment_a_n_mm", kLoad);
  loads.moment_b_n_mm = load("moment_b_n_mm", kLoad);
  loads.stress_mpa = load("stress_mpa", kLoadSize);
  loads.droop_mm = load("droop_mm", kLoadSize);
  loads.in_plane_sag_mm = load("in_plane_sag_mm", kLoadSize);
  return loads;
}

// Loads and joints may be left out: loads follow from the shape and the blade, and joints need a cell.
void expect_pose_keys(const JsonNode& node, bool loads, bool joints) {
  std::vector<const char*> keys{"t", "phase", "heat",   "frame",     "blade", "foam",
                                "a", "b",     "margin", "margin_mm", "rib"};
  if (loads) keys.push_back("loads");
  if (joints) keys.push_back("joints");
  node.expect_keys(keys);
}

bool has_field(const JsonNode& node, const char* key) {
  return node.json().is_object() && node.json().contains(key);
}

BladePose blade_pose_of(const JsonNode& node, const Strip& strip, double clamp_reach_mm, bool has_joints) {
  const bool has_loads = has_field(node, "loads");
  expect_pose_keys(node, has_loads, has_joints);
  BladePose out;
  out.t = number(node, "t", kTime);
  out.phase = named(node.field("phase"), kStripPhases);
  out.heat = node.field("heat").boolean();
  out.frame = frame(node.field("frame"));
  const JsonNode blade = node.field("blade");
  out.blade = elastica_of(blade);
  const double length = strip.blade_length_mm;
  if (!is_blade_length(out.blade.length, length)) {
    blade.fail(fmt::format("length is not the strip's blade length ({}, {})", out.blade.length, length));
  }
  out.foam = foam_of(node.field("foam"), length);
  out.a = pose(node.field("a"));
  out.b = pose(node.field("b"));
  expect_chord(node, out, length, clamp_reach_mm);
  out.margin = number(node, "margin");
  const JsonNode margin_mm = node.field("margin_mm");
  if (!margin_mm.is_null()) out.margin_mm = margin_mm.number(kNotNegative);
  if (has_loads) {
    const JsonNode loads = node.field("loads");
    out.loads = loads_of(loads);
  }
  const JsonNode rib = node.field("rib");
  if (rib.is_null()) return out;
  if (rib.count() >= strip.ribs.size()) {
    rib.fail(fmt::format("no such rib ({}, the strip has {})", rib.count(), strip.ribs.size()));
  }
  out.rib = static_cast<int>(rib.count());
  return out;
}

Block block_of(const JsonNode& node) {
  node.expect_keys(std::array{"frame", "size_mm"});
  return {frame(node.field("frame")), vector<3>(node, "size_mm", kPositive)};
}

double blade_length_of(const JsonNode& node, const robot::BladeSet& blade) {
  const double length = node.number(kPositive);
  for (const double free_length : blade.free_lengths_mm) {
    if (length == free_length) return length;
  }
  node.fail(fmt::format("no such blade ({}, one of {})", length, fmt::join(blade.free_lengths_mm, ", ")));
}

// A strip starts and ends formed in air, so it has at least two poses.
ScannedPoses poses_of(const JsonNode& node, const Strip& strip, double clamp_reach_mm) {
  ScannedPoses out;
  std::vector<BladePose>& poses = out.poses;
  const std::size_t size = node.items(2);
  poses.reserve(size);
  // With arms each pose has them; whether there is a cell to them is asked of the whole program.
  const bool has_joints = strip.arms || has_field(node.item(0), "joints");
  for (std::size_t i = 0; i < size; ++i) {
    const JsonNode item = node.item(i);
    poses.push_back(blade_pose_of(item, strip, clamp_reach_mm, has_joints));
    if (i > 0) poses[i].frame = {poses[i].frame, poses[i - 1].frame};
    if (has_joints) {
      const JsonNode joints = item.field("joints");
      out.joints.push_back(joints_of(joints));
    }
    if (i > 0 && microseconds(poses[i].t) <= microseconds(poses[i - 1].t)) {
      item.field("t").fail(fmt::format("is not a microsecond after the pose before ({} s, above {})",
                                       poses[i].t, poses[i - 1].t));
    }
  }
  return out;
}

// All of a strip but its poses.
Strip strip_head_of(const JsonNode& node, const robot::BladeSet& blade, std::set<std::string>& ids) {
  std::vector<const char*> keys{"id", "blade_length_mm", "design_to_cell", "stock", "ribs", "poses"};
  const bool has_arms = node.json().is_object() && node.json().contains("arms");
  if (has_arms) keys.push_back("arms");
  node.expect_keys(keys);
  const auto expect_new = [&](const JsonNode& owner, const std::string& id) {
    const JsonNode field = owner.field("id");
    if (id.empty()) field.fail("is empty");
    if (!ids.insert(id).second) field.fail(fmt::format("stands twice ({})", id));
  };
  Strip strip;
  strip.id = text(node, "id");
  expect_new(node, strip.id);
  strip.blade_length_mm = blade_length_of(node.field("blade_length_mm"), blade);
  strip.design_to_cell = pose(node.field("design_to_cell"));
  strip.block = block_of(node.field("stock"));
  if (has_arms) {
    const JsonNode arms = node.field("arms");
    strip.arms = strip_arms_of(arms);
  }
  const JsonNode ribs = node.field("ribs");
  const std::size_t rib_count = ribs.items(1);
  for (std::size_t i = 0; i < rib_count; ++i) {
    const JsonNode rib = ribs.item(i);
    strip.ribs.push_back(rib_of(rib));
    expect_new(rib, strip.ribs.back().id);
  }
  return strip;
}

Strip strip_of(const JsonNode& node, const BladesAtHand& blades, std::set<std::string>& ids) {
  Strip strip = strip_head_of(node, blades.set, ids);
  ScannedPoses read = poses_of(node.field("poses"), strip, blades.clamp_reach_mm);
  strip.poses = std::move(read.poses);
  strip.joints = std::move(read.joints);
  return strip;
}

double clamp_reach_mm(const JsonNode& settings) {
  return robot::reach_of(settings_of(settings).machine.clamps);
}

Verification verification_of(const JsonNode& node) {
  node.expect_keys(std::array{"status", "tolerance_mm", "deviation_mm", "uncut_mm2", "budget_mm", "samples",
                              "not_checked"});
  Verification out;
  out.status = named(node.field("status"), kStatuses);
  out.tolerance_mm = number(node, "tolerance_mm", kPositive);
  const JsonNode deviation = node.field("deviation_mm");
  deviation.expect_keys(std::array{"max", "p99", "rms", "mean", "at"});
  out.deviation_mm.max = number(deviation, "max", kNotNegative);
  const double most = out.deviation_mm.max * (1 + kLengthErrorRel);
  out.deviation_mm.p99 = number(deviation, "p99", {0, most});
  out.deviation_mm.rms = number(deviation, "rms", {0, most});
  out.deviation_mm.mean = number(deviation, "mean", {-most, most});
  out.deviation_mm.at = vector<3>(deviation, "at");
  out.uncut_mm2 = number(node, "uncut_mm2", kNotNegative);
  const JsonNode budget = node.field("budget_mm");
  if (!budget.json().is_object()) budget.fail("is not an object of name: mm");
  for (const auto& [name, value] : budget.json().items()) {
    out.budget_mm.emplace_back(name, number(budget, name.c_str(), kNotNegative));
  }
  out.samples = node.field("samples").count();
  out.not_checked = strings(node.field("not_checked"));
  return out;
}

// Returns the version.
std::size_t expect_format(const JsonNode& root, const std::string& file_name) {
  const JsonNode format = root.field("format");
  if (format.text() == kRefusedPlanFormat) {
    const JsonNode reasons = root.field("reasons"), first = reasons.item(0);
    throw Error(ErrorKind::kNotCuttable,
                fmt::format("{}: is what a refused plan found, not a program ({}): nothing runs from it; "
                            "`hotblade preview` shows it",
                            file_name, first.field("message").text()));
  }
  if (format.text() != "hotblade-program") {
    format.fail(fmt::format("is not a cut program (\"{}\", hotblade-program)", format.text()));
  }
  const JsonNode version = root.field("version");
  if (version.count() != 1 && version.count() != 2) {
    version.fail(
        fmt::format("unknown version ({}, 1 or 2): use the hotblade that wrote it", version.count()));
  }
  return version.count();
}

// Turns each strip into what it stands for as soon as its text is read, so that no tree of the whole job is
// made: of hundreds of strips that takes many times the text's memory. Settings and blade have to stand
// before the strips, as to_json() writes them.
class StripTaker {
 public:
  explicit StripTaker(const std::string& file_name) : file_name_(file_name) {}

  void see(const std::string& key, const JsonNode::Json& value) {
    if (key == "settings") reach_mm_ = clamp_reach_mm(JsonNode(value, file_name_));
    if (key == "blade") blade_ = blade_of(JsonNode(value, file_name_));
  }

  bool take(const JsonNode::Json& value) {
    const JsonNode strip(value, file_name_);
    if (!blade_) strip.fail("stands before the blade");
    strips_.push_back(strip_of(strip, {*blade_, reach_mm_}, ids_));
    return true;
  }

  [[nodiscard]] std::vector<Strip> strips() { return std::move(strips_); }

 private:
  const std::string& file_name_;
  std::optional<robot::BladeSet> blade_;
  double reach_mm_ = 0;
  std::vector<Strip> strips_;
  std::set<std::string> ids_;
};

// All but the strips, with what was taken out of the tree.
Program program_of(const JsonNode& root, std::vector<Strip> strips, const std::string& file_name,
                   std::size_t least_strips) {
  const std::size_t version = expect_format(root, file_name);
  std::vector<const char*> keys{"format", "version", "created_by",   "design",   "settings",
                                "blade",  "strips",  "verification", "overrides"};
  const bool has_cell = root.json().is_object() && root.json().contains("cell");
  if (has_cell) keys.push_back("cell");
  root.expect_keys(keys);
  Program program;
  program.created_by = text(root, "created_by");
  program.design = design_of(root.field("design"), version);
  program.settings = settings_of(root.field("settings"));
  program.blade = blade_of(root.field("blade"));
  // The blade's own section has no use for it.
  program.blade.poisson_ratio = program.settings.blade.poisson_ratio;
  program.blade.stiffness_error = program.settings.blade.stiffness_error;
  program.strips = std::move(strips);
  const JsonNode left = root.field("strips");
  const std::size_t left_count = left.items(program.strips.empty() ? least_strips : 0);
  std::set<std::string> ids;
  for (std::size_t i = 0; i < left_count; ++i) {
    program.strips.push_back(
        strip_of(left.item(i), {program.blade, robot::reach_of(program.settings.machine.clamps)}, ids));
  }
  program.verification = verification_of(root.field("verification"));
  program.overrides = strings(root.field("overrides"));
  if (has_cell) {
    const JsonNode cell = root.field("cell");
    program.cell = cell_of(cell);
  }
  expect_joints(program, file_name);
  return program;
}

// Up to behind the first `end` of what is left; nothing where there is none.
std::optional<std::string_view> take_to(std::string_view& left, std::string_view end) {
  const std::size_t at = left.find(end);
  if (at == std::string_view::npos) return std::nullopt;
  const std::string_view taken = left.substr(0, at + end.size());
  left.remove_prefix(taken.size());
  return taken;
}

bool take(std::string_view& left, std::string_view word) {
  if (!left.starts_with(word)) return false;
  left.remove_prefix(word.size());
  return true;
}

// One strip as to_json() writes it: its poses, nearly all of the text, without a tree.
std::optional<Strip> scanned_strip(std::string_view& left, const BladesAtHand& blades,
                                   std::set<std::string>& ids, const std::string& file_name) {
  const auto head = take_to(left, "],\n\"poses\":[");
  if (!head) return std::nullopt;
  const nlohmann::ordered_json json = parse_json(std::string(*head) + "]}", file_name);
  Strip strip = strip_head_of(JsonNode(json, file_name), blades.set, ids);
  auto scanned = scan_poses(left, strip.blade_length_mm, blades.clamp_reach_mm, strip.ribs.size());
  if (!scanned || !take(left, "}")) return std::nullopt;
  strip.poses = std::move(scanned->poses);
  strip.joints = std::move(scanned->joints);
  return strip;
}

// Objects and arrays that are open behind this beginning of a JSON text.
int open_behind(std::string_view text) {
  int open = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string && c == '\\') {
      ++i;
    } else if (c == '"') {
      in_string = !in_string;
    } else if (!in_string) {
      open += c == '{' || c == '[' ? 1 : c == '}' || c == ']' ? -1 : 0;
    }
  }
  return in_string ? -1 : open;
}

// A program laid out as to_json() does it, with nothing wrong in it. Nothing of any other text.
std::optional<Program> scanned_program(const std::string& text, const std::string& file_name) {
  constexpr std::string_view kStrips = "\n\"strips\": [\n", kAfter = "],\n\"verification\": ";
  std::string_view left(text);
  const auto before = take_to(left, kStrips);
  const std::size_t end = text.rfind(kAfter);
  if (!before || end == std::string::npos || end < before->size()) return std::nullopt;
  constexpr int kRootAndStrips = 2;
  if (open_behind(*before) != kRootAndStrips) return std::nullopt;
  const std::string_view after = std::string_view(text).substr(end);
  left.remove_suffix(after.size());
  const nlohmann::ordered_json frame = parse_json(fmt::format("{}{}", *before, after), file_name);
  const JsonNode root(frame, file_name);
  const BladesAtHand blades{blade_of(root.field("blade")), clamp_reach_mm(root.field("settings"))};
  std::set<std::string> ids;
  std::vector<Strip> found;
  do {
    auto strip = scanned_strip(left, blades, ids, file_name);
    if (!strip) return std::nullopt;
    found.push_back(std::move(*strip));
  } while (take(left, ",\n"));
  if (!left.empty()) return std::nullopt;
  return program_of(root, std::move(found), file_name, 1);
}

}  // namespace

Program parse_program(const std::string& text_of_file, const std::string& file_name,
                      std::size_t least_strips) {
  try {
    if (auto program = scanned_program(text_of_file, file_name)) return std::move(*program);
  } catch (const Error&) {  // told below, with its place in the whole
  }
  try {
    StripTaker taker(file_name);
    const JsonTaker into{"strips", [&](const JsonNode::Json& item) { return taker.take(item); },
                         [&](const std::string& key, const JsonNode::Json& value) { taker.see(key, value); }};
    const nlohmann::ordered_json json = parse_json(text_of_file, file_name, into);
    return program_of(JsonNode(json, file_name), taker.strips(), file_name, least_strips);
  } catch (const Error&) {
    // Read again as one tree, which knows the place of everything that is wrong, or finds another order of
    // keys.
    const nlohmann::ordered_json json = parse_json(text_of_file, file_name);
    return program_of(JsonNode(json, file_name), {}, file_name, least_strips);
  }
}

}  // namespace hotblade::pipeline
