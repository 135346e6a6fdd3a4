// Ways to lay planes and split a design evenly, fitted in the order of what they let one hope for.
#pragma once

#include <cstddef>
#include <vector>

#include "pipeline/plan/sweep/sweep_layout.hpp"

namespace hotblade::pipeline {

// The ways to split a design into so many even parts. Fits only those of them that it is asked for.
class SweepRanking {
 public:
  // `tried` is told of all ways, and what their fits come to; it outlives this.
  SweepRanking(const SweepLayouts& layouts, std::size_t parts, double tolerance_mm,
               std::vector<PlanesTried>& tried);

  // Fits the ways that promise the most, until a fit of theirs serves and no other promises to come nearer.
  void fit_best();
  void fit_all();
  [[nodiscard]] bool all_fitted() const { return next_ == ways_.size(); }

  // What is fitted, the best first.
  [[nodiscard]] const std::vector<Layout>& layouts() const { return layouts_fitted_; }

 private:
  struct Way {
    EvenSplit split;
    std::size_t told = 0;  // its place in tried_
  };
  void fit_next(std::size_t count);
  [[nodiscard]] bool found() const;

  const SweepLayouts& layouts_;
  double tolerance_mm_;
  std::vector<PlanesTried>& tried_;
  std::vector<Way> ways_;  // that fits are for
  std::size_t next_ = 0;   // the first of them that has none
  std::vector<Layout> layouts_fitted_;
};

}  // namespace hotblade::pipeline
