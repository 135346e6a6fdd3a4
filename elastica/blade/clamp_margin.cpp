#include "elastica/blade/clamp_margin.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include "elastica/blade/end_map.hpp"
#include "elastica/blade/fold_table.hpp"

namespace hotblade::elastica {

namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector4d;

// Everything below is for a blade of length 1. Unknowns q = (turn of clamp A, size, phase, force), the last
// three those of PressedBlade.
Vector2d turned(double angle, const Vector2d& v) {
  return Eigen::Rotation2Dd(angle) * v;
}

// Either clamp bears half of a change of the chord: its share of the squares is 1/2.
constexpr double kHalf = std::numbers::sqrt2 / 2;

// Sizes below which a shape is the straight blade, which is looked at by itself.
constexpr double kStraightSize = 1e-5;

PressedBlade pressed(const Vector4d& q) {
  return {q[1], q[2], q[3]};
}

// How much a change by one of each unknown is made for: about as much bending.
Vector4d units_at(const Vector4d& q) {
  return {1, 1, 1 / std::max(kStraightSize, std::abs(q[1])), kBendRate * kBendRate};
}

// (turn, kappa, force in A's axes) as numbers a change of which by one bends about as much: shapes are
// compared by them.
Vector4d bending(const Vector4d& q) {
  constexpr double kForce = 5;
  const Elastica e = pressed(q).elastica();
  return {q[0], e.kappa, e.lambda1 / kForce, e.lambda2 / kForce};
}

// What the unknowns make of the blade.
struct Place {
  Vector4d q = Vector4d::Zero();
  // The clamps' error as four numbers whose norm is its size: change of the chord, turns of A and B.
  Vector4d error = Vector4d::Zero();
  Matrix4d slope = Matrix4d::Zero();  // d error / d q
  double fold = 0;                    // fold_value()
  JacobiFields end;                   // with A's tangent along x
  [[nodiscard]] double squared() const { return error.squaredNorm(); }
};

// Of distance and fold at a place, by units of the unknowns there.
struct Slopes {
  Vector4d distance = Vector4d::Zero();  // of half the squared error
  Vector4d fold = Vector4d::Zero();
  Matrix4d bend = Matrix4d::Zero();  // second derivatives of half the squared error
};

class FoldSearch {
 public:
  FoldSearch(const Elastica& e, const ClampMarginOptions& options)
      : e_(e),
        weight_(options.mm_per_rad > 0 ? options.mm_per_rad / e.length : 0.5),
        largest_(options.largest_mm / e.length) {
    const PressedBlade blade = PressedBlade::of(e);
    const JacobiFields end = end_map(blade.elastica(), Exactness::kSearch);
    held_ = {e, end.index, 0, end};
    clamps_ = clamps_of(e);
    chord_ = end.point.position();
    turn_ = end.point.theta;
    stable_sign_ = end.fields.determinant() < 0 ? -1 : 1;
    // Of a shallow blade curvatures and forces square to its chord are as small as the root of what the chord
    // lacks.
    constexpr double kSame = 0.02;
    same_ = kSame * std::min(1.0, 2 * std::numbers::pi * std::sqrt(std::max(0.0, 1 - chord_.norm())));
  }

  // Starts from a fold of a neighbouring pose.
  void look_near(const Elastica& shape) {
    if (const auto place = seen(shape)) descend(*place);
  }

  // Starts from the shape itself, from every tabled fold that is nearer than those around it, and along the
  // edges.
  void look_everywhere() {
    // Folds of shapes that are pressed as much as folds are lie closer to them than tabled ones to each
    // other.
    constexpr double kPressed = 30;  // the least force of a fold is 4 pi^2
    const auto own = seen(e_);
    if (own && own->q[3] > kPressed) descend(*own);
    look_in(FoldTable::shallow(), false);
    for (const FoldEdge edge : {FoldEdge::kTangents, FoldEdge::kCurvatures})
      for (const double side : {1.0, -1.0}) look_along(FoldTable::shallow().edge(edge), edge, side);
    // Either clamp takes half of what the chords differ by.
    if (kHalf * (chord_.norm() - FoldTable::kLongestDeepChord) < largest_) look_in(FoldTable::deep(), true);
  }

