#include "pipeline/batch/given_lines.hpp"

#include <charconv>
#include <functional>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "pipeline/batch/mapped_file.hpp"
#include "pipeline/program/sha256.hpp"
#include "pipeline/settings/error.hpp"
#include "surface/read/design_surface.hpp"

namespace hotblade::pipeline::batch {
namespace {

// The line of a file where that of a panel's text is; absent where it is not known.
using FileLine = std::function<std::optional<std::size_t>(std::size_t)>;

const std::regex& line_words() {
  static const std::regex words(R"(\blines? (\d+)(?: and (\d+))?)");
  return words;
}

bool names_a_line(const std::string& text, const std::string& design_name) {
  return text.find(design_name) != std::string::npos || std::regex_search(text, line_words());
}

// A number of a text in its place among the given lines; as it is where that is not known.
std::string given(const std::string& digits, const FileLine& file_line) {
  std::size_t line = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), line);
  const std::optional<std::size_t> found = file_line(line);
  return found ? std::to_string(*found) : digits;
}

// `PATH/HASH.obj:12: what` with the given file and its line.
std::string with_file(const std::string& text, const std::string& design_name, const std::string& file,
                      const FileLine& file_line) {
  const auto name = text.find(design_name);
  if (name == std::string::npos) return text;
  const auto before = text.rfind(": ", name);  // a path may have blanks
  const std::size_t path = before == std::string::npos ? 0 : before + 2;
  std::string out = text.substr(0, path) + file;
  std::size_t rest = name + design_name.size();
  if (rest < text.size() && text[rest] == ':') {
    const auto end = text.find_first_not_of("0123456789", rest + 1);
    const std::string digits = text.substr(rest + 1, end == std::string::npos ? end : end - rest - 1);
    if (!digits.empty()) {
      out += ":" + given(digits, file_line);
      rest = end == std::string::npos ? text.size() : end;
    }
  }
  return out + text.substr(rest);
}

std::string with_line_words(const std::string& text, const FileLine& file_line) {
  std::string out;
  std::size_t from = 0;
  for (std::sregex_iterator at(text.begin(), text.end(), line_words()), end; at != end; ++at) {
    for (std::size_t group = 1; group <= 2; ++group) {
      if (!(*at)[group].matched) continue;
      const auto begin = static_cast<std::size_t>(at->position(group));
      out += text.substr(from, begin - from) + given((*at)[group].str(), file_line);
      from = begin + static_cast<std::size_t>(at->length(group));
    }
  }
  return out + text.substr(from);
}

class Namer {
 public:
  Namer(const BatchDirectory& directory, BatchFacts& all) : directory_(directory), all_(all) {
    for (const Job& job : all.table.jobs) {
      const std::string& sha256 = all.planned.at(job.key).design_sha256;
      if (seen_.insert(job.key).second && names_lines(all.of_key.at(job.key), name_of(sha256)))
        keys_of_panel_[job.panel].push_back(job.key);
    }
  }

  void name_all() {
    if (keys_of_panel_.empty()) return;
    try {
      all_.batch.asked.list.empty() ? walk_design() : walk_list();
    } catch (const Error&) {  // the design, its settings or the list are not there any more, or changed
    } catch (const surface::MeshError&) {
    }
  }

 private:
  [[nodiscard]] std::string name_of(const std::string& sha256) const {
    return "designs/" + directory_.design(sha256).filename().string();
  }

  [[nodiscard]] static std::vector<std::string*> texts_of(PlanFacts& facts) {
    std::vector<std::string*> texts{&facts.cells[plan_column("message")].text};
    for (Cells& warning : facts.warnings) texts.push_back(&warning.front().text);
    return texts;
  }

  [[nodiscard]] static bool names_lines(PlanFacts& facts, const std::string& design_name) {
    for (const std::string* text : texts_of(facts)) {
      if (names_a_line(*text, design_name)) return true;
    }
    return false;
  }

  void walk_design() {
    const Asked& asked = all_.batch.asked;
    const Settings settings = settings_of(asked, {});
    SplitOptions options =
        split_options(asked, *split_named(asked.split), settings.design.units, settings.design.group);
    options.with_lines = true;
    options.wanted = [&](const std::string& panel) { return keys_of_panel_.contains(panel); };
    const MappedFile mapped(asked.design);
    split_obj(mapped.text(), asked.design, options, [&](PanelText&& panel) {
      mapped.forget();
      name_in(panel.name, sha256_hex(panel.text), asked.design,
              [&](std::size_t line) { return panel.file_line(line); });
    });
  }

  void walk_list() {
    const Asked& asked = all_.batch.asked;
    for (const NamedDesign& named : named_designs(listed_designs(asked))) {
      if (!keys_of_panel_.contains(named.name)) continue;
      const ListedDesign& design = named.design;
      const Settings settings = settings_of(asked, design.settings);
      SplitOptions options = split_options(asked, SplitBy::kNone, settings.design.units, design.group);
      options.with_lines = true;
      const MappedFile mapped(design.path);
      const auto as_it_is = [](std::size_t line) { return std::optional(line); };
      if (is_no_obj(design)) {
        name_in(named.name, sha256_hex(mapped.text()), design.path, as_it_is);
        continue;
      }
      try {
        split_obj(mapped.text(), design.path, options, [&](PanelText&& panel) {
          name_in(named.name, sha256_hex(panel.text), design.path,
                  [&](std::size_t line) { return panel.file_line(line); });
        });
      } catch (const surface::MeshError&) {  // it was planned as it is
        name_in(named.name, sha256_hex(mapped.text()), design.path, as_it_is);
      }
    }
  }

  void name_in(const std::string& panel, const std::string& sha256, const std::string& file,
               const FileLine& file_line) {
    for (const std::string& key : keys_of_panel_.at(panel)) {
      if (all_.planned.at(key).design_sha256 != sha256) continue;
      for (std::string* text : texts_of(all_.of_key.at(key)))
        *text = with_file(with_line_words(*text, file_line), name_of(sha256), file, file_line);
    }
  }

  const BatchDirectory& directory_;
  BatchFacts& all_;
  std::set<std::string> seen_;                                     // keys
  std::map<std::string, std::vector<std::string>> keys_of_panel_;  // whose plans name lines
};

}  // namespace

void name_given_lines(const BatchDirectory& directory, BatchFacts& all) {
  Namer(directory, all).name_all();
}

}  // namespace hotblade::pipeline::batch
