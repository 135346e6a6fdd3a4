#include "pipeline/calibrate/estimate.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

#include "pipeline/calibrate/registration.hpp"
#include "pipeline/settings/error.hpp"

namespace hotblade::pipeline {

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Mixed = Eigen::Matrix<double, kCellErrors, 6>;

constexpr auto kSlowingIndex = static_cast<std::size_t>(CellError::kSlowing);

// Steps of the differences: small against what the numbers are off by, large against the 1e-9 of the
// equilibria.
double difference_step(std::size_t error) {
  constexpr double kShare = 0.05;
  return kShare * info_of(error).expected;
}

// How the vertices of a cut move with each of the numbers, near some of them.
struct CutMoves {
  ErrorVector at = ErrorVector::Zero();
  std::vector<std::vector<Eigen::Vector3d>> moves;  // by number; empty where one was not asked for

  CutMoves(const StripScan& scan, const ErrorVector& errors, const ErrorVector& expected)
      : at(errors), moves(kCellErrors) {
    tbb::parallel_for(std::size_t{0}, kCellErrors, [&](std::size_t k) {
      const auto i = static_cast<Eigen::Index>(k);
      if (!(expected[i] > 0)) return;
      const double step = difference_step(k);
      ErrorVector more = errors, less = errors;
      more[i] += step;
      // The band's slowing has an end at 0: there, one side tells.
      if (k != kSlowingIndex || errors[i] >= step) less[i] -= step;
      const SweptSurface up = cut_with(scan.program, more, scan.sample_mm),
                         down = cut_with(scan.program, less, scan.sample_mm);
      moves[k].resize(up.vertices.size());
      for (std::size_t v = 0; v < up.vertices.size(); ++v)
        moves[k][v] = (up.vertices[v] - down.vertices[v]) / (more[i] - less[i]);
    });
  }

  // By how much the surface rises under a point with each of the numbers.
  [[nodiscard]] ErrorVector rise(const Foot& foot) const {
    ErrorVector rise = ErrorVector::Zero();
    for (std::size_t k = 0; k < kCellErrors; ++k) {
      if (moves[k].empty()) continue;
      Eigen::Vector3d move = Eigen::Vector3d::Zero();
      for (std::size_t c = 0; c < 3; ++c)
        move += foot.weights[c] * moves[k][static_cast<std::size_t>(foot.corners[c])];
      rise[static_cast<Eigen::Index>(k)] = foot.normal.dot(move);
    }
    return rise;
  }
};

// A point with a say.
struct Row {
  std::size_t point = 0;           // of its scan
  Eigen::Vector3d place{0, 0, 0};  // design frame
  double height_mm = 0, weight = 0;
  ErrorVector rise = ErrorVector::Zero();
  Vector6 drift = Vector6::Zero();  // of the height with the scan's own motion
};

struct Rows {
  std::vector<Row> rows;
  Eigen::Vector3d centre{0, 0, 0};
  std::size_t far = 0, beside = 0;
};

double median_of(std::vector<double> values) {
  const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), half, values.end());
  return *half;
}

// Of a normal distribution the middle distance from 0, times this, is the standard deviation.
constexpr double kSdOfMedian = 1.4826;
// What a better scanner sees of a cut is how its model errs, its facets and derivatives, which the steps
// would take for clamps: of 0.02 mm numbers came out up to 9 standard deviations off, and of 0.05 within 3.
constexpr double kLeastNoiseMm = 0.05;

double noise_of(const std::vector<Rows>& all) {
  std::vector<double> sizes;
  for (const Rows& scan : all)
    for (const Row& row : scan.rows) sizes.push_back(std::abs(row.height_mm));
  return sizes.empty() ? 0 : std::max(kLeastNoiseMm, kSdOfMedian * median_of(std::move(sizes)));
}

