// The library of what draws: it gives itself to the program that opens it, or that is linked with it.
#include "pipeline/preview/drawing/vtk_drawing.hpp"

namespace {

[[maybe_unused]] const bool kGiven = [] {
  hotblade::pipeline::preview::draw_with(hotblade::pipeline::preview::vtk_drawing());
  return true;
}();

}  // namespace