  // Whether the shape can be led to a minimum along a straight way.
  bool leads_to_a_fold() {
    // A shape lost on the way to a minimum shows another one, which is looked at in turn.
    constexpr std::size_t kMost = 16;
    for (; looked_at_ < std::min(kMost, minima_.size()); ++looked_at_) {
      const auto next = minima_.begin() + static_cast<std::ptrdiff_t>(looked_at_);
      std::iter_swap(next, std::min_element(next, minima_.end(), [](const Place& a, const Place& b) {
                       return a.squared() < b.squared();
                     }));
      const Place minimum = *next;
      if (reached(minimum)) reached_.push_back(minimum);
    }
    return !reached_.empty();
  }

  // Those minima, the nearest first.
  [[nodiscard]] std::vector<Fold> folds() {
    leads_to_a_fold();
    std::vector<Fold> folds;
    for (const Place& p : reached_) {
      // By ends exact to rounding.
      const Elastica shape = shape_of(p);
      folds.push_back({clamp_distance(clamps_, clamps_of(shape), weight_ * e_.length), shape});
    }
    std::sort(folds.begin(), folds.end(),
              [](const Fold& a, const Fold& b) { return a.distance_mm < b.distance_mm; });
    constexpr std::size_t kKept = 3;  // enough for those that change places between poses
    folds.resize(std::min(kKept, folds.size()));
    return folds;
  }

 private:
  // The nearest pair of clamps of a fold's shape, or of the mirrored one.
  struct Turned {
    Vector4d q = Vector4d::Zero();
    double squared = 0;  // the distance
  };
  [[nodiscard]] Turned nearest(const TabledFold& fold, double side) const {
    const Vector2d c(fold.end.x, side * fold.end.y);
    const double more = side * fold.end.theta - turn_, w2 = weight_ * weight_;
    // Newton's method for the turn between them.
    constexpr int kSteps = 2;
    double by = -0.5 * more;
    Vector2d r = turned(by, c);
    for (int i = 0; i < kSteps; ++i) {
      const double slope = 0.5 * (chord_.x() * r.y() - chord_.y() * r.x()) + w2 * (2 * by + more);
      by -= slope / (0.5 * std::max(0.0, chord_.dot(r)) + 2 * w2);
      r = turned(by, c);
    }
    const double squared = 0.5 * (chord_ - r).squaredNorm() + w2 * (by * by + (by + more) * (by + more));
    return {{by, side * fold.blade.size, fold.blade.phase, fold.blade.force}, squared};
  }

  void look_in(const FoldTable& table, bool deep) {
    const int columns = 2 * table.phases();  // the second half mirrored
    // Those that no start lies near are left out: by their tangents, and by their chords alone.
    std::vector<Turned> all;
    std::vector<std::size_t> first;  // of each cell, and the end
    first.reserve(static_cast<std::size_t>(table.sizes()) * static_cast<std::size_t>(columns) + 1);
    for (int i = 0; i < table.sizes(); ++i) {
      for (int j = 0; j < columns; ++j) {
        first.push_back(all.size());
        for (const TabledFold& fold : table.at(i, j % table.phases()))
          if (may_be_near(fold, side_of(table, j))) all.push_back(nearest(fold, side_of(table, j)));
      }
    }
    first.push_back(all.size());
    const auto cell = [&](int i, int j) {
      const auto k =
          static_cast<std::size_t>(i) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(j);
      return std::span<const Turned>(all).subspan(first[k], first[k + 1] - first[k]);
    };
    const auto least = [&](const Turned& here, int i, int j) {
      for (int k = std::max(0, i - 1); k <= std::min(table.sizes() - 1, i + 1); ++k) {
        for (const int l : {j + columns - 1, j, j + 1}) {
          for (const Turned& other : cell(k, l % columns)) {
            constexpr double kBeside = 0.3;  // of the force, for the same sheet of folds
            if (other.squared < here.squared && std::abs(other.q[3] - here.q[3]) < kBeside * here.q[3])
              return false;
          }
        }
      }
      return true;
    };
    // Of the deep ones, whose sheets lie too close to be told apart, the nearest of all.
    constexpr std::size_t kMostDeep = 16;
    std::vector<Turned> starts;
    for (int i = 0; i < table.sizes(); ++i) {
      for (int j = 0; j < columns; ++j) {
        for (const Turned& here : cell(i, j)) {
          const double reach = reach_of(here.q[1]);
          if (here.squared <= reach * reach && (deep || least(here, i, j))) starts.push_back(here);
        }
      }
    }
    std::stable_sort(starts.begin(), starts.end(),
                     [](const Turned& a, const Turned& b) { return a.squared < b.squared; });
    if (deep && starts.size() > kMostDeep) starts.resize(kMostDeep);
    for (const Turned& start : starts) {
      if (const auto place = at(start.q)) descend(*place);
    }
  }

