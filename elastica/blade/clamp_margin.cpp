#include "elastica/blade/clamp_margin.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

#include "elastica/blade/end_map.hpp"
#include "elastica/linear/solve.hpp"

namespace hotblade::elastica {

namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector4d;

// Everything below is for a blade of length 1. Unknowns q = (turn of clamp A, kappa, lambda1, lambda2 over
// kForce), the last three in A's axes; a change by one of any bends the blade by about as much.
constexpr double kForce = 5;

Elastica unit_blade(const Vector4d& q) {
  return {0, 0, 0, q[1], kForce * q[2], kForce * q[3], 1};
}

Vector4d fold_unknowns(const Elastica& e) {
  const Vector2d force = force_along(e, e.theta) * (e.length * e.length / kForce);
  return {0, e.kappa * e.length, force.x(), force.y()};
}

Vector2d turned(double angle, const Vector2d& v) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

// Either clamp bears half of a change of the chord: its share of the squares is 1/2.
constexpr double kHalf = std::numbers::sqrt2 / 2;

// 1 - chord^2 of a blade that is a line but for rounding.
constexpr double kLeastSlack = 1e-12;

// What the unknowns make of the blade.
struct Place {
  Vector4d q = Vector4d::Zero();
  // The clamps' error as four numbers whose norm is its size: change of the chord, turns of A and B.
  Vector4d error = Vector4d::Zero();
  Matrix4d slope = Matrix4d::Zero();  // d error / d q
  // Vanishes at folds: determinant of the end fields, over what it loses where the blade becomes a line and
  // its end cannot move along it.
  double fold = 0;
  JacobiFields end;  // with A's tangent along x
  [[nodiscard]] double squared() const { return error.squaredNorm(); }
};

// Slopes of distance and fold along the unknowns.
struct Slopes {
  Vector4d distance = Vector4d::Zero();  // of half the squared error
  Vector4d fold = Vector4d::Zero();
  Matrix4d bend = Matrix4d::Zero();  // second derivatives of half the squared error
};

FollowOptions search_walk(double smallest_step) {
  FollowOptions options;
  options.smallest_step = smallest_step;
  options.exactness = Exactness::kSearch;
  return options;
}

class FoldSearch {
 public:
  FoldSearch(const Elastica& e, const ClampMarginOptions& options)
      : e_(e),
        weight_(options.mm_per_rad > 0 ? options.mm_per_rad / e.length : 0.5),
        largest_(options.largest_mm / e.length) {
    const JacobiFields end = end_map(unit_blade(fold_unknowns(e)), Exactness::kSearch);
    held_ = {e, end.index, 0, end};
    clamps_ = clamps_of(e);
    chord_ = end.point.position();
    turn_ = end.point.theta;
    home_ = placed(fold_unknowns(e), end);
    // Of a shallow blade curvatures and forces square to its chord are as small as the root of what the chord
    // lacks.
    constexpr double kSame = 0.02;
    same_ = kSame * std::min(1.0, 2 * std::numbers::pi * std::sqrt(std::max(0.0, 1 - chord_.norm())));
  }

  // Leads the clamps straight in a direction of errors and starts the descent where, of some places on the
  // way, the fold's value is smallest: at a fold met, or beside one.
  void look_along(const Vector4d& direction) {
    if (!direction.allFinite() || !(direction.norm() > 0)) return;
    constexpr int kPlaces = 4;
    const FollowOptions walk = search_walk(1.0 / 16);  // a start need not be exact
    const Vector4d leg = largest_ / kPlaces * direction.normalized();
    Place best = home_;
    bool moved = false;
    ClampedShape shape = held_;
    const int places = leads_along(walk.smallest_step * leg) ? kPlaces : 0;
    for (int i = 1; i <= places; ++i) {
      const FollowReport way = follow_on(shape, clamps_at(i * leg), walk);
      const auto end = seen(way.shape);
      if (!end) break;
      if (std::abs(end->fold) < std::abs(best.fold)) {
        best = *end;
        moved = true;
      }
      if (way.status != FollowStatus::kFollowed) break;
      shape = way.shape;
    }
    // Many directions lead nowhere where a step of the way is large for the shape.
    if (!moved && std::exchange(from_home_, true)) return;
    descend(best);
  }

