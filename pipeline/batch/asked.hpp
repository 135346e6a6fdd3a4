// What a batch is asked to plan: one OBJ that is split or a list of designs, times the cases of its sweeps.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/batch/split.hpp"
#include "pipeline/settings/settings.hpp"

namespace hotblade::pipeline::batch {

// What is kept of each plan: the reports; the program too; everything that a plan writes.
inline constexpr const char *kKeepReport = "report", *kKeepProgram = "program", *kKeepAll = "all";
// Pictures of each plan: none; one small one beside the report; all of them.
inline constexpr const char *kPicturesNone = "none", *kPicturesThumb = "thumb", *kPicturesFull = "full";

// The words of `hotblade batch init`, with paths that hold wherever they are read from.
struct Asked {
  std::string design, list;  // one of them
  std::string split = "none";
  int group_index = 0;
  std::string units, up;  // empty: not given
  std::vector<std::string> configs, assignments, sweeps;
  std::string sweep_file;
  std::string pictures = kPicturesThumb, keep = kKeepProgram;
  bool gzip = false;  // programs are packed
  double chunk_minutes = 10;
};

[[nodiscard]] nlohmann::ordered_json to_json(const Asked& asked);
// Throws nlohmann's exceptions for what to_json() does not write.
[[nodiscard]] Asked asked_from(const nlohmann::ordered_json& json);

// Setting keys with values, as they are given on top of what a whole batch has; `given` says where, for
// messages.
struct GivenSetting {
  std::string given, key, value;
};

// One case of the sweeps: a value for each of Cases::keys.
using Case = std::vector<std::string>;
struct Cases {
  std::vector<std::string> keys;
  std::vector<Case> list;  // at least one; that of a batch without sweeps has no values
};

// Returns all combinations of the sweeps ("KEY=V1,V2"; commas inside brackets and quotes part nothing) and
// the lines of the sweep file, the first sweep changing slowest. Throws Error: kBadSettings for a sweep
// without values or a key that is swept twice, and as read_csv() does.
[[nodiscard]] Cases cases_of(const Asked& asked);

// One line of designs.csv.
struct ListedDesign {
  std::string path;  // as it is found from here
  std::string name, units, up, group;
  std::vector<GivenSetting> settings;
};
struct DesignList {
  std::vector<std::string> keys;  // the settings that have columns
  std::vector<ListedDesign> designs;
};

// Returns the designs of a list with the columns path, units, up, group and settings; paths are from the
// list's folder. An empty cell gives nothing. Throws Error: kBadInput without a path, and as read_csv() does.
[[nodiscard]] DesignList read_design_list(const std::string& file);

// Returns the designs of the list that was asked for. One that is no OBJ by its own name and bytes, or by
// settings, has that as its `design.format`, its group as `design.group`, and a glTF its unit and axis.
[[nodiscard]] DesignList listed_designs(const Asked& asked);

// Returns whether a design of listed_designs() is read as it is, and not split as an OBJ.
[[nodiscard]] bool is_no_obj(const ListedDesign& design);

// A design of a list with its panel's name: the n-th of a name is called NAME#n.
struct NamedDesign {
  ListedDesign design;
  std::string name;
};
[[nodiscard]] std::vector<NamedDesign> named_designs(const DesignList& list);

// Returns how a design in these units is split, the faces of `only` alone where that is not empty.
[[nodiscard]] SplitOptions split_options(const Asked& asked, SplitBy by, const std::string& units,
                                         const std::string& only);

// Returns what the batch's settings and the given ones amount to, in the order they are given. Throws Error
// (kBadSettings) as resolve() does, and without units.
[[nodiscard]] Settings settings_of(const Asked& asked, const std::vector<GivenSetting>& given);

}  // namespace hotblade::pipeline::batch