  [[nodiscard]] static double side_of(const FoldTable& table, int column) {
    return column < table.phases() ? 1 : -1;
  }

  // Half a cell away from a fold of this size there may be one this much nearer.
  [[nodiscard]] double reach_of(double size) const { return largest_ + kHalf * std::abs(size); }

  // By bounds of the distance that no turn of the pair lowers.
  [[nodiscard]] bool may_be_near(const TabledFold& fold, double side) const {
    const double reach = reach_of(fold.blade.size), more = side * fold.end.theta - turn_;
    const double chords = chord_.norm() - fold.end.position().norm();
    return 0.5 * (weight_ * weight_ * more * more + chords * chords) <= reach * reach;
  }

  // The nearest places of an edge: from those of its tabled sizes by parabolas through three.
  void look_along(std::span<const TabledFold> folds, FoldEdge edge, double side) {
    std::vector<Turned> all;
    for (const TabledFold& fold : folds) all.push_back(nearest(fold, side));
    for (std::size_t i = 1; i + 1 < all.size(); ++i) {
      if (all[i - 1].squared < all[i].squared || !(all[i].squared <= all[i + 1].squared)) continue;
      narrow(edge, side, all[i - 1], all[i], all[i + 1]);
    }
  }

  void narrow(FoldEdge edge, double side, Turned a, Turned b, Turned c) {
    constexpr int kMostSteps = 12;
    constexpr double kSame = 1e-5;  // of the size
    for (int i = 0; i < kMostSteps; ++i) {
      const double x = std::abs(a.q[1]), y = std::abs(b.q[1]), z = std::abs(c.q[1]);
      const double left = (b.squared - a.squared) / (y - x), right = (c.squared - b.squared) / (z - y);
      const double size = 0.5 * (x + y) - 0.5 * left * (z - x) / (right - left);
      if (!(size > x && size < z) || std::abs(size - y) < kSame * y) break;
      const auto fold = edge_at(edge, size, b.q[2], b.q[3]);
      if (!fold) break;
      const Turned next = nearest(*fold, side);
      if (next.squared < b.squared) {
        (size < y ? c : a) = b;
        b = next;
      } else {
        (size < y ? a : c) = next;
      }
    }
    constexpr double kMore = 1.5;  // than what is looked for, where folds aside are not nearer by as much
    if (b.squared > kMore * largest_ * largest_) return;
    const auto place = at(b.q);
    if (place && place->squared() < largest_ * largest_) keep(*place);
    // Aside of the edge a fold may be nearer.
    constexpr double kAside = 0.03;
    for (const double aside : {kAside, -kAside}) {
      const auto fold = fold_at(std::abs(b.q[1]), b.q[2] + aside, b.q[3]);
      if (!fold) continue;
      const Turned next = nearest(*fold, side);
      if (!(next.squared < b.squared)) continue;
      if (const auto start = at(next.q)) descend(*start);
    }
  }

