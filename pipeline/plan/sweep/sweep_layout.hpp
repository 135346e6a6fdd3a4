// Ways to part a design into strips of one family of planes each, with a fit of every part.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "pipeline/plan/sweep/sweep_cost.hpp"
#include "pipeline/plan/sweep/sweep_facets.hpp"
#include "pipeline/plan/sweep/sweep_part.hpp"

namespace hotblade::pipeline {

// A plan takes a third of a second for each: by then a wrong unit is likelier than a job.
inline constexpr std::size_t kMostStrips = 2000;

// Rows and columns of parts.
struct SweepGrid {
  std::size_t along_sweep = 1, along_ribs = 1;
  [[nodiscard]] std::size_t count() const { return along_sweep * along_ribs; }
};

struct FittedPart {
  SweepPart part;
  PartFit fit;
};

// Planes as they were ranked.
struct PlanesTried {
  surface::PlaneFamily planes;
  std::size_t along_sweep = 1, along_ribs = 1;  // parts
  double missed_mm = 0;                         // by elastica, as the Beziers of the sections say
  std::optional<double> fit_mm{};  // of cheap fits of all parts; none: not fitted, or a part has no fit
  // Of planes that were ranked by rows of blocks: the blocks that the design fills if none is wasted at its
  // border, and the strips that the rows take, 0 where these were not laid. No blocks: it is not of rows.
  double blocks = 0;
  std::size_t strips_in_rows = 0;
  [[nodiscard]] bool of_rows() const { return blocks > 0; }
};

// Planes for the whole design and a way to split it evenly.
struct EvenSplit {
  surface::PlaneFamily planes;
  std::size_t family = 0;  // number of these planes among a layout's
  std::size_t named = 0;   // place among all splits into as many parts
  SweepGrid grid = {};
  double missed_mm = 0;  // by elastica, as the Beziers of the sections say (section_beziers.hpp)
};

// Tells whether a part's planes turn so far that its blades hang by more than this, which no closer fit
// mends.
[[nodiscard]] bool hangs_too_far(const SweepPart& part, const PartFit& fit, double most_mm);

struct Layout {
  surface::PlaneFamily planes;
  std::size_t named = 0;  // place among the layouts: decides between equals
  SweepGrid grid;
  std::vector<SweepPart> parts = {};
  std::vector<PartFit> fits = {};
  double cost_mm = 0;   // of the worst part
  bool turned = false;  // its planes were turned for as long as it helped

  void add(FittedPart part);
};

// Returns by how many rad about x and y of the whole's axes the planes should turn, as far as the terms of
// the parts' fits say; zero where no fit says.
[[nodiscard]] Eigen::Vector2d turn_of(const Layout& layout, double most_rad);

// Returns, of the parts of a layout that have a fit and over whose facets a smooth surface is off by more
// than the tolerance, the numbers of those that leave the most, at most so many.
[[nodiscard]] std::vector<std::pair<std::size_t, FacetRise>> coarsest(const Layout& layout,
                                                                      double tolerance_mm, std::size_t most);

[[nodiscard]] bool layout_before(const Layout& a, const Layout& b);

class SweepLayouts {
 public:
  // Of the planes, those that little of the design is too steep for, or all where there are none.
  SweepLayouts(const surface::TriangleMesh& mesh, WasteSurface surface,
               std::vector<surface::PlaneFamily> planes, const Settings& settings, const PartFitter& fitter);

  // Axes of the whole design.
  [[nodiscard]] RibAxes axes(const surface::PlaneFamily& planes) const;

  // The fewest parts that blocks and blades allow, in any of these planes.
  [[nodiscard]] std::size_t fewest_parts() const;

  // The planes and the ways to split them into so many even parts, those first whose elastica miss least.
  [[nodiscard]] std::vector<EvenSplit> even_splits(std::size_t parts) const;

  // A design of many parts, in the planes whose rows take the fewest: rows of one depth, each cut into parts
  // of one arc length, with axes of their own.
  // Without any, and with the grid that they would be about, where that is more than are ever planned.
  // `tried` gets all planes that were weighed, the chosen ones first, then by the strips that their rows
  // take, then by the blocks that they fill at least.
  [[nodiscard]] Layout in_rows(std::vector<PlanesTried>& tried) const;