// A point has a say that lies on the cut and not far off, or, where says are given, that has one. Without
// moves nothing rises: the cut stands as it is.
Rows rows_of(const CutMesh& cut, const CutMoves* moves, const StripScan& scan, const Eigen::Isometry3d& place,
             double reach_mm, const std::vector<double>* says) {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3d& p : scan.points) points.push_back(place * p);
  const std::vector<Foot> feet = cut.feet(points);
  Rows out;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (says ? !((*says)[i] > 0) : feet[i].beside) {
      ++out.beside;
    } else if (!says && std::abs(feet[i].height_mm) > reach_mm) {
      ++out.far;
    } else {
      out.rows.push_back({i, points[i], feet[i].height_mm, says ? (*says)[i] : 1,
                          moves ? moves->rise(feet[i]) : ErrorVector::Zero(), Vector6::Zero()});
      out.rows.back().drift.tail<3>() = feet[i].normal;
      out.centre += points[i];
    }
  }
  if (!out.rows.empty()) out.centre /= static_cast<double>(out.rows.size());
  for (Row& row : out.rows) row.drift.head<3>() = (row.place - out.centre).cross(row.drift.tail<3>());
  return out;
}

void weigh(std::vector<Rows>& all, double noise_mm) {
  for (Rows& scan : all) {
    for (Row& row : scan.rows) {
      const double u = row.height_mm / (kTukey * noise_mm);
      row.weight = std::abs(u) < 1 ? (1 - u * u) * (1 - u * u) : 0;
    }
  }
}

// The normal equations, over the noise's square.
struct Information {
  ErrorMatrix errors = ErrorMatrix::Zero();
  ErrorVector right = ErrorVector::Zero();
  std::vector<Mixed> mixed;
  std::vector<Matrix6> places;
  std::vector<Vector6> place_right;

  Information(const std::vector<Rows>& all, double noise_mm) {
    for (const Rows& scan : all) {
      Mixed mix = Mixed::Zero();
      Matrix6 place = Matrix6::Zero();
      Vector6 place_side = Vector6::Zero();
      for (const Row& row : scan.rows) {
        const double w = row.weight / (noise_mm * noise_mm);
        errors += w * row.rise * row.rise.transpose();
        right += w * row.height_mm * row.rise;
        // A rise of the surface lowers the height, a drift of the scan adds to it.
        mix -= w * row.rise * row.drift.transpose();
        place += w * row.drift * row.drift.transpose();
        place_side -= w * row.height_mm * row.drift;
      }
      // What nothing holds - a flat cut along itself - is held weakly: a metre, a radian.
      constexpr double kWideMm = 1000;
      place.diagonal().head<3>().array() += 1;
      place.diagonal().tail<3>().array() += 1 / (kWideMm * kWideMm);
      mixed.push_back(mix);
      places.push_back(place);
      place_right.push_back(place_side);
    }
  }

  // Leaves the scans' places out: what the points say of the numbers whatever the places are.
  void eliminate_places() {
    for (std::size_t s = 0; s < places.size(); ++s) {
      const auto solver = places[s].ldlt();
      const Eigen::Matrix<double, 6, kCellErrors> by = solver.solve(mixed[s].transpose());
      errors -= mixed[s] * by;
      right -= by.transpose() * place_right[s];
    }
    errors = 0.5 * (errors + errors.transpose()).eval();
  }
};

// So many neighbouring points say as much as one: what is left of the model's own errors is alike in a patch,
// and there the mean does not fall as the root of the count. The largest over sizes of patches, 1 for plain
// noise.
double correlation_of(const std::vector<Rows>& all) {
  constexpr std::size_t kLeastPatches = 20;
  double most = 1;
  for (const double size_mm : {10.0, 20.0, 40.0, 80.0}) {
    std::map<std::tuple<std::size_t, long, long, long>, std::pair<double, double>>
        patches;  // sum, and of squares
    for (std::size_t s = 0; s < all.size(); ++s) {
      for (const Row& row : all[s].rows) {
        const auto cell = [&](int k) { return std::lround(row.place[k] / size_mm); };
        auto& [sum, squares] = patches[{s, cell(0), cell(1), cell(2)}];
        const double r = row.weight * row.height_mm;
        sum += r;
        squares += r * r;
      }
    }
    double of_sums = 0, of_points = 0;
    for (const auto& [place, patch] : patches) {
      of_sums += patch.first * patch.first;
      of_points += patch.second;
    }
    if (patches.size() >= kLeastPatches && of_points > 0) most = std::max(most, of_sums / of_points);
  }
  return most;
}

