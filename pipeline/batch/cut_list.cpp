#include "pipeline/batch/cut_list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string_view>

#include "pipeline/batch/csv.hpp"
#include "pipeline/batch/result.hpp"
#include "pipeline/program/sha256.hpp"

namespace hotblade::pipeline::batch {
namespace {

double number_in(const Cell& cell) {
  double value = 0;
  std::from_chars(cell.text.data(), cell.text.data() + cell.text.size(), value);
  return value;
}

// The columns of a strip that a block needs.
struct StripPlaces {
  std::size_t width = strip_column("blade_width_mm"), thickness = strip_column("blade_thickness_mm"),
              length = strip_column("blade_length_mm"), x = strip_column("stock_x_mm"),
              y = strip_column("stock_y_mm"), z = strip_column("stock_z_mm"),
              machine = strip_column("machine_s"), cut = strip_column("cut_s");
};

CutBlock block_of(const Job& job, const Cells& strip) {
  static const StripPlaces at;
  CutBlock block;
  block.strip = strip.front().text;
  block.id = block_id(job, block.strip);
  block.job = job.number;
  block.panel = job.panel;
  block.blade = {number_in(strip[at.width]), number_in(strip[at.thickness]), number_in(strip[at.length])};
  block.size_mm = {number_in(strip[at.x]), number_in(strip[at.y]), number_in(strip[at.z])};
  block.machine_s = number_in(strip[at.machine]);
  block.cut_s = number_in(strip[at.cut]);
  return block;
}

struct BestCase {
  std::string panel;
  JobFacts facts;  // without a job where none has passed
};

// The best case of every panel, in the order of their first jobs.
std::vector<BestCase> best_cases(const std::vector<JobFacts>& rows) {
  static const std::size_t verdict = plan_column("verdict"), machine = plan_column("machine_s");
  std::map<std::string, std::size_t> places;
  std::vector<BestCase> best;
  for (const JobFacts& row : rows) {
    const auto [found, fresh] = places.emplace(row.job->panel, best.size());
    if (fresh) best.push_back({row.job->panel, {}});
    if (row.facts->cells[verdict].text != kPassed) continue;
    JobFacts& kept = best[found->second].facts;
    if (kept.job == nullptr || number_in(row.facts->cells[machine]) < number_in(kept.facts->cells[machine]))
      kept = row;
  }
  return best;
}

BlockSize bought_size(const CutBlock& block, double step_mm) {
  // What rounding adds to a size that is a whole number of steps is no reason for one more.
  constexpr double kRoundingSteps = 1e-6;
  BlockSize size = block.size_mm;
  for (double& side : size) side = step_mm * std::ceil(side / step_mm - kRoundingSteps);
  std::sort(size.begin(), size.end(), std::greater<>());
  return size;
}

}  // namespace

double CutBlock::volume_m3() const {
  return size_mm[0] * size_mm[1] * size_mm[2] / kMm3PerM3;
}

void BlockSum::add(const CutBlock& block) {
  ++blocks;
  foam_m3 += block.volume_m3();
  machine_s += block.machine_s;
  cut_s += block.cut_s;
}

std::string block_id(const Job& job, const std::string& strip) {
  constexpr std::string_view kLetters = "ACEFHJKLMNPRTWXY";  // a hexadecimal digit each
  const auto digits = strip.find_first_of("123456789");
  const std::string number = digits == std::string::npos ? strip : strip.substr(digits);
  const std::string plain = fmt::format("{}-{}", job.number, number);
  const std::string hash = sha256_hex(plain + " " + job.key);
  const auto letter = [&](char digit) {
    return kLetters[static_cast<std::size_t>(digit <= '9' ? digit - '0' : digit - 'a' + 10)];
  };
  return plain + "-" + letter(hash[0]) + letter(hash[1]);
}

CutList cut_list(const std::vector<JobFacts>& rows, double step_mm) {
  if (!(step_mm > 0)) throw std::logic_error("cut_list: sizes in steps of nothing");
  CutList list;
  for (const auto& [panel, best] : best_cases(rows)) {
    ++list.panels;
    if (best.job == nullptr) {
      ++list.not_cut;
      list.not_cut_panels.push_back(panel);
      continue;
    }
    const bool amber = best.facts->cells[plan_column("color")].text == kAmber;
    if (amber) list.amber_panels.push_back(panel);
    for (const Cells& strip : best.facts->strips) {
      list.blocks.push_back(block_of(*best.job, strip));
      list.blocks.back().amber = amber;
    }
  }
  std::stable_sort(list.blocks.begin(), list.blocks.end(),
                   [](const CutBlock& a, const CutBlock& b) { return a.blade < b.blade; });
  for (const CutBlock& block : list.blocks) {
    list.all.add(block);
    list.blades[block.blade].add(block);
    list.sizes[bought_size(block, step_mm)].add(block);
  }
  return list;
}

std::string cut_list_table(const CutList& list) {
  std::string text = csv_line({"order", "id", "job", "panel", "strip", "blade_width_mm", "blade_thickness_mm",
                               "blade_length_mm", "mount_blade", "stock_x_mm", "stock_y_mm", "stock_z_mm",
                               "stock_m3", "machine_s", "cut_s", "amber"});
  const auto number = [](double value) { return fmt::format("{}", value); };
  for (std::size_t i = 0; i < list.blocks.size(); ++i) {
    const CutBlock& b = list.blocks[i];
    const bool mount = i == 0 || b.blade != list.blocks[i - 1].blade;
    text += csv_line({std::to_string(i + 1), b.id, std::to_string(b.job), b.panel, b.strip,
                      number(b.blade.width_mm), number(b.blade.thickness_mm), number(b.blade.length_mm),
                      mount ? "1" : "0", number(b.size_mm[0]), number(b.size_mm[1]), number(b.size_mm[2]),
                      number(b.volume_m3()), number(b.machine_s), number(b.cut_s), b.amber ? "1" : "0"});
  }
  return text;
}

std::string size_text(const BlockSize& size_mm) {
  return fmt::format("{:g} × {:g} × {:g}", size_mm[0], size_mm[1], size_mm[2]);
}

std::string blade_text(const MountedBlade& blade) {
  return fmt::format("{:g} ({:g} × {:g})", blade.length_mm, blade.width_mm, blade.thickness_mm);
}

}  // namespace hotblade::pipeline::batch