  // All parts of a grid fitted, from those of `start` where there are any.
  [[nodiscard]] Layout fitted(const surface::PlaneFamily& planes, std::size_t named, const SweepGrid& grid,
                              const SweepEffort& effort, const Layout* start = nullptr) const;

  // All parts of an even split, fitted cheaply.
  [[nodiscard]] Layout fitted(const EvenSplit& split) const;

  // A part as two, along the sweep or along the ribs, as they are followed best, each in other planes where
  // it is too steep for the part's or turns away in them; none where it is too small to be split, or where
  // that is not allowed. `why` it cannot stay as it is.
  [[nodiscard]] std::vector<FittedPart> halves(const SweepPart& part, const PartFit& fit,
                                               const std::optional<Refusal>& why) const;

 private:
  // The design's extents along the sweep and along the ribs.
  [[nodiscard]] Eigen::AlignedBox<double, 2> extent_of(const RibAxes& axes) const;
  [[nodiscard]] SweepGrid least_grid(const Eigen::AlignedBox<double, 2>& extent) const;
  // Whether any of the design lies behind the part's seams.
  [[nodiscard]] bool meets_design(const SweepPart& part) const;
  // The whole design in one family of planes.
  struct Whole {
    RibAxes axes;
    Eigen::AlignedBox<double, 2> box;
    SweepGrid least;  // of what blocks and blades hold
  };
  [[nodiscard]] Whole whole_in(const surface::PlaneFamily& planes) const;
  // Between y and the normals, in the planes: of 98 of a hundred vertices.
  [[nodiscard]] double turn_in(const RibAxes& axes) const;
  [[nodiscard]] std::vector<SweepPart> parts_of(const Whole& whole, const SweepGrid& grid) const;
  [[nodiscard]] Layout fitted(const Whole& whole, std::size_t named, const SweepGrid& grid,
                              const SweepEffort& effort, const Layout* start) const;
  [[nodiscard]] double blocks_in(const surface::PlaneFamily& planes) const;
  // Rows of blocks in one family of planes, their parts measured only.
  struct Rows {
    RibAxes axes;
    Eigen::AlignedBox<double, 2> box;
    std::vector<double> shares;  // of the box along the sweep
    std::vector<std::vector<FittedPart>> rows;
    std::vector<double> over;  // what of a row is too large for a block, times what that holds; 1: nothing
    std::size_t needs = 0;     // parts, those that are too large counted twice
    double blocks = 0;         // PlanesTried
    [[nodiscard]] double worst() const { return *std::max_element(over.begin(), over.end()); }
  };
  // As deep as blocks are, all alike.
  [[nodiscard]] Rows even_rows(const Whole& whole) const;
  // Rows of other depths where parts are too large for a block.
  void fit_rows(Rows& rows) const;
  // Rows that would be far more than kMostStrips parts are left without any, with how many they need.
  void lay(Rows& rows, std::vector<double> shares) const;
  [[nodiscard]] std::vector<std::vector<FittedPart>> rows_of(const RibAxes& axes,
                                                             const Eigen::AlignedBox<double, 2>& box,
                                                             const std::vector<double>& shares,
                                                             double most_mm) const;
  [[nodiscard]] std::vector<FittedPart> row_of(const SweepPart& row, double most_mm) const;
  // Ends of a row's pieces along x, each run of a section in them at most so long, and `more` pieces than
  // that asks for.
  [[nodiscard]] std::vector<std::pair<double, double>> pieces_of(const SweepPart& row, double most_mm,
                                                                 std::size_t more) const;
  [[nodiscard]] FittedPart in_best_planes(FittedPart part) const;
  // What of a surface lies behind these seams, which are those that it lies behind already and more.
  [[nodiscard]] SweepPart part_behind(const RibAxes& axes, std::vector<SweepSeam> seams,
                                      const std::shared_ptr<const WasteSurface>& within) const;
  void fit_parts(Layout& layout, const SweepEffort& effort, const Layout* start) const;

  const surface::TriangleMesh& mesh_;
  std::shared_ptr<const WasteSurface> surface_;
  SurfaceLean lean_;  // of it
  std::vector<surface::PlaneFamily> all_planes_, planes_;
  std::vector<Whole> whole_;  // in each of planes_
  const Settings& settings_;
  const PartFitter& fitter_;
};

}  // namespace hotblade::pipeline
