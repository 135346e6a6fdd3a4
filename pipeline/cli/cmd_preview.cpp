// hotblade preview: a picture of a program or a design, in a window or as a PNG file.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>

#include "pipeline/atomic_file.hpp"
#include "pipeline/cli/command.hpp"
#include "pipeline/cli/settings_options.hpp"
#include "pipeline/preview/draw.hpp"
#include "pipeline/program.hpp"

namespace hotblade::pipeline {
namespace {

namespace fs = std::filesystem;
using surface::DesignSurface;

struct PreviewOptions {
  DesignOptions input;  // the file may be a program as well
  std::string design;   // of a program; empty: the file beside it, if there is one
  std::string color;
  std::string shot;
  std::string size = "1280x720";
  std::string view = "best";
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
    throw CommandError(Exit::kUsage,
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
  DesignSurface design = surface::read_obj(file, {program.design.source_units, program.design.up});
  if (design.sha256 != program.design.sha256) {
    throw CommandError(
        Exit::kBadInput,
        fmt::format("{}: is not the design the program was made from (SHA-256 {}..., {}...)", file.string(),
                    design.sha256.substr(0, 12), program.design.sha256.substr(0, 12)));
  }
  return design;
}

preview::Scene program_scene(const PreviewOptions& options) {
  const Program program = read_program(options.input.file);
  const auto design = design_of(program, options);
  return preview::scene_of(program, design ? &*design : nullptr, options.scene);
}

preview::Scene design_scene(const PreviewOptions& options) {
  const auto refuse = [](const char* option) {
    throw CommandError(Exit::kUsage, fmt::format("{}: goes with a program, not with a design", option));
  };
  if (!options.design.empty()) refuse("--design");
  if (!options.color.empty()) refuse("--color");
  if (!options.scene.strip.empty()) refuse("--strip");
  if (options.scene.at_s) refuse("--at");
  const Settings settings = resolve_design(options.input);
  return preview::scene_of(
      surface::read_obj(options.input.file, {settings.design.units, settings.design.up.front()}));
}

Exit run_preview(PreviewOptions options) {
  const preview::PictureSize size = picture_size(options.size);
  const preview::View view = preview::view_named(options.view).value_or(preview::View::kBest);
  options.scene.color = color_of(options.color);
  if (options.shot.empty()) {
    preview::expect_display();
  } else {
    expect_writable(options.shot, options.force);
  }
  const bool is_program = fs::path(options.input.file).extension() == ".json";
  const preview::Scene scene = is_program ? program_scene(options) : design_scene(options);
  if (options.shot.empty()) {
    preview::show(scene, size, view);
    return Exit::kOk;
  }
  write_file_atomically(options.shot, preview::png_of(scene, size, view), options.force);
  std::cout << options.shot << '\n';
  return Exit::kOk;
}

}  // namespace

void add_preview(CLI::App& app, const Console&, Action& action) {
  auto options = std::make_shared<PreviewOptions>();
  auto* command = app.add_subcommand("preview", "Show a program or a design, in a window or as a PNG file");
  add_design_options(*command, options->input);
  command->get_option("design")->description("A program.json, or a design with --units")->type_name("FILE");
  command->add_option("--design", options->design, "The OBJ a program was made from; else the one beside it")
      ->type_name("FILE");
  command->add_option("--at", options->scene.at_s, "Show the blade and the cut at this time of the strip")
      ->type_name("SECONDS");
  command->add_option("--strip", options->scene.strip, "Show this strip alone")->type_name("ID");
  command->add_option("--color", options->color, "What colours the cut surface; else deviation, or strip")
      ->check(CLI::IsMember({"deviation", "strip", "curvature", "margin", "feed"}))
      ->type_name("deviation|strip|curvature|margin|feed");
  command->add_option("--shot", options->shot, "Write a PNG file; needs no display")->type_name("FILE");
  command->add_option("--size", options->size, "Of picture or window, pixels")->type_name("WIDTHxHEIGHT");
  command->add_option("--view", options->view, "Where to look from; else obliquely on the cut side")
      ->check(CLI::IsMember({"best", "top", "front", "right"}))
      ->type_name("best|top|front|right");
  command->add_flag("--force", options->force, "Overwrite an existing picture");
  command->footer(
      "In the window: drag turns, middle button moves, wheel zooms, q closes.\n"
      "Example: hotblade preview job/program.json --design vault.obj --shot vault.png");
  command->callback([options, &action] { action = [options] { return run_preview(*options); }; });
}

}  // namespace hotblade::pipeline