  // Winds no more than a blade can.
  [[nodiscard]] static bool usable(const Vector4d& q) {
    constexpr double kLargestRate = 60;
    if (!q.allFinite() || !(q[3] > 0)) return false;
    const Elastica blade = pressed(q).elastica();
    return taylor_rate(0, blade.kappa, blade.lambda1, blade.lambda2) < kLargestRate;
  }

  // Nothing where the blade is taut, or not usable.
  [[nodiscard]] std::optional<Place> at(const Vector4d& q) const {
    if (!usable(q)) return {};
    const Elastica blade = pressed(q).elastica();
    const JacobiFields end = end_map(blade, Exactness::kSearch);
    const Vector2d c = end.point.position();
    if (blade.lambda1 * c.x() + blade.lambda2 * c.y() < -kLargestTension) return {};
    return placed(q, end);
  }

  [[nodiscard]] Place placed(const Vector4d& q, const JacobiFields& end) const {
    Place p;
    p.q = q;
    p.end = end;
    const Vector2d moved = turned(q[0], end.point.position());
    p.error << kHalf * (moved - chord_), weight_ * q[0], weight_ * (q[0] + end.point.theta - turn_);
    p.slope.block<2, 1>(0, 0) = kHalf * Vector2d(-moved.y(), moved.x());
    p.slope(2, 0) = p.slope(3, 0) = weight_;
    const Matrix3d fields = end.fields * pressed(q).slopes();
    for (Eigen::Index i = 0; i < 3; ++i) {
      p.slope.block<2, 1>(0, i + 1) = kHalf * turned(q[0], fields.block<2, 1>(0, i));
      p.slope(3, i + 1) = weight_ * fields(2, i);
    }
    p.fold = fold_value(end);
    return p;
  }

  // A shape of this blade between erring clamps.
  [[nodiscard]] std::optional<Place> seen(const Elastica& shape) const {
    const PressedBlade blade = PressedBlade::of(shape);
    const double turn = std::remainder(shape.theta - e_.theta, 2 * std::numbers::pi);
    return at({turn, blade.size, blade.phase, blade.force});
  }

  // By differences of the exact first derivatives; a turn of A alone needs no other curve.
  [[nodiscard]] std::optional<Slopes> slopes(const Place& p) const {
    // Half the digits of a number of size 1.
    constexpr double kStep = 1e-6;
    Slopes s;
    const Vector4d units = units_at(p.q);
    s.distance = p.slope.transpose() * p.error;
    for (Eigen::Index i = 0; i < 4; ++i) {
      const double step = kStep * std::min(1.0, std::abs(p.q[1])) * units[i];
      const Vector4d q = p.q + step * Vector4d::Unit(i);
      const auto other = i == 0 ? placed(q, p.end) : at(q);
      if (!other) return {};
      s.bend.col(i) =
          units[i] * units.cwiseProduct(other->slope.transpose() * other->error - s.distance) / step;
      s.fold[i] = units[i] * (other->fold - p.fold) / step;
    }
    s.distance = units.cwiseProduct(s.distance);
    s.fold[0] = 0;
    s.bend = (0.5 * (s.bend + s.bend.transpose())).eval();
    return s;
  }

  // Onto the fold at these unknowns by the force alone, from a guess of it and of the fold's slope along it:
  // secants, held between a stable shape and one that is not.
  [[nodiscard]] std::optional<Place> onto_fold(Vector4d q, double slope) const {
    constexpr int kMostSteps = 16;
    constexpr double kOn = 1e-8, kMostForce = 1e4;
    double low = 0, high = kMostForce, growth = 0.02;
    const bool stable_below = slope * stable_sign_ < 0;
    std::optional<Place> before;
    for (int i = 0; i < kMostSteps; ++i) {
      auto p = at(q);
      if (!p) return {};
      ((p->end.index == 0) == stable_below ? low : high) = q[3];
      if (before) slope = (p->fold - before->fold) / (q[3] - before->q[3]);
      double next = q[3] - p->fold / slope;
      if (std::abs(next - q[3]) <= kOn * q[3] || high - low <= kOn * q[3]) {
        // Not where a shape becomes unstable once more.
        if ((slope * stable_sign_ < 0) != stable_below) return {};
        return p;
      }
      if (!(next > low && next < high)) {
        next = high == kMostForce ? low * (1 + growth) : low == 0 ? high * (1 - growth) : 0.5 * (low + high);
        growth *= 2;
      }
      q[3] = next;
      before = std::move(p);
    }
    return {};
  }

