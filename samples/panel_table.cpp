// Makes the panels of a seed, plans each with the program and prints what came out as a Markdown table:
//   panel_table [SEED | dented:SEED | shells:SEED | vaults:SEED | DIRECTORY]... [--tolerance MM] [--at-least
//   N] [--out DIRECTORY]
// Of a directory every OBJ is planned, in mm. Exit code 1 when fewer than N panels pass (all, unless said).
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "samples/panels.hpp"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// A plan that has not answered by then is ended: its row says so.
constexpr rlim_t kProcessorLimitS = 600;
// Share of the tolerance that a Bezier may lie off its elastica, and by how much what a program says of that
// may be too large (pipeline/program/program.hpp, pipeline/verify/rib_measures.hpp).
constexpr double kBezierShare = 0.1, kHausdorffErrorMm = 1e-4;

struct Options {
  std::vector<std::string> sets;  // seeds and directories
  std::string tolerance_mm;       // empty: the default of the settings
  std::optional<int> at_least;
  fs::path out = "build/panels";
};

struct Planned {
  int code = -1;  // exit code; -1 when a signal ended it
  double processor_s = 0;
  long peak_mb = 0;
  json report;                    // null without one
  std::vector<double> bezier_mm;  // by rib of the program, none without one
};

struct Totals {
  int panels = 0, passed = 0, within_half = 0;
  std::size_t strips = 0, bound = 0;
  std::vector<double> processor_s;
  std::vector<double>
      bezier_mm;        // of every rib's Beziers from its elastica, as the program says and verify measures
  std::size_t far = 0;  // of those, over a tenth of the tolerance
};

std::vector<std::string> plan_command(const fs::path& obj, const fs::path& out, const Options& options) {
  std::vector<std::string> words{
      HOTBLADE_PROGRAM,   "plan",          obj.string(), "--units",    "mm",     "--set",
      "design.keep=back", "--no-pictures", "-o",         out.string(), "--force"};
  if (!options.tolerance_mm.empty()) words.insert(words.end(), {"--tolerance", options.tolerance_mm});
  return words;
}

// In the child: never returns. What the program says goes to a file beside its reports.
[[noreturn]] void become(std::vector<std::string> words, const fs::path& log) {
  const rlimit limit{kProcessorLimitS, kProcessorLimitS};
  setrlimit(RLIMIT_CPU, &limit);
  const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  dup2(file, STDOUT_FILENO);
  dup2(file, STDERR_FILENO);
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  execv(argv[0], argv.data());
  _exit(127);
}