Misfit misfit_of(const std::vector<Rows>& all, double reach_mm) {
  std::vector<double> sizes;
  for (const Rows& scan : all) {
    for (const Row& row : scan.rows)
      if (std::abs(row.height_mm) <= reach_mm) sizes.push_back(std::abs(row.height_mm));
  }
  Misfit misfit;
  if (sizes.empty()) return misfit;
  double squares = 0;
  for (const double h : sizes) squares += h * h;
  misfit.rms_mm = std::sqrt(squares / static_cast<double>(sizes.size()));
  std::sort(sizes.begin(), sizes.end());
  misfit.p95_mm = sizes[static_cast<std::size_t>(0.95 * static_cast<double>(sizes.size() - 1))];
  misfit.max_mm = sizes.back();
  return misfit;
}

// Which blends the scan tells: eigenvectors of what it says, in units of what is expected.
void find_blends(const ErrorMatrix& told, Estimate& out) {
  // A blend is told where the scan leaves half of what was expected at most.
  constexpr double kTold = 3, kLeastShare = 0.3;
  const ErrorMatrix scaled = out.expected.asDiagonal() * told * out.expected.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<ErrorMatrix> solver(scaled);
  for (Eigen::Index k = 0; k < static_cast<Eigen::Index>(kCellErrors); ++k) {
    const double eigenvalue = std::max(0.0, solver.eigenvalues()[k]);
    if (eigenvalue >= kTold) {
      ++out.told;
      continue;
    }
    Blend blend;
    blend.left = 1 / std::sqrt(1 + eigenvalue);
    for (std::size_t i = 0; i < kCellErrors; ++i) {
      const double share = solver.eigenvectors()(static_cast<Eigen::Index>(i), k);
      if (std::abs(share) >= kLeastShare && out.expected[static_cast<Eigen::Index>(i)] > 0)
        blend.parts.push_back({i, share});
    }
    if (blend.parts.empty()) continue;  // of numbers that were not asked for
    std::stable_sort(blend.parts.begin(), blend.parts.end(),
                     [](const auto& p, const auto& q) { return std::abs(p.share) > std::abs(q.share); });
    // An eigenvector has no sign of its own.
    if (blend.parts.front().share < 0)
      for (Blend::Part& part : blend.parts) part.share = -part.share;
    out.untold.push_back(std::move(blend));
  }
}

class Estimator {
 public:
  Estimator(const std::vector<StripScan>& scans, const EstimateOptions& options)
      : scans_(scans), options_(options), moves_(scans.size()) {
    out_.planned = out_.value = planned_errors(scans.front().program);
    for (std::size_t i = 0; i < kCellErrors; ++i)
      out_.expected[static_cast<Eigen::Index>(i)] = info_of(i).expected;
    if (BandModel(scans.front().program).tabled()) leave_out(kSlowingIndex);
    for (const StripScan& scan : scans) {
      out_.scan_to_design.push_back(scan.scan_to_design);
      out_.points += scan.points.size();
    }
  }

  Estimate run() {
    register_only();
    iterate();
    const bool asked = out_.expected[static_cast<Eigen::Index>(kSlowingIndex)] > 0;
    // One band was planned with, and the scan does not tell how it would depend on the speed: then it does
    // not.
    if (asked && !BandModel(scans_.front().program).nominal.melt.by_speed() && !slowing_told()) {
      leave_out(kSlowingIndex);
      iterate();
    }
    conclude();
    return std::move(out_);
  }

 private:
  void leave_out(std::size_t error) {
    const auto i = static_cast<Eigen::Index>(error);
    out_.expected[i] = 0;
    out_.value[i] = out_.planned[i];
    for (std::optional<CutMoves>& moves : moves_)
      if (moves) moves->moves[error].clear();
  }

  // From here on every point keeps the say that it has: points that come and go at the edges of a cut that
  // slides under them would never let it rest.
  void keep_says() {
    for (std::size_t s = 0; s < scans_.size(); ++s) {
      says_.emplace_back(scans_[s].points.size(), 0.0);
      for (const Row& row : all_[s].rows) says_[s][row.point] = row.weight;
    }
  }