  // What a change of the slope over a step tells of the second derivatives, by symmetric rank-one updates
  // (Nocedal and Wright, Numerical Optimization, 6.2). All by the unknowns themselves.
  static void gather(Matrix4d& bend, const Place& p, const Slopes& at_p, const Place& q, const Slopes& at_q) {
    constexpr double kTelling = 1e-8;
    const Vector4d step = q.q - p.q;
    const Vector4d change = at_q.fold.cwiseQuotient(units_at(q.q)) - at_p.fold.cwiseQuotient(units_at(p.q));
    const Vector4d more = change - bend * step;
    const double along = more.dot(step);
    if (std::abs(along) > kTelling * more.norm() * step.norm()) bend += more * more.transpose() / along;
  }

  // Three directions square to v and to each other: the other columns of the reflection that turns v into an
  // axis. Eigen's decompositions would give the same, and take ten seconds to compile.
  [[nodiscard]] static Eigen::Matrix<double, 4, 3> square_to(const Vector4d& v) {
    Vector3d essential;
    double tau = 0, length = 0;
    v.makeHouseholder(essential, tau, length);
    Matrix4d q = Matrix4d::Identity();
    Eigen::RowVector4d workspace;
    q.applyHouseholderOnTheLeft(essential, tau, workspace.data());
    return q.rightCols<3>();
  }

  struct Step {
    Vector4d d = Vector4d::Zero();  // by the units
    double gain = 0;                // of the squared distance, that the second derivatives tell of it
  };

  // One step of sequential quadratic programming: nearest along the fold's tangent space by the second
  // derivatives of the distance and, by its multiplier, of the fold, made positive there, and no farther than
  // the blade's shape changes smoothly.
  [[nodiscard]] static Step step(const Place& p, const Slopes& s, const Matrix4d& fold_bend) {
    const Eigen::Matrix<double, 4, 3> tangent = square_to(s.fold);
    const Vector4d to_fold = -p.fold / s.fold.squaredNorm() * s.fold, units = units_at(p.q);
    const double multiplier = -s.distance.dot(s.fold) / s.fold.squaredNorm();
    const Matrix4d bend = s.bend + multiplier * units.asDiagonal() * fold_bend * units.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(tangent.transpose() * bend * tangent);
    const Vector3d slope =
        eigen.eigenvectors().transpose() * tangent.transpose() * (s.distance + bend * to_fold);
    const double floor = 1e-9 * eigen.eigenvalues().cwiseAbs().maxCoeff();
    const Vector3d along = -slope.cwiseQuotient(eigen.eigenvalues().cwiseAbs().cwiseMax(floor));
    Step whole{tangent * (eigen.eigenvectors() * along), -slope.dot(along)};
    constexpr double kFurthest = 0.5;
    if (whole.d.norm() > kFurthest) whole.d *= kFurthest / whole.d.norm();
    return whole;
  }

