#include "pipeline/preview/shot.hpp"

#include <array>
#include <utility>

namespace hotblade::pipeline::preview {

std::optional<View> view_named(const std::string& name) {
  constexpr std::array<std::pair<View, const char*>, 4> kViews{
      {{View::kBest, "best"}, {View::kTop, "top"}, {View::kFront, "front"}, {View::kRight, "right"}}};
  for (const auto& [view, one] : kViews) {
    if (one == name) return view;
  }
  return std::nullopt;
}

}  // namespace hotblade::pipeline::preview
