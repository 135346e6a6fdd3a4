#include "pipeline/preview/drawing.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <atomic>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "pipeline/program/version.hpp"
#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline::preview {
namespace {

constexpr const char* kLibrary = "libhotblade_drawing.so";

// Beside the program where it is built, in the folder of its libraries where it is installed. By its whole
// name: a sanitizer opens libraries in the program's place, and its run path is not the program's.
std::filesystem::path library() {
  std::error_code unknown;
  const std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path();
  const std::filesystem::path beside = folder / kLibrary;
  return std::filesystem::exists(beside, unknown) ? beside : folder / HOTBLADE_DRAWING_FOLDER / kLibrary;
}

std::atomic<const Drawing*> given = nullptr;

}  // namespace

const Drawing& drawing() {
  if (!given) {
    // Lazily: of VTK's functions few are called.
    if (dlopen(library().c_str(), RTLD_LAZY | RTLD_LOCAL) == nullptr) {
      const char* why = dlerror();
      throw Error(ErrorKind::kDrawing,
                  fmt::format("picture: what draws cannot be opened ({}): it is installed with the program",
                              why != nullptr ? why : kLibrary));
    }
    if (!given)
      throw Error(ErrorKind::kDrawing,
                  fmt::format("picture: {} does not draw: another has its place, the program's own is "
                              "installed with it",
                              kLibrary));
  }
  const Drawing& drawing = *given;
  if (std::string_view(drawing.version()) != version()) {
    throw Error(
        ErrorKind::kDrawing,
        fmt::format("picture: {} is of version {}, the program of version {}: install both from one package",
                    kLibrary, drawing.version(), version()));
  }
  return drawing;
}

void draw_with(const Drawing& drawing) {
  given = &drawing;
}

void load_driver() {
  try {
    drawing().load_driver();
  } catch (const Error&) {
    return;
  }
}

}  // namespace hotblade::pipeline::preview
