#include "elastica/curve/closed_form.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "elastica/curve/closed_form_lanes.hpp"

namespace hotblade::elastica {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Levels below this modulus change nothing in double.
constexpr double kLeastModulus = 1e-17;
// The complement that stands for 0 at modulus 1: its quarter period, 346, lies beyond kReach, where sech is
// 1e-130.
constexpr double kLeastComplement = 1e-150, kReach = 300;

enum class Integral { kDn, kCn };

// The ladder of modulus m with complement sqrt(1 - m^2), by the arithmetic-geometric mean: k_n = c_n / a_n.
// For the integral of cn^2 = (dn^2 - (1 - m^2)) / m^2 the weights are divided by m^2 beforehand, so that m =
// 0 is no exception.
hb_ladder make_ladder(double m, double complement, Integral integral) {
  hb_ladder ladder{};
  ladder.reach = complement < kLeastComplement ? kReach : kInfinity;
  double a = 1, b = std::max(complement, kLeastComplement), c = m, d = 1, power = 1;
  const bool dn = integral == Integral::kDn;
  double linear = dn ? 1 - m * m / 2 : 0.5;
  do {
    const double mean = (a + b) / 2;
    b = std::sqrt(a * b);
    // d = c / m^2, whose first is 1 / (4 a).
    d = ladder.levels == 0 ? 1 / (4 * mean) : c * d / (4 * mean);
    c = c * c / (4 * mean);
    a = mean;
    linear -= power * c * (dn ? c : d);
    power *= 2;
    ladder.k[ladder.levels] = c / a;
    ladder.z[ladder.levels] = power * (dn ? c : d);
    ++ladder.levels;
  } while (c > kLeastModulus * a && ladder.levels < HB_LADDER_LEVELS);
  ladder.bottom = a;
  ladder.linear = linear;
  return ladder;
}

// F(phi) = Int dphi / sqrt(1 - m^2 sin^2 phi) by Landen's transformation of the amplitude.
double first_kind(double sine, double cosine, double complement) {
  double a = 1, b = std::max(complement, kLeastComplement), power = 1;
  double phi = std::atan2(sine, cosine);
  while (std::abs(a - b) > std::numeric_limits<double>::epsilon() * a) {
    // The angle of slope (b/a) tan phi, in the same quarter turn as phi.
    const double steep = std::atan2(b * std::sin(phi), a * std::cos(phi));
    phi += steep + 2 * std::numbers::pi * std::round((phi - steep) / (2 * std::numbers::pi));
    const double mean = (a + b) / 2;
    b = std::sqrt(a * b);
    a = mean;
    power *= 2;
  }
  return phi / (power * a);
}

const ClosedFormKernels& kernels(Simd simd) {
  if (!supported(simd)) throw std::logic_error("closed form: instruction set not supported by this machine");
  switch (simd) {
    case Simd::kAvx512:
      return kClosedFormAvx512;
    case Simd::kAvx2:
      return kClosedFormAvx2;
    case Simd::kBaseline:
      break;
  }
  return kClosedFormBaseline;
}

double* output(std::span<double> out, std::size_t n) {
  if (!out.empty() && out.size() != n) throw std::logic_error("closed form: spans of different sizes");
  return out.empty() ? nullptr : out.data();
}

CurveLanes lanes_of(std::span<const double> s, const CurveBatch& out) {
  const std::size_t n = s.size();
  return {s.data(),
          output(out.x, n),
          output(out.y, n),
          output(out.tangent_x, n),
          output(out.tangent_y, n),
          output(out.kappa, n)};
}

// The shape of a curve that turns. With w = sqrt|lambda| and psi the direction against the axis, the
// pendulum's energy is k^2 = sin^2(psi/2) + (kappa/2w)^2; both k and 1 - k^2 are had without cancellation.
Shape shape_of(const Elastica& e) {
  Shape shape;
  const double w = std::sqrt(std::hypot(e.lambda1, e.lambda2));
  shape.axis = std::atan2(e.lambda2, e.lambda1);
  const double half = std::remainder(e.theta - shape.axis, 2 * std::numbers::pi) / 2, bend = e.kappa / 2;
  const double sine = std::sin(half), cosine = std::cos(half);
  const double energy = std::hypot(bend, w * sine);  // k w
  const double excess = (std::abs(bend) - w * cosine) * (std::abs(bend) + w * cosine);
  shape.modulus = w > 0 ? energy / w : kInfinity;
  if (excess > 0) {
    shape.regime = Regime::kWinding;
    shape.rate = std::copysign(energy, e.kappa);
    shape.complement_sq = excess / (energy * energy);
    shape.phase = first_kind(sine, cosine, std::sqrt(shape.complement_sq));
  } else {
    shape.regime = excess < 0 ? Regime::kInflectional : Regime::kSeparatrix;
    shape.rate = w;
    shape.complement_sq = -excess / (w * w);
    shape.phase = first_kind(w * sine, bend, std::sqrt(shape.complement_sq));
  }
  return shape;
}

}  // namespace

Jacobi::Jacobi(double modulus) : modulus_(modulus), period_(kInfinity) {
  if (!(modulus >= 0 && modulus < kInfinity)) throw std::logic_error("Jacobi: modulus outside [0, infinity)");
  const bool above = modulus > 1;
  const double m = above ? 1 / modulus : modulus;
  const double complement =
      above ? std::sqrt((modulus - 1) * (modulus + 1)) / modulus : std::sqrt((1 - m) * (1 + m));
  ladder_ = make_ladder(m, complement, above ? Integral::kCn : Integral::kDn);
  if (modulus != 1)
    period_ = above ? std::numbers::pi / (ladder_.bottom * modulus) : 2 * std::numbers::pi / ladder_.bottom;
}