  void descend(const Place& start) {
    // The fold's slope along the force.
    constexpr double kBeside = 1e-4;
    const auto beside = at(start.q + kBeside * start.q[3] * Vector4d::Unit(3));
    if (!beside) return;
    auto here = onto_fold(start.q, (beside->fold - start.fold) / (kBeside * start.q[3]));
    if (!here) return;
    auto s = slopes(*here);
    if (!s) return;
    Matrix4d bend = Matrix4d::Zero();
    constexpr int kMostSteps = 40;
    constexpr double kNear = 1e-7;  // of the distance: far below what clamps are known to
    for (int i = 0; i < kMostSteps; ++i) {
      const Step whole = step(*here, *s, bend);
      if (whole.gain < kNear * here->squared()) break;
      // Too far by what the second derivatives tell.
      constexpr double kTimes = 4;
      if (here->squared() - kTimes * whole.gain > largest_ * largest_) return;
      const double before = here->squared();
      if (!stepped(*here, *s, whole.d, bend)) break;
      if (here->squared() > (1 - kNear) * before) break;
      if (std::abs(here->q[1]) < kStraightSize || known(*here)) return;
      // Steps are no smaller than the way that is left, so eight of them come near.
      constexpr int kSoon = 8;
      if (i >= kSoon && here->squared() > 1.5 * largest_ * largest_) return;
    }
    if (here->squared() < largest_ * largest_) keep(*here);
  }

  // Goes the longest of a step and its halves that comes nearer; false where none does.
  [[nodiscard]] bool stepped(Place& here, Slopes& s, Vector4d d, Matrix4d& bend) const {
    constexpr int kMostHalvings = 8;
    const Vector4d units = units_at(here.q);
    for (int k = 0; k < kMostHalvings; ++k, d *= 0.5) {
      const Vector4d by = units.cwiseProduct(d);
      const double along = s.fold[3] / units[3];
      // The force follows the fold's bend.
      constexpr double kMost = 0.1;  // of it
      const double more = std::clamp(-0.5 * by.dot(bend * by) / along, -kMost * here.q[3], kMost * here.q[3]);
      const auto next = onto_fold(here.q + by + more * Vector4d::Unit(3), along);
      if (!next || !(next->squared() < here.squared())) continue;
      const auto there = slopes(*next);
      if (!there) continue;
      gather(bend, here, s, *next, *there);
      here = *next;
      s = *there;
      return true;
    }
    return false;
  }

  // One that is no farther: a place of an edge may be a saddle, from which a descent goes on.
  [[nodiscard]] bool known(const Place& p) const {
    constexpr double kRounding = 1e-6;
    return std::any_of(minima_.begin(), minima_.end(), [&](const Place& m) {
      return m.squared() <= (1 + kRounding) * p.squared() && (bending(m.q) - bending(p.q)).norm() < same_;
    });
  }

  void keep(const Place& p) {
    if (!known(p)) minima_.push_back(p);
  }

  // Whether the shape, its clamps led straight to the fold's, becomes that one. A fold beyond another one
  // belongs to another shape, and the other one is looked into.
  [[nodiscard]] bool reached(const Place& p) {
    // Near a fold shapes change with the square root of the way that is left, near an edge with the third:
    // most are soon alike, and those that are not come closer on the last tenth of a way.
    constexpr double kSame = 0.1;    // of size and force
    constexpr double kCloser = 0.6;  // an edge's is 0.46
    constexpr double kEarly = 0.9;   // of the way: another fold
    ClampedShape shape = held_;
    double gone = 0, before = 0;
    FollowStatus status = FollowStatus::kFollowed;
    for (const double left : {1e-3, 1e-4}) {
      FollowOptions walk;
      walk.smallest_step = left / (1 - gone);
      walk.exactness = Exactness::kSearch;
      const FollowReport way = follow_on(shape, clamps_at((1 - left) * p.error), walk);
      gone += (1 - left - gone) * way.fraction;
      shape = way.shape;
      status = way.status;
      // Both with the force less than half a turn from the tangent.
      const PressedBlade end = PressedBlade::of(shape.elastica),
                         fold = PressedBlade::of(pressed(p.q).elastica());
      const double apart = std::max((end.bend() - fold.bend()).norm() / std::abs(fold.size),
                                    std::abs(end.force - fold.force) / fold.force);
      if (apart < std::max(kSame, kCloser * before)) return true;
      if (gone < kEarly) break;
      before = apart;
    }
    if (status == FollowStatus::kSnapped) {
      if (const auto place = seen(shape.elastica)) descend(*place);
    }
    return false;
  }

