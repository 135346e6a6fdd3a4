#include "pipeline/study/study.hpp"

namespace hotblade::pipeline::study {

std::span<const Study> studies() {
  static constexpr Study kStudies[] = {
      {"projection", "Projections of random cubics towards elastica: feedback, optimal and brute force",
       study_projection},
      {"zone", "The zone of cubics close to elastica: its residuals, and its distance to true elastica",
       study_zone},
      {"quadratic",
       "Quadratic Beziers: length and energy against quadrature, tangent curves against sampling",
       study_quadratic},
      {"arcs", "Elastica as circular arcs of the same length: how many, how near; spirals, ovals",
       study_arcs},
  };
  return kStudies;
}

}  // namespace hotblade::pipeline::study