void Jacobi::sample(std::span<const double> u, const JacobiBatch& out, Simd simd) const {
  const std::size_t n = u.size();
  kernels(simd).jacobi(ladder_, modulus_,
                       {u.data(), output(out.sn, n), output(out.cn, n), output(out.dn, n), output(out.e, n)},
                       n);
}

std::optional<ClosedForm> ClosedForm::of(const Elastica& e) {
  for (const double v : {e.x, e.y, e.theta, e.kappa, e.lambda1, e.lambda2, e.length}) {
    if (!std::isfinite(v)) throw std::logic_error("elastica parameters must be finite");
  }
  if (e.length < 0) throw std::logic_error("elastica length must not be negative");
  // Rounding of a period would show in so short a piece of it.
  if (!(e.length * taylor_rate(e.theta, e.kappa, e.lambda1, e.lambda2) > kStepOmega)) return std::nullopt;
  ClosedForm c;
  c.elastica_ = e;
  c.shape_ = shape_of(e);
  Shape& s = c.shape_;
  const bool wide = s.regime == Regime::kWinding;
  c.ladder_ = make_ladder(wide ? 1 / s.modulus : s.modulus, std::sqrt(s.complement_sq),
                          wide ? Integral::kCn : Integral::kDn);
  s.quarter_period = s.regime == Regime::kSeparatrix ? kInfinity : std::numbers::pi / (2 * c.ladder_.bottom);
  c.form_ = {s.rate,
             s.phase,
             1 / s.rate,
             2 * c.ladder_.linear - 1,
             0,
             0,
             1,
             0,
             wide ? 1 / s.modulus : s.modulus,
             0,
             0,
             wide ? 2 * s.rate : 2 * s.modulus * s.rate,
             wide};
  const hb_curve_point start = hb_closed_form_at(&c.ladder_, &c.form_, 0.0);
  c.form_.start_x = start.x * s.rate;
  c.form_.start_y = start.y * s.rate;
  c.form_.x = e.x;
  c.form_.y = e.y;
  c.form_.cos = std::cos(s.axis);
  c.form_.sin = std::sin(s.axis);
  return c;
}

CurvePoint ClosedForm::at(double s) const {
  const hb_curve_point p = hb_closed_form_at(&ladder_, &form_, s);
  // The direction's whole turns: a winding curve's half direction is the amplitude, within a quarter turn of
  // bottom v; an inflectional one's stays within half a turn of the axis.
  const auto direction = [this](double at) {
    const double v = shape_.rate * at + shape_.phase;
    const hb_jacobi j = hb_jacobi_at(&ladder_, v);
    if (!form_.wide) return 2 * std::atan2(shape_.modulus * j.sn, j.dn);
    const double half = std::atan2(j.sn, j.cn);
    return 2 *
           (half + 2 * std::numbers::pi * std::round((ladder_.bottom * v - half) / (2 * std::numbers::pi)));
  };
  return {p.x, p.y, elastica_.theta + (direction(s) - direction(0)), p.kappa};
}

void ClosedForm::sample(std::span<const double> s, const CurveBatch& out, Simd simd) const {
  kernels(simd).curve(ladder_, form_, lanes_of(s, out), s.size());
}

double ClosedForm::period() const {
  if (shape_.regime == Regime::kSeparatrix || std::isinf(shape_.modulus)) return kInfinity;
  return (form_.wide ? 2 : 4) * shape_.quarter_period / std::abs(shape_.rate);
}

double ClosedForm::quarter_argument() const {
  return std::numbers::pi / (2 * ladder_.bottom);
}

std::optional<double> ClosedForm::argument_square_to_axis() const {
  const double complement = std::sqrt(shape_.complement_sq), sine = std::numbers::sqrt2 / 2;
  if (form_.wide) return first_kind(sine, sine, complement);
  const double k = shape_.modulus;
  if (!(k > sine)) return std::nullopt;
  return first_kind(sine, std::sqrt((k - sine) * (k + sine)), complement);
}

Elastica ClosedForm::state() const {
  const double w = form_.wide ? std::abs(shape_.rate) / shape_.modulus : shape_.rate;
  const CurvePoint start = at(0);
  const double lambda = w * w;
  return {form_.x,
          form_.y,
          start.theta,
          start.kappa,
          lambda * std::cos(shape_.axis),
          lambda * std::sin(shape_.axis),
          elastica_.length};
}

void sample_points(const Elastica& elastica, std::span<const double> s, const CurveBatch& out) {
  if (const auto closed = ClosedForm::of(elastica)) return closed->sample(s, out);
  const CurveLanes to = lanes_of(s, out);
  for (std::size_t i = 0; i < s.size(); ++i) {
    const CurvePoint p = point_at(elastica, s[i]);
    const double values[] = {p.x, p.y, std::cos(p.theta), std::sin(p.theta), p.kappa};
    double* const outputs[] = {to.x, to.y, to.tangent_x, to.tangent_y, to.kappa};
    for (std::size_t k = 0; k < 5; ++k) {
      if (outputs[k]) outputs[k][i] = values[k];
    }
  }
}

}  // namespace hotblade::elastica