  // The pair of clamps with this error, seen as the blade stands.
  [[nodiscard]] ClampPair clamps_at(const Vector4d& error) const {
    const double l = e_.length;
    const ClampPair& held = clamps_;
    const Vector2d apart = l * kHalf * turned(e_.theta, error.head<2>());
    return {{held.a.x - apart.x(), held.a.y - apart.y(), held.a.theta + error[2] / weight_},
            {held.b.x + apart.x(), held.b.y + apart.y(), held.b.theta + error[3] / weight_}};
  }

  [[nodiscard]] Elastica shape_of(const Place& p) const {
    const double l = e_.length, l2 = l * l, turn = e_.theta + p.q[0];
    const Elastica blade = pressed(p.q).elastica();
    const Vector2d force = turned(turn, Vector2d(blade.lambda1, blade.lambda2)) / l2;
    const PlanarPose a = clamps_at(p.error).a;
    return {a.x, a.y, turn, blade.kappa / l, force.x(), force.y(), l};
  }

  Elastica e_;
  ClampedShape held_;  // e_ with its end
  ClampPair clamps_;
  double weight_, largest_;
  double same_ = 0;  // shapes this close in bending are one
  Vector2d chord_;
  double turn_ = 0;
  double stable_sign_ = 1;  // of stable shapes' determinants
  std::vector<Place> minima_, reached_;
  std::size_t looked_at_ = 0;  // of the minima
};

void check(const ClampMarginOptions& options) {
  if (!(options.largest_mm > 0) || !(options.mm_per_rad >= 0)) {
    throw std::logic_error("a clamp's largest error must be positive, the weight of a turn not negative");
  }
}

// Straight by kTautChord, or pulled by more than a start state can carry: no fold is looked for.
bool pulled_taut(const Elastica& e, const JacobiFields& end) {
  const Vector2d chord = (end.point.position() - Vector2d(e.x, e.y)) / e.length;
  const double l2 = e.length * e.length;
  return chord.norm() >= kTautChord || l2 * Vector2d(e.lambda1, e.lambda2).dot(chord) < -kLargestTension;
}

double straight_mm(const Elastica& e, const ClampMarginOptions& options) {
  const double weight = options.mm_per_rad > 0 ? options.mm_per_rad : 0.5 * e.length;
  return clamp_distance(clamps_of(e), {{0, 0, 0}, {e.length, 0, 0}}, weight);
}

// What the folds found and the straight pose make of the margin.
ClampMargin nearest(const Elastica& e, std::vector<Fold> folds, const ClampMarginOptions& options) {
  ClampMargin margin;
  margin.straight_mm = straight_mm(e, options);
  margin.fold_mm = folds.empty() ? options.largest_mm : folds.front().distance_mm;
  margin.margin_mm = std::min({options.largest_mm, margin.straight_mm, margin.fold_mm});
  margin.folds = std::move(folds);
  return margin;
}

}  // namespace

ClampMargin clamp_margin(const Elastica& e, const ClampMarginOptions& options) {
  return clamp_margin(e, {}, options);
}

ClampMargin clamp_margin(const Elastica& e, std::span<const Fold> near, const ClampMarginOptions& options) {
  check(options);
  const JacobiFields end = end_map(e);
  if (pulled_taut(e, end)) return nearest(e, {}, options);
  if (end.index != 0) return {};
  // Folds beyond the straight pose are not the nearest loss.
  constexpr double kLeastMm = 1e-12;
  ClampMarginOptions search_options = options;
  search_options.largest_mm = std::min(options.largest_mm, std::max(straight_mm(e, options), kLeastMm));
  FoldSearch search(e, search_options);
  for (const Fold& fold : near) search.look_near(fold.shape);
  if (options.everywhere || near.empty() || !search.leads_to_a_fold()) search.look_everywhere();
  return nearest(e, search.folds(), options);
}

}  // namespace hotblade::elastica
