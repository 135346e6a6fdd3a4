// Planes turned as their fits ask for.
#pragma once

#include "pipeline/plan/sweep/sweep_layout.hpp"

namespace hotblade::pipeline {

class PlaneTurning {
 public:
  // Both outlive this.
  PlaneTurning(const SweepLayouts& layouts, const Settings& settings)
      : layouts_(layouts), settings_(settings) {}

  // Returns a closer fit of a layout, turned on where it does not serve.
  [[nodiscard]] Layout turned(const Layout& from) const;

  // Returns a layout with its planes turned as Gauss and Newton would, as long as that helps. A direction
  // serves all parts alike: of many, none is worth the fits of all others.
  [[nodiscard]] Layout turned_on(Layout best) const;

 private:
  const SweepLayouts& layouts_;
  const Settings& settings_;
};

}  // namespace hotblade::pipeline
