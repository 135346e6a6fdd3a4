// Brings a Bezier and an elastica into a frame of their own, for the kernels of
// elastica/kernels/curve_pair.h: the elastica starts at the origin, and a power of two scales everything into
// [-2, 2]. What follows from the frame is computed here, on the host, whatever answers: how finely to sample,
// and the careful search.
#pragma once

#include <Eigen/Core>
#include <array>

#include "elastica/kernels/hausdorff_search.hpp"
#include "gpu/curve/pair_distance.hpp"
#include "gpu/curve/pair_lanes.hpp"

namespace hotblade::gpu {

struct PairFrame {
  PairNumbers numbers{};
  double scale = 1;        // frame lengths per unit of the input, a power of two
  double omega = 0;        // sqrt(kappa_max^2 + |lambda|) of the elastica, per frame length
  double bezier_bend = 0;  // largest |B''|
  double tolerance = 0;    // frame lengths
  PairStatus status = PairStatus::kOk;
};

// Returns the pair's frame; its status is kInvalid or kTooTight, and the numbers are of no use, where
// pair_distance.hpp gives no answer.
[[nodiscard]] PairFrame pair_frame(const std::array<Eigen::Vector2d, 4>& bezier,
                                   const ElasticaState& elastica, double tolerance);

// Returns the number of panels in which L2 and H1 are integrated: kLeastPairPanels times a power of two.
[[nodiscard]] int pair_panels(const PairFrame& frame);

// Returns the number of samples that bound the Hausdorff distance within the tolerance where the curves
// follow each other: kLeastPairSamples times a power of two. Above kMostPairSamples only the search serves.
[[nodiscard]] int pair_samples(const PairFrame& frame);

// Returns bounds of the Hausdorff distance, in frame lengths, no wider than `tolerance` unless 20,000 samples
// do not suffice.
[[nodiscard]] elastica::hausdorff_search::HausdorffRange search_pair(const PairFrame& frame,
                                                                     double tolerance);

}  // namespace hotblade::gpu
