#include "pipeline/batch/init.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <unordered_map>
#include <utility>

#include "elastica/kernels/simd_pin.hpp"
#include "pipeline/batch/commit.hpp"
#include "pipeline/batch/key.hpp"
#include "pipeline/batch/mapped_file.hpp"
#include "pipeline/batch/measured.hpp"
#include "pipeline/batch/result.hpp"
#include "pipeline/program/atomic_file.hpp"
#include "pipeline/program/sha256.hpp"
#include "pipeline/program/version.hpp"
#include "pipeline/settings/error.hpp"
#include "pipeline/settings/json_text.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline::batch {
namespace {

namespace fs = std::filesystem;

// The time of a plan on a core, before any was made: measured on panels of the samples.
constexpr double kEstimateS = 1.5, kEstimateSPerM2 = 0.1, kEstimateSPerTriangle = 1e-5;

// Schedulers take arrays of a thousand without being asked.
constexpr int kMostChunks = 1000;

// A plan of a panel with pictures takes 340 MB; the rest is for the few that are large.
constexpr int kChunkMegabytes = 2000;
// How much longer than it should a chunk may take before a cluster ends it.
constexpr double kChunkPatience = 3;

struct Design {
  std::string name, sha256;
  std::vector<GivenSetting> given;
  std::vector<std::string> values;  // of the list's columns
  std::size_t triangles = 0;
  double area_m2 = 0;
};

class Maker {
 public:
  Maker(const BatchDirectory& directory, Asked asked, const std::optional<Batch>& before,
        const InitHooks& hooks)
      : directory_(directory), hooks_(hooks), before_(before), cases_(cases_of(asked)) {
    batch_.asked = std::move(asked);
    batch_.version = version();
    batch_.commit = std::string(commit());
    batch_.simd = std::string(elastica::name(elastica::best_simd()));
  }

  InitReport make() {
    if (!batch_.asked.list.empty()) list_ = listed_designs(batch_.asked);
    check_keys();
    check_settings();
    for (const char* folder : {"designs", "settings", "chunks", "results"})
      ensure_directory(directory_.path() / folder);
    files_.emplace(directory_.path());
    list_ ? take_list() : take_design();
    make_jobs();
    InitReport report;
    report.chunks_changed = write_chunks();
    write(directory_.jobs(), jobs_text(jobs_));
    files_->sync();
    if (const std::string text = batch_text(batch_); !is_there(directory_.batch(), text))
      write_file_atomically(directory_.batch(), text, true);
    report.batch = batch_;
    for (const auto& [key, planned] : plans_) {
      report.plans_there += has_result(directory_, key) ? 1U : 0U;
    }
    return report;
  }

 private:
  void check_keys() const {
    if (!list_) return;
    for (const std::string& key : list_->keys) {
      for (const std::string own : {"group", "units", "up"}) {
        if (key != "design." + own) continue;
        throw Error(ErrorKind::kBadInput,
                    fmt::format("{}:1: {}: call the column `{}`", batch_.asked.list, key, own));
      }
      if (std::find(cases_.keys.begin(), cases_.keys.end(), key) == cases_.keys.end()) continue;
      throw Error(
          ErrorKind::kBadSettings,
          fmt::format("{} is swept, and a column of {}: give it in one place", key, batch_.asked.list));
    }
  }

  // Every combination of settings, before anything is written.
  void check_settings() {
    if (!list_) {
      for (const Case& one : cases_.list) (void)settings_sha256({}, one, false);
      return;
    }
    for (const ListedDesign& design : list_->designs) {
      for (const Case& one : cases_.list) (void)settings_sha256(design.settings, one, false);
    }
  }

  // The hash of the settings of a design in a case; the file is written where that is asked for.
  const std::string& settings_sha256(const std::vector<GivenSetting>& given, const Case& one, bool writes) {
    std::string name;
    for (const GivenSetting& setting : given) name += setting.key + "\n" + setting.value + "\n";
    for (const std::string& value : one) name += "\n" + value;
    const auto found = settings_.find(name);
    if (found != settings_.end() && (found->second.written || !writes)) return found->second.sha256;
    std::vector<GivenSetting> all = given;
    for (std::size_t i = 0; i < one.size(); ++i) all.push_back({"sweep", cases_.keys[i], one[i]});
    Settings settings = settings_at(given, all);
    units_[name_of(given)] = settings.design.units;
    const bool reads_group = std::any_of(given.begin(), given.end(), [](const GivenSetting& setting) {
      return setting.key == "design.group";  // of a design that is not split
    });
    if (!reads_group) {
      if (!settings.design.group.empty()) take_group(settings.design.group);
      settings.design.group.clear();  // a panel is the group
    }
    const std::string text = to_toml(settings);
    SettingsFile& file = settings_[name];
    file.sha256 = sha256_hex(text);
    if (writes) {
      write(directory_.settings(file.sha256), text);
      file.written = true;
    }
    return file.sha256;
  }

