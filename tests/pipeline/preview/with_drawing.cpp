// These tests draw by what they are linked with, not by the library that the program opens.
#include "pipeline/preview/drawing/vtk_drawing.hpp"

namespace {

[[maybe_unused]] const bool kGiven = [] {
  hotblade::pipeline::preview::draw_with(hotblade::pipeline::preview::vtk_drawing());
  return true;
}();

}  // namespace
