// hotblade preview: a picture of a program or a design, in a window or as a PNG file.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>

#include "pipeline/cell/cell_file.hpp"
#include "pipeline/cli/command.hpp"
#include "pipeline/cli/settings_options.hpp"
#include "pipeline/plan/arms/arms.hpp"
#include "pipeline/plan/arms/strip_clearance.hpp"
#include "pipeline/preview/drawing.hpp"
#include "pipeline/program/atomic_file.hpp"
#include "pipeline/program/design_file.hpp"
#include "pipeline/program/gzip.hpp"
#include "pipeline/program/program.hpp"
#include "pipeline/program/read_design.hpp"
#include "pipeline/program/refused_plan.hpp"

namespace hotblade::pipeline {
namespace {

namespace fs = std::filesystem;
using surface::DesignSurface;

struct PreviewOptions {
  DesignOptions input;  // the file may be a program as well
  std::string design;   // of a program; empty: the file beside it, if there is one
  std::string cell;     // of the program's joints; empty: one that comes with hotblade, if it is theirs
  std::string arms = "on";
  std::string color;
  std::string shot, movie, exported;
  int frames = 60;
  std::string size = "1280x720";
  std::string view = "best";
  std::vector<std::string> keys;
  preview::SceneOptions scene;
  bool force = false;
};

preview::PictureSize picture_size(const std::string& text) {
  constexpr int kSmallest = 160, kLargest = 8192;  // drawn twice as large; more is over what OpenGL promises
  preview::PictureSize size;
  const char* end = text.data() + text.size();
  const auto [times, error] = std::from_chars(text.data(), end, size.width);
  const bool parted = error == std::errc() && times != end && *times == 'x';
  const auto height =
      parted ? std::from_chars(times + 1, end, size.height) : std::from_chars_result{end, error};
  const bool complete = parted && height.ec == std::errc() && height.ptr == end;
  const bool fits =
      std::min(size.width, size.height) >= kSmallest && std::max(size.width, size.height) <= kLargest;
  if (!complete || !fits) {
    throw Error(ErrorKind::kBadSettings,
                fmt::format("--size: not a picture size ({}, {} to {} each way): write 1280x720", text,
                            kSmallest, kLargest));
  }
  return size;
}

std::optional<preview::Color> color_of(const std::string& name) {
  if (name.empty()) return std::nullopt;
  return preview::color_named(name);
}

// The design a program was made from: the file given, or the one beside the program.
std::optional<DesignSurface> design_of(const Program& program, const PreviewOptions& options) {
  const fs::path beside = fs::path(options.input.file).parent_path() / program.design.file;
  if (options.design.empty() && !fs::exists(beside)) return std::nullopt;
  const fs::path file = options.design.empty() ? beside : fs::path(options.design);
  return read_design_of(program, file);
}

// A cell and what of it is shown; the second refers to the first.
struct ShownCell {
  robot::Cell cell;
  preview::CellShown shown;
};

// The cell whose joints the program has: the one given, or one that comes with the program.
std::unique_ptr<ShownCell> cell_of(const Program& program, const PreviewOptions& options) {
  if (!program.cell) {
    if (!options.cell.empty())
      throw Error(ErrorKind::kBadInput,
                  options.input.file + ": the program has no joints: plan it with --cell");
    return nullptr;
  }
  if (options.arms == "off") return nullptr;
  std::vector<std::string> names{options.cell};
  if (options.cell.empty()) names = embedded_cells();
  for (const std::string& name : names) {
    auto found = std::make_unique<ShownCell>(ShownCell{read_cell(name), {}});
    if (cell_sha256(found->cell) != program.cell->sha256) continue;
    found->shown.cell = &found->cell;
    found->shown.by_margin = options.arms == "margin";
    for (const Strip& strip : program.strips) {
      std::vector<robot::Standing> standing = surroundings(strip, found->cell);
      // The block is drawn by its edges.
      std::erase_if(standing, [](const auto& s) { return s.what == robot::Standing::What::kBlock; });
      found->shown.standing[strip.id] = std::move(standing);
    }
    return found;
  }
  if (options.cell.empty()) return nullptr;
  throw Error(ErrorKind::kBadInput, options.input.file + ": the joints are those of another cell (" +
                                        program.cell->name + "), not of " + options.cell);
}

// What a .json holds: a program, or what a refused plan found, with why.
struct Shown {
  Program program;
  std::vector<RefusedReason> reasons;
};

Shown read_shown(const fs::path& file) {
  if (!is_refused_plan(file)) return {read_program(file), {}};
  RefusedPlan plan = read_refused_plan(file);
  return {std::move(plan.found), std::move(plan.reasons)};
}

// Of a plan that has no strip to show there is its design alone.
DesignSurface design_to_show(const Program& program, const PreviewOptions& options) {
  auto design = design_of(program, options);
  if (!design)
    throw Error(ErrorKind::kBadSettings,
                options.input.file + ": nothing is cut, and its design is not beside it: give --design");
  return std::move(*design);
}

preview::Scene program_scene(const PreviewOptions& options) {
  const Shown shown = read_shown(options.input.file);
  const Program& program = shown.program;
  if (program.strips.empty()) {
    preview::Scene scene = preview::scene_of(design_to_show(program, options));
    preview::mark_refusal(scene, shown.reasons);
    return scene;
  }
  const auto design = design_of(program, options);
  const auto cell = cell_of(program, options);
  preview::SceneOptions scene_options = options.scene;
  if (cell) scene_options.cell = &cell->shown;
  preview::Scene scene = preview::scene_of(program, design ? &*design : nullptr, scene_options);
  if (!shown.reasons.empty()) preview::mark_refusal(scene, shown.reasons);
  return scene;
}

// The strip a film shows: the one asked for, or the only one.
const Strip& filmed_strip(const Program& program, const std::string& id) {
  for (const Strip& strip : program.strips) {
    if (strip.id == id || (id.empty() && program.strips.size() == 1)) return strip;
  }
  throw Error(ErrorKind::kBadSettings,
              id.empty() ? fmt::format("--movie: a film shows one strip ({} strips): give --strip",
                                       program.strips.size())
                         : fmt::format("--strip: no such strip ({}, {} to {})", id, program.strips.front().id,
                                       program.strips.back().id));
}

// What the window shows of the program or design, and the state that the keys of --keys lead to.
struct Viewed {
  std::unique_ptr<ShownCell> cell;  // the model refers to it
  preview::ViewModel model;
  preview::ViewState state;
};

preview::ViewState with_keys(const preview::ViewModel& model, preview::ViewState state,
                             const std::vector<std::string>& keys) {
  for (const std::string& key : keys) state = preview::after_key(state, model.facts, key);
  return state;
}

void film(const Program& program, const PreviewOptions& options, preview::PictureSize size,
          preview::View view, const Console& console) {
  const auto design = design_of(program, options);
  const auto cell = cell_of(program, options);
  preview::SceneOptions scene = options.scene;
  if (cell) scene.cell = &cell->shown;
  scene.strip = filmed_strip(program, options.scene.strip).id;
  const preview::ViewModel model = preview::view_model(program, design ? &*design : nullptr, scene);
  preview::ViewState state = preview::first_state(model, scene, view);
  state.hidden.set(static_cast<std::size_t>(preview::Layer::kGhosts));
  preview::MovieOptions movie;
  movie.size = size;
  movie.frames = options.frames;
  const auto report = [&](double share) {
    if (interrupted()) throw Error(ErrorKind::kInterrupted, "interrupted: no film was written");
    console.report_progress("film", share);
  };
  preview::drawing().write_movie(model, with_keys(model, state, options.keys), movie, options.movie,
                                 options.force, report);
  std::cout << options.movie << '\n';
}

void export_scene(const preview::Scene& scene, const PreviewOptions& options) {
  const fs::path file = options.exported;
  if (file.extension() == ".vtm") {
    preview::drawing().write_vtm(scene, file, options.force);
  } else {
    write_file_atomically(file, preview::drawing().drawn(scene)->gltf(), options.force);
  }
  std::cout << file.string() << '\n';
}

// Refused before any work: files in the way, and endings that no format has.
void check_outputs(const PreviewOptions& options) {
  const auto expect_ending = [](const std::string& option, const std::string& file,
                                std::initializer_list<const char*> endings) {
    std::string known;
    for (const char* ending : endings) {
      if (fs::path(file).extension() == ending) return;
      known += std::string(known.empty() ? "" : " or ") + ending;
    }
    throw Error(ErrorKind::kBadSettings,
                fmt::format("{}: unknown kind of file ({}): write {}", option, file, known));
  };
  if (!options.shot.empty()) expect_ending("--shot", options.shot, {".png"});
  if (!options.movie.empty()) expect_ending("--movie", options.movie, {".ogv"});
  if (!options.exported.empty()) expect_ending("--export", options.exported, {".gltf", ".vtm"});
  for (const std::string* file : {&options.shot, &options.movie, &options.exported}) {
    if (!file->empty()) expect_writable(*file, options.force);
  }
}

// The design where the file is one; options that go with a program are refused.
DesignSurface design_alone(const PreviewOptions& options) {
  const auto refuse = [](const char* option) {
    throw Error(ErrorKind::kBadSettings, fmt::format("{}: goes with a program, not with a design", option));
  };
  if (!options.design.empty()) refuse("--design");
  if (!options.color.empty()) refuse("--color");
  if (!options.scene.strip.empty()) refuse("--strip");
  if (options.scene.at_s) refuse("--at");
  if (!options.cell.empty()) refuse("--cell");
  if (options.scene.ghost_step_mm) refuse("--ghosts");
  if (!options.movie.empty()) refuse("--movie");
  const Settings settings = resolve_design(options.input);
  return read_design(options.input.file, settings.design);
}

bool is_program(const PreviewOptions& options) {
  const fs::path file = options.input.file;
  return file.extension() == ".json" || is_gzip_name(file);
}

// A program has its design's units and settings.
void refuse_design_options(const DesignOptions& input) {
  const auto refuse = [](const char* option) {
    throw Error(ErrorKind::kBadSettings, fmt::format("{}: goes with a design, not with a program", option));
  };
  if (!input.units.empty()) refuse("--units");
  if (!input.up.empty()) refuse("--up");
  if (!input.format.empty()) refuse("--format");
  if (!input.sources.files.empty()) refuse("--config");
  if (!input.sources.assignments.empty()) refuse("--set");
}

Viewed viewed(const PreviewOptions& options, preview::View view) {
  Viewed out;
  if (is_program(options)) {
    const Shown shown = read_shown(options.input.file);
    const Program& program = shown.program;
    if (program.strips.empty()) {
      out.model = preview::view_model(design_to_show(program, options));
    } else {
      const auto design = design_of(program, options);
      out.cell = cell_of(program, options);
      preview::SceneOptions scene = options.scene;
      if (out.cell) scene.cell = &out.cell->shown;
      out.model = preview::view_model(program, design ? &*design : nullptr, scene);
    }
    if (!shown.reasons.empty()) preview::mark_refusal(out.model.scene, shown.reasons);
  } else {
    out.model = preview::view_model(design_alone(options));
  }
  out.state = with_keys(out.model, preview::first_state(out.model, options.scene, view), options.keys);
  return out;
}

void shoot(const PreviewOptions& options, const preview::Scene& scene, preview::PictureSize size,
           preview::View view) {
  if (options.keys.empty()) {
    const std::vector<std::string> pngs =
        preview::drawing().drawn(scene)->pngs(size, std::array{preview::Shot{view}}, {});
    write_file_atomically(options.shot, pngs.front(), options.force);
  } else {
    const Viewed window = viewed(options, view);
    write_file_atomically(options.shot, preview::drawing().png_of(window.model, window.state, size),
                          options.force);
  }
  std::cout << options.shot << '\n';
}

Exit run_preview(PreviewOptions options, const Console& console) {
  const preview::PictureSize size = picture_size(options.size);
  const preview::View view = preview::view_named(options.view).value_or(preview::View::kBest);
  options.scene.color = color_of(options.color);
  if (is_program(options)) refuse_design_options(options.input);
  check_outputs(options);
  for (const std::string& key : options.keys) {
    if (!preview::is_key(key))
      throw Error(ErrorKind::kBadSettings, "--keys: unknown key (" + key + "): h in the window shows all");
  }
  if (options.shot.empty() && options.movie.empty() && options.exported.empty()) {
    preview::drawing().expect_display();
    const Viewed window = viewed(options, view);
    if (!window.state.closed) preview::drawing().show(window.model, window.state, size);
    return Exit::kOk;
  }
  if (!is_program(options)) {
    const preview::Scene scene = preview::scene_of(design_alone(options));
    if (!options.shot.empty()) shoot(options, scene, size, view);
    if (!options.exported.empty()) export_scene(scene, options);
    return Exit::kOk;
  }
  if (!options.shot.empty() || !options.exported.empty()) {
    const preview::Scene scene = program_scene(options);
    if (!options.shot.empty()) shoot(options, scene, size, view);
    if (!options.exported.empty()) export_scene(scene, options);
  }
  if (!options.movie.empty()) {
    const Program program = read_shown(options.input.file).program;
    if (program.strips.empty())
      throw Error(ErrorKind::kBadSettings, "--movie: nothing is cut: no strip to film");
    film(program, options, size, view, console);
  }
  return Exit::kOk;
}

}  // namespace

void add_preview(CLI::App& app, const Console& console, Action& action) {
  auto options = std::make_shared<PreviewOptions>();
  auto* command = app.add_subcommand("preview", "Show a program or a design, in a window or as a PNG file");
  add_design_options(*command, options->input);
  command->get_option("design")
      ->description("A program.json, a refused.json, or a design with --units")
      ->type_name("FILE");
  command->add_option("--design", options->design, "The design's file (default: beside the program)")
      ->type_name("FILE");
  command
      ->add_option("--cell", options->cell,
                   "The cell of a program with joints, to show its arms; else one that comes with hotblade")
      ->type_name("CELL");
  command
      ->add_option(
          "--arms", options->arms,
          "The arms of a program with joints: with margin, links by what joints have to their limits")
      ->check(CLI::IsMember({"on", "off", "margin"}))
      ->type_name("on|off|margin")
      ->capture_default_str();
  command->add_option("--at", options->scene.at_s, "Show the blade and the cut at this time of the strip")
      ->type_name("SECONDS");
  command->add_option("--strip", options->scene.strip, "Show this strip alone")->type_name("ID");
  command->add_option("--color", options->color, "What colours the cut surface; else deviation, or strip")
      ->check(CLI::IsMember({"deviation", "strip", "curvature", "margin", "feed"}))
      ->type_name("deviation|strip|curvature|margin|feed");
  command->add_option("--shot", options->shot, "Write a PNG file; needs no display")->type_name("FILE");
  command->add_option("--movie", options->movie, "Write a film of one strip (.ogv); needs no display")
      ->type_name("FILE");
  command->add_option("--frames", options->frames, "Frames of the film, 12 a second")
      ->check(CLI::Range(1, 10000));
  command->add_option("--export", options->exported, "Write the scene as glTF (.gltf) or for ParaView (.vtm)")
      ->type_name("FILE");
  command->add_option("--size", options->size, "Of picture or window, pixels")->type_name("WIDTHxHEIGHT");
  command->add_option("--view", options->view, "Where to look from; else obliquely on the cut side")
      ->check(CLI::IsMember({"best", "top", "front", "right"}))
      ->type_name("best|top|front|right");
  command
      ->add_option("--ghosts", options->scene.ghost_step_mm,
                   "Way between ghosts of the blade; else eight a strip")
      ->check(CLI::Range(1.0, 1e6))
      ->type_name("MM");
  command->add_option("--keys", options->keys, "Keys pressed in the window first, as in c,t,Tab")
      ->delimiter(',')
      ->type_name("KEY,...");
  command->add_flag("--force", options->force, "Overwrite an existing picture");
  command->footer(
      "In the window: space plays, h shows all keys, drag turns, a click picks, q closes.\n"
      "Example: hotblade preview vault_cut/program.json --design vault.obj --shot vault.png");
  command->callback([options, &console, &action] {
    action = [options, &console] { return run_preview(*options, console); };
  });
}

}  // namespace hotblade::pipeline