  // A setting that is wrong beside others names no place by itself: the line is what was given last.
  [[nodiscard]] Settings settings_at(const std::vector<GivenSetting>& given,
                                     const std::vector<GivenSetting>& all) const {
    try {
      return settings_of(batch_.asked, all);
    } catch (const Error& error) {
      const std::string what = error.what();
      if (given.empty() || what.find(given.front().given) != std::string::npos) throw;
      throw Error(error.kind, given.front().given + ": " + what);
    }
  }

  static std::string name_of(const std::vector<GivenSetting>& given) {
    std::string name;
    for (const GivenSetting& setting : given) name += setting.key + "\n" + setting.value + "\n";
    return name;
  }

  void take_group(const std::string& group) {
    if (list_ || batch_.asked.split != "none") {
      throw Error(ErrorKind::kBadSettings,
                  "design.group is set, and the panels are groups already: leave it out of the settings");
    }
    group_ = group;
  }

  void expect_going_on() const {
    if (hooks_.stop && hooks_.stop())
      throw Error(ErrorKind::kInterrupted, "interrupted: the batch was not made");
  }

  void tell(const std::string& stage, double share) const {
    if (hooks_.progress) hooks_.progress(stage, std::min(share, 1.0));
  }

  // ---- designs ----

  void take_design() {
    const fs::path file = batch_.asked.design;
    const MappedFile mapped(file);
    const std::string units = units_.at("");
    const SplitOptions options = split_options(batch_.asked, *split_named(batch_.asked.split), units, group_);
    const double walks = options.by == SplitBy::kComponent ? 5 : 3;
    double walked = 0;
    const auto read = [&](std::size_t bytes) {
      expect_going_on();
      mapped.forget();
      walked += static_cast<double>(bytes);
      tell("split", walked / walks / static_cast<double>(mapped.text().size()));
    };
    split_obj(
        mapped.text(), file.string(), options,
        [&](PanelText&& panel) { add_design(std::move(panel), units, {}, {}); }, read);
  }

  void take_list() {
    double taken = 0;
    for (const NamedDesign& named : named_designs(*list_)) {
      const ListedDesign& design = named.design;
      const std::string& units = units_.at(name_of(design.settings));
      PanelText text = listed_text(design, units);
      text.name = named.name;
      std::vector<std::string> values;
      for (const std::string& key : list_->keys) {
        const auto at = std::find_if(design.settings.begin(), design.settings.end(),
                                     [&](const GivenSetting& one) { return one.key == key; });
        values.push_back(at != design.settings.end() ? at->value : "");
      }
      add_design(std::move(text), units, design.settings, std::move(values));
      tell("split", ++taken / static_cast<double>(list_->designs.size()));
    }
  }

  PanelText listed_text(const ListedDesign& design, const std::string& units) const {
    const MappedFile mapped(design.path);
    const SplitOptions options = split_options(batch_.asked, SplitBy::kNone, units, design.group);
    PanelText text;
    if (is_no_obj(design)) {
      text.text = mapped.text();
      return text;
    }
    try {
      split_obj(mapped.text(), design.path, options, [&](PanelText&& panel) { text = std::move(panel); });
    } catch (const surface::MeshError&) {
      // One of thousands that is no design does not stop the others; its plan says why, with its line.
      if (!design.group.empty()) throw;
      text.text = mapped.text();
    }
    return text;
  }

  void add_design(PanelText&& panel, const std::string& units, const std::vector<GivenSetting>& given,
                  std::vector<std::string> values) {
    expect_going_on();
    const double metres = surface::scale_to_mm(units) / 1000;
    designs_.push_back({std::move(panel.name), sha256_hex(panel.text), given, std::move(values),
                        panel.triangles, panel.area * metres * metres});
    const std::string& sha256 = designs_.back().sha256;
    if (distinct_.insert(sha256).second) write(directory_.design(sha256), panel.text);
  }

  // Writes a file unless it is there with these bytes; returns whether it was written.
  bool write(const fs::path& path, const std::string& text) {
    if (is_there(path, text)) return false;
    files_->write(path, text);
    return true;
  }

  static bool is_there(const fs::path& path, const std::string& text) {
    std::error_code error;
    return fs::file_size(path, error) == text.size() && !error && MappedFile(path).text() == text;
  }

  // ---- jobs and chunks ----