  // Whether the shape can be followed to an error at once.
  [[nodiscard]] bool leads_along(const Vector4d& error) const {
    return follow_on(held_, clamps_at(error), search_walk(1)).status == FollowStatus::kFollowed;
  }

  // Starts where a blade whose ends are turned parallel buckles, as a straight one does (Euler):
  // theta = m (1 - cos 2 pi s) at lambda = 4 pi^2 along the chord. There the folds of both ways to bow meet
  // in an edge, which no direction of errors leads to.
  void look_where_parallel_ends_buckle() {
    constexpr double kEuler = 4 * std::numbers::pi * std::numbers::pi / kForce;
    const double turn = 0.5 * turn_, m = std::atan2(chord_.y(), chord_.x()) - turn;
    if (const auto place = at({turn, 0, kEuler * std::cos(m), kEuler * std::sin(m)})) descend(*place);
  }

  // Starts from a fold of a neighbouring pose.
  void look_near(const Elastica& shape) {
    if (const auto place = seen(shape)) descend(*place);
  }

  // Turns of the clamps: of each, of both alike, towards an S, and against each other, towards an arch. From
  // what these lead to a descent finds the folds that changes of the chord lead to as well.
  [[nodiscard]] static std::vector<Vector4d> directions() {
    std::vector<Vector4d> all;
    for (const double turn : {1.0, -1.0}) {
      all.emplace_back(0, 0, turn, 0);
      all.emplace_back(0, 0, 0, turn);
      all.emplace_back(0, 0, turn, turn);
      all.emplace_back(0, 0, turn, -turn);
    }
    return all;
  }

  // Whether the shape can be led to a minimum along a straight way.
  bool leads_to_a_fold() {
    // A shape lost on the way to a minimum shows another one, which is looked at in turn.
    constexpr std::size_t kMost = 16;
    for (; looked_at_ < std::min(kMost, minima_.size()); ++looked_at_) {
      const Place minimum = minima_[looked_at_];
      if (reached(minimum)) reached_.push_back(minimum);
    }
    return !reached_.empty();
  }