  // The moves of a cut, found anew where the numbers have gone a part of what they are expected to be off by:
  // each number's take two cuts, and change slowly.
  const CutMoves* moves_near(std::size_t s) {
    constexpr double kStale = 0.3;
    if (!(out_.expected.maxCoeff() > 0)) return nullptr;
    double gone = 0;
    for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(kCellErrors) && moves_[s]; ++i)
      if (out_.expected[i] > 0)
        gone = std::max(gone, std::abs(out_.value[i] - moves_[s]->at[i]) / out_.expected[i]);
    if (!moves_[s] || gone > kStale) moves_[s].emplace(scans_[s], out_.value, out_.expected);
    return &*moves_[s];
  }

  void look(double reach_mm) {
    all_.clear();
    if (says_.empty()) out_.far = out_.beside = 0;
    for (std::size_t s = 0; s < scans_.size(); ++s) {
      const CutMesh cut(cut_with(scans_[s].program, out_.value, scans_[s].sample_mm));
      all_.push_back(rows_of(cut, moves_near(s), scans_[s], out_.scan_to_design[s], reach_mm,
                             says_.empty() ? nullptr : &says_[s]));
      if (!says_.empty()) continue;
      out_.far += all_.back().far;
      out_.beside += all_.back().beside;
    }
    if (!says_.empty()) return;
    out_.used = 0;
    for (const Rows& scan : all_) out_.used += scan.rows.size();
    constexpr std::size_t kLeastPoints = 100;
    if (out_.used < kLeastPoints)
      throw Error(
          ErrorKind::kBadInput,
          fmt::format("too few points of the scan lie on the cut ({} of {}, at least {}): is it a scan of "
                      "this strip, in the unit that --units says?",
                      out_.used, out_.points, kLeastPoints));
    out_.noise_mm = noise_of(all_);
    weigh(all_, out_.noise_mm);
  }

  void move_place(std::size_t s, const Vector6& step) {
    out_.scan_to_design[s] = step_about(all_[s].centre, step) * out_.scan_to_design[s];
  }

  // No step moves a scan farther: points come and go at the cut's edges, and derivatives hold nearby.
  static constexpr double kLongestMm = 3;

  // How far a step moves a scan's points, about.
  [[nodiscard]] double moved_mm(std::size_t s, const Vector6& step) const {
    double most = 1e-12;
    for (const Row& row : all_[s].rows)
      most = std::max(most, (step.head<3>().cross(row.place - all_[s].centre) + step.tail<3>()).norm());
    return most;
  }

  // What a step is held back by where the surface lets the scan slide (Levenberg and Marquardt): it changes
  // no answer.
  [[nodiscard]] static Matrix6 held(const Matrix6& place, double back) {
    constexpr double kSlideMm = 5, kSlideRad = 0.02;
    Matrix6 held = place;
    held.diagonal().head<3>().array() += back / (kSlideRad * kSlideRad);
    held.diagonal().tail<3>().array() += back / (kSlideMm * kSlideMm);
    return held;
  }

  // The scans drawn to the cut as planned: what their heights are worth before anything is estimated.
  void register_only() {
    const ErrorVector expected = out_.expected;
    out_.expected.setZero();
    constexpr int kRounds = 10;
    for (int round = 0; round < kRounds; ++round) {
      look(kFarMm);
      if (options_.fixed) break;
      const Information info(all_, out_.noise_mm);
      double most = 0;
      for (std::size_t s = 0; s < scans_.size(); ++s) {
        const Vector6 step = held(info.places[s], 1).ldlt().solve(info.place_right[s]);
        const double moved = moved_mm(s, step);
        move_place(s, std::min(1.0, kLongestMm / moved) * step);
        most = std::max(most, moved);
      }
      constexpr double kStillMm = 1e-3;
      if (most < kStillMm) break;
    }
    out_.before = misfit_of(all_, reach());
    out_.expected = expected;
  }

  [[nodiscard]] double reach() const {
    constexpr double kNoises = 4.685;
    return kNoises * out_.noise_mm;
  }

  // What the points say of the numbers, the scans' places left out.
  [[nodiscard]] Information told() const {
    Information info(all_, out_.noise_mm);
    if (!options_.fixed) info.eliminate_places();
    return info;
  }

  [[nodiscard]] ErrorMatrix prior() const {
    ErrorMatrix prior = ErrorMatrix::Zero();
    for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(kCellErrors); ++i) {
      // A number that is not asked for is held where it is.
      constexpr double kHeld = 1e12;
      prior(i, i) = out_.expected[i] > 0 ? 1 / (out_.expected[i] * out_.expected[i]) : kHeld;
    }
    return prior;
  }

  // Until no number moves by a hundredth of what it is expected to be off by. Points are looked at from far
  // off first: the cut may be millimetres off.
  void iterate() {
    constexpr double kStill = 0.01, kLessBack = 0.5;
    double back = 1, noise_before_mm = 1e9;
    says_.clear();
    for (int round = 0; round < options_.most_rounds; ++round) {
      look(kFarMm);
      ++out_.rounds;
      Information all(all_, out_.noise_mm);
      for (Matrix6& place : all.places) place = held(place, back);
      back *= kLessBack;
      Information info = all;
      if (!options_.fixed) info.eliminate_places();
      const ErrorMatrix hold = prior();
      ErrorVector step = (info.errors + hold).ldlt().solve(info.right - hold * (out_.value - out_.planned));
      // Slowing ends at 0, and no band is narrower than the blade.
      const auto end_at = [&](std::size_t error, double least) {
        const auto i = static_cast<Eigen::Index>(error);
        step[i] = std::max(step[i], std::min(0.0, least - out_.value[i]));
      };
      end_at(kSlowingIndex, 0);
      end_at(static_cast<std::size_t>(CellError::kBand), scans_.front().program.blade.thickness_mm);
      double most = 0;
      for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(kCellErrors); ++i)
        if (out_.expected[i] > 0) most = std::max(most, std::abs(step[i]) / out_.expected[i]);
      constexpr double kLongest = 2;
      std::vector<Vector6> drifts;
      double share = std::min(1.0, kLongest / most);
      for (std::size_t s = 0; s < scans_.size() && !options_.fixed; ++s) {
        drifts.push_back(all.places[s].ldlt().solve(all.place_right[s] - all.mixed[s].transpose() * step));
        share = std::min(share, kLongestMm / moved_mm(s, drifts.back()));
      }
      step *= share;
      out_.value += step;
      for (std::size_t s = 0; s < drifts.size(); ++s) move_place(s, share * drifts[s]);
      if (most < kStill && !says_.empty()) break;
      // The heights are down to noise: now the points may keep their says.
      constexpr double kSettled = 0.98;
      constexpr int kLatest = 18;
      if (says_.empty() && (out_.noise_mm > kSettled * noise_before_mm || round == kLatest)) keep_says();
      noise_before_mm = out_.noise_mm;
    }
  }

  [[nodiscard]] ErrorMatrix covariance(double correlation) const {
    return (told().errors / correlation + prior()).inverse();
  }

  [[nodiscard]] bool slowing_told() const {
    const auto i = static_cast<Eigen::Index>(kSlowingIndex);
    return std::sqrt(covariance(correlation_of(all_))(i, i)) <= 0.5 * out_.expected[i];
  }

  void conclude() {
    says_.clear();
    for (std::optional<CutMoves>& moves : moves_) moves.reset();
    look(kFarMm);
    out_.after = misfit_of(all_, reach());
    out_.correlation = correlation_of(all_);
    out_.covariance = covariance(out_.correlation);
    find_blends(told().errors / out_.correlation, out_);
  }

  const std::vector<StripScan>& scans_;
  EstimateOptions options_;
  std::vector<std::optional<CutMoves>> moves_;  // by scan
  std::vector<Rows> all_;
  std::vector<std::vector<double>> says_;  // by scan and point, once they are kept
  Estimate out_;
};

}  // namespace

double Estimate::sd(std::size_t error) const {
  const auto i = static_cast<Eigen::Index>(error);
  return expected[i] > 0 ? std::sqrt(std::max(0.0, covariance(i, i))) : 0;
}

bool Estimate::told_alone(std::size_t error) const {
  const double before_mm = expected[static_cast<Eigen::Index>(error)];
  return before_mm > 0 && sd(error) <= 0.5 * before_mm;
}

std::string Blend::describe() const {
  std::string text;
  for (const Part& part : parts) {
    const CellErrorInfo& info = info_of(part.error);
    if (text.empty()) {
      text = std::string(info.words);
    } else {
      text += fmt::format(" {} {}", part.share > 0 ? "with" : "against", info.words);
    }
  }
  return text;
}

Estimate estimate(const std::vector<StripScan>& scans, const EstimateOptions& options) {
  return Estimator(scans, options).run();
}

}  // namespace hotblade::pipeline