  void make_jobs() {
    jobs_.keys = list_ ? list_->keys : std::vector<std::string>{};
    jobs_.keys.insert(jobs_.keys.end(), cases_.keys.begin(), cases_.keys.end());
    double seconds = 0;
    for (const Design& design : designs_) {
      expect_going_on();
      for (const Case& one : cases_.list) {
        const std::string& settings = settings_sha256(design.given, one, true);
        const std::string key =
            key_of({batch_.version, batch_.commit, batch_.simd, settings, design.sha256,
                    batch_.asked.pictures, batch_.asked.keep + (batch_.asked.gzip ? " gzip" : "")});
        if (plans_.emplace(key, PlannedKey{key, design.sha256, settings}).second) {
          seconds += kEstimateS + kEstimateSPerM2 * design.area_m2 +
                     kEstimateSPerTriangle * static_cast<double>(design.triangles);
        }
        std::vector<std::string> values = design.values;
        values.insert(values.end(), one.begin(), one.end());
        jobs_.jobs.push_back({jobs_.jobs.size() + 1, design.name, key, 0, std::move(values)});
      }
    }
    // What plans have taken tells more than their sizes.
    if (const std::optional<double> measured = measured_plan_s(directory_))
      seconds = *measured * static_cast<double>(plans_.size());
    const double chunk_s = 60 * batch_.asked.chunk_minutes;
    batch_.chunks = before_
                        ? before_->chunks
                        : static_cast<int>(std::clamp<double>(std::ceil(seconds / chunk_s), 1, kMostChunks));
    for (Job& job : jobs_.jobs) job.chunk = chunk_of(job.key, batch_.chunks);
    batch_.panels = designs_.size();
    batch_.designs = distinct_.size();
    batch_.jobs = jobs_.jobs.size();
    batch_.plans = plans_.size();
    batch_.estimate_s = seconds / static_cast<double>(plans_.size());
    batch_.mem_mb = kChunkMegabytes;
    // Chunks are longer than was asked where there are no more of them, or where plans take longer than was
    // thought when they were made.
    const double chunk_minutes = std::max(batch_.asked.chunk_minutes, seconds / 60 / batch_.chunks);
    batch_.minutes = static_cast<int>(std::ceil(kChunkPatience * chunk_minutes));
    batch_.jobs_sha256 = sha256_hex(jobs_text(jobs_));
  }

  int write_chunks() {
    std::vector<std::vector<PlannedKey>> chunks(static_cast<std::size_t>(batch_.chunks));
    for (const auto& [key, planned] : plans_)
      chunks[static_cast<std::size_t>(chunk_of(key, batch_.chunks))].push_back(planned);
    int changed = 0;
    for (int i = 0; i < batch_.chunks; ++i) {
      const std::string text = chunk_text(chunks[static_cast<std::size_t>(i)]);
      if (!write(directory_.chunk(i), text)) continue;
      ++changed;
      std::error_code ignored;
      fs::remove(directory_.stamp(i), ignored);
      fs::remove(directory_.failures(i), ignored);
    }
    return changed;
  }

  struct SettingsFile {
    std::string sha256;
    bool written = false;
  };

  const BatchDirectory& directory_;
  const InitHooks& hooks_;
  const std::optional<Batch>& before_;
  Cases cases_;
  Batch batch_;
  std::optional<FilesSyncedTogether> files_;
  std::optional<DesignList> list_;
  std::string group_;  // of design.group, with a design that is not split
  std::unordered_map<std::string, SettingsFile> settings_;  // by what is given and swept
  std::map<std::string, std::string> units_;                // by what is given
  std::vector<Design> designs_;
  std::set<std::string> distinct_;
  JobTable jobs_;
  std::map<std::string, PlannedKey> plans_;  // by key
};

// batch.json is UTF-8, and a file is opened again by the name that stands there.
void refuse_names(const Asked& asked) {
  std::vector<std::string> names{asked.design, asked.list, asked.sweep_file};
  names.insert(names.end(), asked.configs.begin(), asked.configs.end());
  for (const std::string& name : names) {
    if (!is_utf8(name))
      throw Error(ErrorKind::kBadInput,
                  utf8_text(name) + ": its name is no UTF-8, as batch.json is: give it another");
  }
}

}  // namespace

InitReport init_batch(const BatchDirectory& directory, std::optional<Asked> asked, bool update,
                      const InitHooks& hooks) {
  std::error_code ignored;
  const bool there = fs::exists(directory.batch(), ignored);
  if (there && !update) {
    throw Error(ErrorKind::kFile,
                directory.path().string() +
                    ": a batch is already there: use --update to bring it up to what is asked");
  }
  if (asked) refuse_names(*asked);
  std::optional<Batch> before;
  if (there) before = read_batch(directory);
  if (!asked && !before) (void)read_batch(directory);  // says that none is there
  return Maker(directory, asked ? *asked : before->asked, before, hooks).make();
}

}  // namespace hotblade::pipeline::batch