double seconds(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

Planned planned(const fs::path& obj, const fs::path& out, const Options& options) {
  // A report of an earlier run is no answer of this one.
  fs::remove_all(out);
  fs::create_directories(out.parent_path());
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("cannot start a process");
  if (child == 0) become(plan_command(obj, out, options), out.string() + ".log");
  int status = 0;
  rusage used{};
  if (wait4(child, &status, 0, &used) != child) throw std::runtime_error("lost a process");
  Planned result;
  result.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  result.processor_s = seconds(used.ru_utime) + seconds(used.ru_stime);
  result.peak_mb = used.ru_maxrss * 1024 / 1000000;
  if (std::ifstream in(out / "report.json"); in) result.report = json::parse(in);
  if (std::ifstream in(out / "program.json"); in) {
    const json program = json::parse(in);
    for (const json& strip : program.at("strips")) {
      for (const json& rib : strip.at("ribs")) result.bezier_mm.push_back(rib.at("hausdorff_mm"));
    }
  }
  return result;
}

std::string why(const Planned& p, const fs::path& log) {
  if (p.code == -1) return fmt::format("no answer after {:.0f} s of processor time", p.processor_s);
  if (p.report.is_null()) {
    std::ifstream in(log);
    std::string line, last;
    while (std::getline(in, line)) last = line;
    return fmt::format("exit code {}: {}", p.code, last);
  }
  const json& refusals = p.report.at("refusals");
  if (refusals.empty()) return "";
  const std::string more = refusals.size() > 1 ? fmt::format(" (and {} more)", refusals.size() - 1) : "";
  return refusals.front().at("message").get<std::string>() + more;
}

// A cell of the table ends at a bar.
std::string cell(std::string text) {
  std::replace(text.begin(), text.end(), '|', '/');
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

// One row, counted into the totals.
std::string row(const std::string& name, const Planned& p, const std::string& reason, Totals& totals) {
  ++totals.panels;
  totals.processor_s.push_back(p.processor_s);
  const std::string cost = fmt::format("{:.2f} | {}", p.processor_s, p.peak_mb);
  if (p.report.is_null())
    return fmt::format("| {} | none | - | - | - | - | - | - | {} | {} |", name, cost, cell(reason));
  const json& r = p.report;
  const std::string status = r.at("status");
  const double deviation_mm = r.at("deviation_mm").at("max"), tolerance_mm = r.at("tolerance_mm");
  const json& strips = r.at("strips");
  std::size_t ribs = 0;
  for (const json& strip : strips) ribs += strip.at("ribs").get<std::size_t>();
  const auto bound = r.find("strips_lower_bound");
  const bool bounded = bound != r.end() && bound->is_number();
  if (status == "passed") {
    ++totals.passed;
    totals.within_half += deviation_mm <= tolerance_mm / 2 ? 1 : 0;
    totals.strips += strips.size();
    totals.bound += bounded ? bound->get<std::size_t>() : 0;
  }
  double bezier_mm = 0;
  for (const double mm : p.bezier_mm) {
    bezier_mm = std::max(bezier_mm, mm);
    totals.far += mm > kBezierShare * tolerance_mm + kHausdorffErrorMm;
  }
  totals.bezier_mm.insert(totals.bezier_mm.end(), p.bezier_mm.begin(), p.bezier_mm.end());
  return fmt::format("| {} | {} | {} | {} | {} | {:.3f} | {:.3f} | {} | {} | {} |", name, status,
                     strips.size(), bounded ? bound->dump() : "-", ribs, deviation_mm,
                     r.at("deviation_mm").at("p99").get<double>(),
                     p.bezier_mm.empty() ? "-" : fmt::format("{:.4f}", bezier_mm), cost, cell(reason));
}

void print_totals(Totals totals) {
  if (totals.panels == 0) return;
  std::sort(totals.processor_s.begin(), totals.processor_s.end());
  const std::size_t half = totals.processor_s.size() / 2;
  const double median = totals.processor_s.size() % 2 == 1
                            ? totals.processor_s[half]
                            : (totals.processor_s[half - 1] + totals.processor_s[half]) / 2;
  fmt::print("\n{} of {} passed, {} within half the tolerance; {} strips in those that passed (bound {});\n",
             totals.passed, totals.panels, totals.within_half, totals.strips,
             totals.bound > 0 ? std::to_string(totals.bound) : "-");
  std::sort(totals.bezier_mm.begin(), totals.bezier_mm.end());
  const std::size_t ribs = totals.bezier_mm.size();
  if (ribs > 0) {
    fmt::print(
        "Beziers of {} ribs off their elastica: max {:.4f} mm, p99 {:.4f} mm, {} over a tenth of the "
        "tolerance;\n",
        ribs, totals.bezier_mm.back(), totals.bezier_mm[((ribs - 1) * 99 + 99) / 100], totals.far);
  }
  fmt::print("processor time: median {:.2f} s, worst {:.2f} s\n", median, totals.processor_s.back());
}

// The seed's panels as files in out/SEED; a directory's own files otherwise.
std::vector<fs::path> designs(const std::string& set, const fs::path& directory) {
  std::vector<fs::path> files;
  if (fs::is_directory(set)) {
    for (const auto& entry : fs::directory_iterator(set)) {
      if (entry.path().extension() == ".obj") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    return files;
  }
  using namespace hotblade::samples;
  struct Kind {
    std::string_view before;
    std::vector<Panel> (*of)(std::uint64_t seed);
  };
  constexpr std::array<Kind, 4> kKinds{
      {{"dented:", dented_panels}, {"shells:", shell_panels}, {"vaults:", vault_panels}, {"", panels}}};
  const Kind& kind = *std::find_if(kKinds.begin(), kKinds.end(),
                                   [&](const Kind& each) { return set.starts_with(each.before); });
  std::uint64_t seed = 0;
  const char* first = set.data() + kind.before.size();
  const auto [end, error] = std::from_chars(first, set.data() + set.size(), seed);
  if (error != std::errc() || end != set.data() + set.size())
    throw std::invalid_argument(
        set + ": neither a seed (a whole number), dented:SEED, shells:SEED, vaults:SEED nor a directory");
  fs::create_directories(directory);
  for (const Panel& panel : kind.of(seed)) {
    files.push_back(directory / (panel.name + ".obj"));
    std::ofstream out(files.back(), std::ios::binary);
    out << obj_text(panel);
    if (!out.flush()) throw std::runtime_error(files.back().string() + ": cannot write");
  }
  return files;
}

Options parsed(const std::vector<std::string>& words) {
  Options options;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool option = words[i].starts_with("--");
    if (option && i + 1 == words.size()) throw std::invalid_argument(words[i] + ": needs a value");
    if (words[i] == "--tolerance") {
      options.tolerance_mm = words[++i];
    } else if (words[i] == "--at-least") {
      options.at_least = std::stoi(words[++i]);
    } else if (words[i] == "--out") {
      options.out = words[++i];
    } else if (option) {
      throw std::invalid_argument(words[i] + ": no such option");
    } else {
      options.sets.push_back(words[i]);
    }
  }
  if (options.sets.empty()) options.sets = {"1"};
  return options;
}

int table(const Options& options) {
  std::puts(
      "| panel | status | strips | bound | ribs | deviation max mm | p99 mm | Bezier max mm | processor s | "
      "peak MB | why |");
  std::puts("|---|---|---|---|---|---|---|---|---|---|---|");
  std::fflush(stdout);
  Totals totals;
  for (const std::string& set : options.sets) {
    // The last part of a directory's name, with or without a slash after it.
    const fs::path directory = options.out / (fs::path(set) / "").parent_path().filename();
    for (const fs::path& obj : designs(set, directory)) {
      const fs::path out = directory / "plans" / obj.stem();
      const Planned p = planned(obj, out, options);
      const std::string name =
          options.sets.size() > 1 ? set + " " + obj.stem().string() : obj.stem().string();
      std::puts(row(name, p, why(p, out.string() + ".log"), totals).c_str());
      std::fflush(stdout);
    }
  }
  print_totals(totals);
  return totals.passed >= options.at_least.value_or(totals.panels) ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return table(parsed({argv + 1, argv + argc}));
  } catch (const std::logic_error& error) {
    std::fprintf(stderr,
                 "%s\nusage: panel_table [SEED | dented:SEED | shells:SEED | vaults:SEED | DIRECTORY]... "
                 "[--tolerance MM] "
                 "[--at-least N] [--out "
                 "DIRECTORY]\n",
                 error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