  // Those minima, the nearest first.
  [[nodiscard]] std::vector<Fold> folds() {
    leads_to_a_fold();
    std::vector<Fold> folds;
    for (const Place& p : reached_) {
      // At an edge a descent ends short of the nearest place of the pair.
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
  // Winds no more than a blade can.
  [[nodiscard]] static bool usable(const Vector4d& q) {
    constexpr double kLargestRate = 60;
    const Elastica blade = unit_blade(q);
    return q.allFinite() && taylor_rate(0, blade.kappa, blade.lambda1, blade.lambda2) < kLargestRate;
  }

  // Nothing where the blade is taut, or not usable.
  [[nodiscard]] std::optional<Place> at(const Vector4d& q) const {
    if (!usable(q)) return {};
    return untaut(q, end_map(unit_blade(q), Exactness::kSearch));
  }

  [[nodiscard]] std::optional<Place> untaut(const Vector4d& q, const JacobiFields& end) const {
    const Elastica blade = unit_blade(q);
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
    const Vector3d per(1, kForce, kForce);
    for (Eigen::Index i = 0; i < 3; ++i) {
      p.slope.block<2, 1>(0, i + 1) = per[i] * kHalf * turned(q[0], end.fields.block<2, 1>(0, i));
      p.slope(3, i + 1) = per[i] * weight_ * end.fields(2, i);
    }
    const double slack = 1 - end.point.position().squaredNorm();
    p.fold = end.fields.determinant() / std::max(slack, kLeastSlack);
    return p;
  }

  // A shape of this blade between erring clamps.
  [[nodiscard]] std::optional<Place> seen(const Elastica& shape) const { return at(seen_by(shape)); }
  [[nodiscard]] std::optional<Place> seen(const ClampedShape& shape) const {
    const Vector4d q = seen_by(shape.elastica);
    if (!usable(q)) return {};
    return untaut(q, shape.end);
  }
  [[nodiscard]] Vector4d seen_by(const Elastica& shape) const {
    Vector4d q = fold_unknowns(shape);
    q[0] = std::remainder(shape.theta - e_.theta, 2 * std::numbers::pi);
    return q;
  }

  // By differences of the exact first derivatives; a turn of A alone needs no other curve.
  [[nodiscard]] std::optional<Slopes> slopes(const Place& p) const {
    // Half the digits of a number of size 1.
    constexpr double kStep = 1e-6;
    Slopes s;
    s.distance = p.slope.transpose() * p.error;
    for (Eigen::Index i = 0; i < 4; ++i) {
      const Vector4d q = p.q + kStep * Vector4d::Unit(i);
      const auto other = i == 0 ? placed(q, p.end) : at(q);
      if (!other) return {};
      s.bend.col(i) = (other->slope.transpose() * other->error - s.distance) / kStep;
      s.fold[i] = (other->fold - p.fold) / kStep;
    }
    s.fold[0] = 0;
    s.bend = (0.5 * (s.bend + s.bend.transpose())).eval();
    return s;
  }

  // Onto the fold along its slope; nothing when that fails.
  [[nodiscard]] std::optional<Place> onto_fold(Place p, const Vector4d& slope) const {
    constexpr int kMostSteps = 8;
    constexpr double kOn = 1e-9;  // of the fold's value at home
    for (int i = 0; i < kMostSteps; ++i) {
      if (std::abs(p.fold) <= kOn * std::abs(home_.fold)) return p;
      const double before = std::abs(p.fold);
      const auto next = at(p.q - p.fold / slope.squaredNorm() * slope);
      if (!next || !(std::abs(next->fold) < 0.9 * before)) return {};
      p = *next;
    }
    return {};
  }

  // The change of the unknowns that makes a fold's value vanish, by its slope and what is known of its bend,
  // and asks for the smallest change of the clamps; where none does, one that lowers it the most.
  [[nodiscard]] static Vector4d step_to_fold(const Place& p, const Vector4d& slope, const Matrix4d& bend) {
    // A floor for directions that no clamp feels: they are what a fold is left by.
    constexpr double kFloor = 1e-5;
    const Matrix4d metric = p.slope.transpose() * p.slope + kFloor * Matrix4d::Identity();
    const auto left = [&](const Vector4d& d) {
      return 1 + (slope.dot(d) + 0.5 * d.dot(bend * d)) / p.fold;  // of the value
    };
    const Vector4d steepest = solve_symmetric(metric, slope);
    double multiplier = -p.fold / slope.dot(steepest);
    Vector4d d = multiplier * steepest;
    // Along a direction that no clamp feels the value has a least one beside an edge of folds, where steps by
    // the slope alone go from side to side.
    constexpr double kEnough = 0.25;  // of the value, that the bend leaves
    constexpr int kMostDoublings = 12;
    double least = left(d);
    for (int i = 0; i < kMostDoublings && least > kEnough; ++i) {
      multiplier *= 2;
      const Vector4d next = multiplier * (metric - multiplier * bend).partialPivLu().solve(slope);
      const double rest = left(next);
      if (!(rest < least) || !(next.norm() < kFurthest)) break;
      least = rest;
      d = next;
    }
    return d;
  }

  // Onto a fold from anywhere: Newton's steps for its value, its bend gathered by symmetric rank-one updates
  // (Nocedal and Wright, Numerical Optimization, 6.2).
  [[nodiscard]] std::optional<Place> to_fold(Place p) const {
    constexpr int kMostSteps = 25, kMostHalvings = 6;
    // A way that has led three times too far hardly comes back.
    constexpr double kOn = 1e-3, kTooFar = 9, kHopeless = 36;
    Matrix4d bend = Matrix4d::Zero();
    auto s = slopes(p);
    for (int i = 0; s && i < kMostSteps; ++i) {
      if (std::abs(p.fold) < kOn * std::abs(home_.fold)) return onto_fold(p, s->fold);
      Vector4d d = step_to_fold(p, s->fold, bend);
      // The value falls with the square root of the way that is left: a step asks for twice the way at most.
      if ((p.slope * d).squaredNorm() > kHopeless * largest_ * largest_) return {};
      if (d.norm() > kFurthest) d *= kFurthest / d.norm();
      std::optional<Place> next;
      for (int k = 0; k < kMostHalvings; ++k, d *= 0.5) {
        next = at(p.q + d);
        if (next && std::abs(next->fold) < std::abs(p.fold)) break;
        next.reset();
      }
      if (!next || next->squared() > kTooFar * largest_ * largest_) return {};
      const auto there = slopes(*next);
      if (there) gather(bend, next->q - p.q, there->fold - s->fold);
      p = *next;
      s = there;
    }
    return {};
  }

  // What a change of the slope over a step tells of the second derivatives.
  static void gather(Matrix4d& bend, const Vector4d& step, const Vector4d& change) {
    constexpr double kTelling = 1e-8;
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

  // One step of sequential quadratic programming: nearest along the fold's tangent space by the second
  // derivatives, made positive there, and no farther than the blade's shape changes smoothly.
  [[nodiscard]] static Vector4d step(const Place& p, const Slopes& s) {
    const Eigen::Matrix<double, 4, 3> tangent = square_to(s.fold);
    const Vector4d to_fold = -p.fold / s.fold.squaredNorm() * s.fold;
    const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(tangent.transpose() * s.bend * tangent);
    const Vector3d slope =
        eigen.eigenvectors().transpose() * tangent.transpose() * (s.distance + s.bend * to_fold);
    const double floor = 1e-9 * eigen.eigenvalues().cwiseAbs().maxCoeff();
    const Vector3d along = -slope.cwiseQuotient(eigen.eigenvalues().cwiseAbs().cwiseMax(floor));
    Vector4d d = tangent * (eigen.eigenvectors() * along);
    constexpr double kFurthest = 1.5;
    if (d.norm() > kFurthest) d *= kFurthest / d.norm();
    return d;
  }

  void descend(const Place& start) {
    auto here = to_fold(start);
    if (!here) return;
    // A fold that another way has met already.
    for (const Vector4d& q : started_) {
      if ((q - here->q).norm() < same_) return;
    }
    started_.push_back(here->q);
    constexpr int kMostSteps = 40, kMostHalvings = 12;
    constexpr double kNear = 1e-7;  // of the distance: far below what clamps are known to
    auto s = slopes(*here);
    if (!s) return;
    // Folds meet in edges, in the space of errors, where the unfelt change runs along the fold: beyond one it
    // is the fold of another shape.
    Vector4d free = unfelt(*here, Vector4d(0.1, 1, 1, 1).normalized());
    const double side = free.dot(s->fold);
    for (int i = 0; i < kMostSteps; ++i) {
      Vector4d d = step(*here, *s);
      std::optional<Place> next;
      std::optional<Slopes> there;
      for (int k = 0; k < kMostHalvings; ++k, d *= 0.5) {
        const auto tried = at(here->q + d);
        if (tried) next = onto_fold(*tried, s->fold);
        if (next && next->squared() < here->squared()) {
          there = slopes(*next);
          if (there && unfelt(*next, free).dot(there->fold) * side >= 0) break;
        }
        next.reset();
      }
      const bool done = !next || next->squared() > (1 - kNear) * here->squared();
      if (next) {
        here = next;
        s = there;
        free = unfelt(*here, free);
      }
      if (done) break;
      // Steps are no smaller than the way that is left, so eight of them come near.
      constexpr int kSoon = 8;
      if (i >= kSoon && here->squared() > 1.5 * largest_ * largest_) return;
    }
    if (here->squared() < largest_ * largest_) keep(*here);
  }

  // The change of shape at a fold that no clamp feels, turned as another one nearby.
  [[nodiscard]] static Vector4d unfelt(const Place& fold, const Vector4d& as) {
    constexpr double kSmall = 1e-12;
    constexpr int kSteps = 3;  // of inverse iteration
    const Matrix4d square = fold.slope.transpose() * fold.slope + kSmall * Matrix4d::Identity();
    Vector4d v = as;
    for (int i = 0; i < kSteps; ++i) v = solve_symmetric(square, v).normalized();
    return v.dot(as) < 0 ? Vector4d(-v) : v;
  }

  void keep(const Place& p) {
    const bool known = std::any_of(minima_.begin(), minima_.end(),
                                   [&](const Place& m) { return (m.q - p.q).norm() < same_; });
    if (!known) minima_.push_back(p);
  }

  // Whether the shape, its clamps led straight to the fold's, is lost there: a fold beyond another one
  // belongs to another shape, and the other one is looked into. Where folds meet in an edge the way may slip
  // past on one side of it.
  [[nodiscard]] bool reached(const Place& p) {
    const FollowReport way = follow_on(held_, clamps_at(1.01 * p.error), search_walk(1e-3));
    const auto end = seen(way.shape);
    if (!end) return false;
    // Near a fold shapes change with the square root of the way that is left.
    constexpr double kThere = 0.97, kNear = 1.5, kAtEdge = 0.3;
    const double away = (end->q - p.q).norm();
    if (way.status == FollowStatus::kSnapped) {
      if (way.fraction > kThere) return away < kNear;
      descend(*end);
      return false;
    }
    return way.status == FollowStatus::kFollowed && away < kAtEdge;
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
    const double l = e_.length, l2 = l * l / kForce, turn = e_.theta + p.q[0];
    const Vector2d force = turned(turn, p.q.tail<2>() / l2);
    const PlanarPose a = clamps_at(p.error).a;
    return {a.x, a.y, turn, p.q[1] / l, force.x(), force.y(), l};
  }

  Elastica e_;
  ClampedShape held_;  // e_ with its end
  ClampPair clamps_;
  double weight_, largest_;
  static constexpr double kFurthest = 1;  // of a step to a fold
  double same_ = 0;                       // shapes this close in bending are one
  Vector2d chord_;
  double turn_ = 0;
  Place home_;
  std::vector<Place> minima_, reached_;
  std::size_t looked_at_ = 0;  // of the minima
  std::vector<Vector4d> started_;
  bool from_home_ = false;  // a descent has started there
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
  ClampMarginOptions search_options = options;
  search_options.largest_mm = std::min(options.largest_mm, std::max(straight_mm(e, options), kLeastSlack));
  FoldSearch search(e, search_options);
  search.look_where_parallel_ends_buckle();
  for (const Fold& fold : near) search.look_near(fold.shape);
  if (options.all_directions || near.empty() || !search.leads_to_a_fold()) {
    for (const Vector4d& direction : search.directions()) search.look_along(direction);
  }
  return nearest(e, search.folds(), options);
}

double clamp_distance(const ClampPair& a, const ClampPair& b, double mm_per_rad) {
  const Vector2d p = turned(-a.a.theta, Vector2d(a.b.x - a.a.x, a.b.y - a.a.y));
  const Vector2d q = turned(-b.a.theta, Vector2d(b.b.x - b.a.x, b.b.y - b.a.y));
  const double more = (b.b.theta - b.a.theta) - (a.b.theta - a.a.theta), w2 = mm_per_rad * mm_per_rad;
  // b turned by `by` against a: any turn bounds the distance from above; Newton's method finds the least.
  const auto squared = [&](double by) {
    return 0.5 * (p - turned(by, q)).squaredNorm() + w2 * (by * by + (by + more) * (by + more));
  };
  double by = -0.5 * more;
  constexpr int kSteps = 4;  // the turn is small, and the second derivative nearly constant
  for (int i = 0; i < kSteps; ++i) {
    const Vector2d r = turned(by, q);
    const double slope = p.x() * r.y() - p.y() * r.x() + w2 * (4 * by + 2 * more);
    by -= slope / (std::max(0.0, p.dot(r)) + 4 * w2);
  }
  return std::sqrt(std::min(squared(by), squared(-0.5 * more)));
}

}  // namespace hotblade::elastica
