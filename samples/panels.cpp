#include "samples/panels.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <random>

namespace hotblade::samples {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

// A surface over the unit square, in mm.
using Surface = std::function<Vector3d(double u, double v)>;
// A classic surface, scaled by s.
using Classic = Vector3d (*)(double s, double u, double v);

constexpr int kCells = 80;

// The standard fixes what the twister draws, but not what its distributions make of it.
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : bits_(seed) {}

  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(bits_() >> 11) * 0x1p-53);
  }

  // Box and Muller (1958), of which the sine is not used.
  double normal() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform(0, 1)));
    return radius * std::cos(uniform(0, 2 * pi));
  }

 private:
  std::mt19937_64 bits_;
};

Vector3d turned_about_z(double out, double angle, double z) {
  return {out * std::cos(angle), out * std::sin(angle), z};
}

Vector3d helicoid(double s, double u, double v) {
  return turned_about_z((300 + 500 * u) * s, v - 0.5, 250 * s * (v - 0.5));
}

Vector3d catenoid(double s, double u, double v) {
  const double along = 900 * (u - 0.5);
  return turned_about_z(600 * s * std::cosh(along / 600), 1.2 * (v - 0.5), along * s);
}

// Outside of a torus, 350 mm round, whose centre line is a circle of 900 mm.
Vector3d torus(double s, double u, double v) {
  const double around = 1.5 * (u - 0.5);
  return turned_about_z((900 + 350 * std::cos(around)) * s, 0.9 * (v - 0.5), 350 * s * std::sin(around));
}

Vector3d torus_inner(double s, double u, double v) {
  const double around = 1.5 * (u - 0.5);
  return turned_about_z((1100 - 350 * std::cos(around)) * s, 0.9 * (v - 0.5), 350 * s * std::sin(around));
}

Vector3d cone(double s, double u, double v) {
  return turned_about_z((250 + 450 * u) * s, 1.6 * (v - 0.5), 700 * u * s);
}

Vector3d conoid(double s, double u, double v) {
  return {1000 * s * (u - 0.5), 800 * s * (v - 0.5), 160 * s * v * std::cos(pi * (u - 0.5))};
}

Vector3d enneper(double s, double u, double v) {
  const double x = 1.1 * (u - 0.5), y = 1.1 * (v - 0.5);
  return 420 * s * Vector3d(x - x * x * x / 3 + x * y * y, y - y * y * y / 3 + y * x * x, x * x - y * y);
}

Vector3d monkey(double s, double u, double v) {
  const double x = 2 * u - 1, y = 2 * v - 1;
  return {500 * s * x, 500 * s * y, 70 * s * (x * x * x - 3 * x * y * y)};
}

Vector3d sphere(double s, double u, double v) {
  const double latitude = 1.1 * (u - 0.5), longitude = 1.1 * (v - 0.5);
  return turned_about_z(700 * s * std::cos(latitude), longitude, 700 * s * std::sin(latitude));
}

Vector3d egg_crate(double s, double u, double v) {
  return {1000 * s * u, 800 * s * v, 25 * s * std::sin(2 * pi * u) * std::sin(2 * pi * v)};
}

Vector3d monge_step(double s, double u, double v) {
  const double step = 120 / (1 + std::exp(-9 * (u - 0.5 - 0.25 * (v - 0.5))));
  return {1000 * s * u, 700 * s * v, s * step};
}

Vector3d trough(double s, double u, double v) {
  const double depth = 150 * (std::cosh(1.7 * (v - 0.5)) - 1) * (1 + 0.6 * u);
  return {1100 * s * u, 700 * s * v, s * depth};
}

struct NamedClassic {
  const char* name;
  Classic at;
};

constexpr std::array<NamedClassic, 12> kClassics{{{"helicoid", helicoid},
                                                  {"catenoid", catenoid},
                                                  {"torus", torus},
                                                  {"torus_inner", torus_inner},
                                                  {"cone", cone},
                                                  {"conoid", conoid},
                                                  {"enneper", enneper},
                                                  {"monkey", monkey},
                                                  {"sphere", sphere},
                                                  {"egg_crate", egg_crate},
                                                  {"monge_step", monge_step},
                                                  {"trough", trough}}};

std::array<double, 4> bernstein(double t) {
  const double r = 1 - t;
  return {r * r * r, 3 * t * r * r, 3 * t * t * r, t * t * t};
}

// A bicubic Bezier patch over 500 to 1400 by 400 to 1000 mm, its net moved by up to 6 % of the shorter side,
// its heights normal with 4 to 16 % of it, times `height`.
Surface bicubic(Draws& draws, double height) {
  const double a = draws.uniform(500, 1400), b = draws.uniform(400, 1000), side = std::min(a, b);
  const double rise = height * side * draws.uniform(0.04, 0.16);
  std::array<std::array<Vector3d, 4>, 4> net;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      const double x = a * i / 3 + side * draws.uniform(-0.06, 0.06);
      const double y = b * j / 3 + side * draws.uniform(-0.06, 0.06);
      net[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = {x, y, rise * draws.normal()};
    }
  }
  return [net](double u, double v) {
    const auto bu = bernstein(u), bv = bernstein(v);
    Vector3d p = Vector3d::Zero();
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < 4; ++j) p += bu[i] * bv[j] * net[i][j];
    }
    return p;
  };
}

// The larger principal curvature in 1/mm, by central differences in steps of a thousandth of the side: they
// are good to 1e-5 of the curvature on these surfaces.
double curvature(const Surface& at, double u, double v) {
  constexpr double h = 1e-3;
  const Vector3d p = at(u, v), pu = at(u + h, v), mu = at(u - h, v), pv = at(u, v + h), mv = at(u, v - h);
  const Vector3d du = (pu - mu) / (2 * h), dv = (pv - mv) / (2 * h);
  const Vector3d duu = (pu - 2 * p + mu) / (h * h), dvv = (pv - 2 * p + mv) / (h * h);
  const Vector3d duv =
      (at(u + h, v + h) - at(u + h, v - h) - at(u - h, v + h) + at(u - h, v - h)) / (4 * h * h);
  const Vector3d n = du.cross(dv).normalized();
  const double e = du.dot(du), f = du.dot(dv), g = dv.dot(dv), area = e * g - f * f;
  const double l = duu.dot(n), m = duv.dot(n), k = dvv.dot(n);
  const double mean = (e * k - 2 * f * m + g * l) / (2 * area), gauss = (l * k - m * m) / area;
  return std::abs(mean) + std::sqrt(std::max(0.0, mean * mean - gauss));
}

double grid(int i) {
  return static_cast<double>(i) / kCells;
}

double smallest_radius(const Surface& surface) {
  double sharpest = 0;
  for (int i = 0; i <= kCells; ++i) {
    for (int j = 0; j <= kCells; ++j) sharpest = std::max(sharpest, curvature(surface, grid(i), grid(j)));
  }
  return 1 / sharpest;
}

// A turn that is uniform over all (Shoemake 1992): a normal quaternion of unit length.
Eigen::Quaterniond random_turn(Draws& draws) {
  const double w = draws.normal(), x = draws.normal(), y = draws.normal(), z = draws.normal();
  return Eigen::Quaterniond(w, x, y, z).normalized();
}

// Whether a point of the grid is one of the panel.
using Inside = std::function<bool(int i, int j)>;

bool in_disc(int i, int j) {
  const int a = 2 * i - kCells, b = 2 * j - kCells;
  return a * a + b * b <= kCells * kCells;
}

// The grid's points that are inside, with their triangles. A cell that loses one corner is a triangle, one
// that loses more is none. Whole cells are halved from their first corner, or from the one before it where
// `other` says so.
void mesh(
    const Surface& surface, const Eigen::Quaterniond& turn, const Inside& inside, Panel& panel,
    const std::function<bool()>& other = [] { return false; }) {
  std::vector<int> number;
  for (int i = 0; i <= kCells; ++i) {
    for (int j = 0; j <= kCells; ++j) {
      const bool kept = inside(i, j);
      number.push_back(kept ? static_cast<int>(panel.points.size()) : -1);
      if (kept) panel.points.push_back(turn * surface(grid(i), grid(j)));
    }
  }
  const auto at = [&](int i, int j) {
    return number[static_cast<std::size_t>(i) * (kCells + 1) + static_cast<std::size_t>(j)];
  };
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      std::vector<int> corners{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
      if (other()) std::rotate(corners.begin(), corners.begin() + 1, corners.end());
      std::erase(corners, -1);
      for (std::size_t k = 2; k < corners.size(); ++k)
        panel.triangles.push_back({corners[0], corners[k - 1], corners[k]});
    }
  }
}

std::string numbered(char kind, int number, const char* name) {
  char text[48];
  std::snprintf(text, sizeof text, "%c%02d_%s", kind, number, name);
  return text;
}

Panel drawn(Draws& draws, int number) {
  constexpr std::array<const char*, 3> kKinds{"free", "mild", "disc"};
  const bool classic = number < static_cast<int>(kClassics.size());
  const auto kind = static_cast<std::size_t>(number % 3);
  Panel panel;
  Surface surface;
  do {
    if (classic) {
      const double s = draws.uniform(0.8, 1.3);
      surface = [s, at = kClassics[static_cast<std::size_t>(number)].at](double u, double v) {
        return at(s, u, v);
      };
    } else {
      surface = bicubic(draws, kind == 1 ? 0.5 : 1);
    }
    panel.radius_mm = smallest_radius(surface);
  } while (panel.radius_mm < kPanelRadiusMm);
  panel.name = classic ? numbered('c', number, kClassics[static_cast<std::size_t>(number)].name)
                       : numbered('p', number, kKinds[kind]);
  const bool turned = number % 4 == 3;
  const bool disc = !classic && kind == 2;
  const Inside inside = disc ? Inside(in_disc) : Inside([](int, int) { return true; });
  mesh(surface, turned ? random_turn(draws) : Eigen::Quaterniond::Identity(), inside, panel);
  return panel;
}

// A height over the plane, in mm, of a place in shares of the panel's sides from its middle.
using Height = std::function<double(double u, double v)>;

Height bump(double rise, double u0, double v0, double wide_u, double wide_v) {
  return [=](double u, double v) {
    const double a = (u - u0) / wide_u, b = (v - v0) / wide_v;
    return rise * std::exp(-0.5 * (a * a + b * b));
  };
}

double sign(Draws& draws) {
  return draws.uniform(0, 1) < 0.5 ? -1 : 1;
}

// A cap that falls off to the border, with a dent of up to half of what it rises beside its middle.
Height dented_dome(Draws& draws) {
  const double rise = draws.uniform(40, 140), a = draws.uniform(0.6, 1.1), b = draws.uniform(0.6, 1.1);
  const Height dent = bump(-rise * draws.uniform(0.2, 0.5), draws.uniform(-0.2, 0.2),
                           draws.uniform(-0.2, 0.2), draws.uniform(0.12, 0.25), draws.uniform(0.12, 0.25));
  return [=](double u, double v) { return -rise * (u * u / (a * a) + v * v / (b * b)) + dent(u, v); };
}

// A smooth step across the panel, askew, on a slope.
Height askew_step(Draws& draws) {
  const double rise = draws.uniform(30, 140), sharp = draws.uniform(4, 12), askew = draws.uniform(-0.8, 0.8),
               tilt = draws.uniform(-60, 60);
  return [=](double u, double v) { return rise * std::tanh(sharp * (u - askew * v)) / 2 + tilt * v; };
}

// Three waves of any direction and up to one and a half periods across the panel.
Height waves(Draws& draws) {
  struct Wave {
    double rise, u, v, phase;
  };
  std::array<Wave, 3> all{};
  for (Wave& w : all)
    w = {draws.uniform(5, 40), draws.uniform(-9, 9), draws.uniform(-9, 9), draws.uniform(0, 2 * pi)};
  return [=](double u, double v) {
    double z = 0;
    for (const Wave& w : all) z += w.rise * std::sin(w.u * u + w.v * v + w.phase);
    return z;
  };
}

Height saddle_with_bump(Draws& draws) {
  const double warp = sign(draws) * draws.uniform(60, 240);
  const Height on = bump(sign(draws) * draws.uniform(10, 60), draws.uniform(-0.3, 0.3),
                         draws.uniform(-0.3, 0.3), draws.uniform(0.12, 0.3), draws.uniform(0.12, 0.3));
  return [=](double u, double v) { return warp * u * v + on(u, v); };
}

Height bumps(Draws& draws) {
  std::vector<Height> all(3);
  for (Height& one : all) {
    const double rise = sign(draws) * draws.uniform(10, 80), u = draws.uniform(-0.4, 0.4),
                 v = draws.uniform(-0.4, 0.4);
    one = bump(rise, u, v, draws.uniform(0.15, 0.35), draws.uniform(0.15, 0.35));
  }
  return [all](double u, double v) { return all[0](u, v) + all[1](u, v) + all[2](u, v); };
}

// Whole, without a corner, or with a round window.
Inside dented_border(Draws& draws, int number) {
  const double corner = draws.uniform(0.15, 0.5), radius = draws.uniform(0.08, 0.18),
               u0 = draws.uniform(0.3, 0.7), v0 = draws.uniform(0.3, 0.7);
  const int kind = number % 3;
  return [=](int i, int j) {
    const double u = grid(i), v = grid(j);
    if (kind == 1) return u + v >= corner;
    return kind != 2 || std::hypot(u - u0, v - v0) >= radius;
  };
}

Panel dented(Draws& draws, int number) {
  struct Kind {
    const char* name;
    Height (*drawn)(Draws& draws);
  };
  constexpr std::array<Kind, 5> kKinds{{{"dome", dented_dome},
                                        {"step", askew_step},
                                        {"waves", waves},
                                        {"saddle", saddle_with_bump},
                                        {"bumps", bumps}}};
  const Kind& kind = kKinds[static_cast<std::size_t>(number) % kKinds.size()];
  Panel panel;
  panel.name = numbered('d', number, kind.name);
  Surface surface;
  do {
    const double a = draws.uniform(350, 1000), b = draws.uniform(250, 700);
    surface = [=, z = kind.drawn(draws)](double u, double v) {
      return Vector3d(a * (u - 0.5), b * (v - 0.5), z(u - 0.5, v - 0.5));
    };
    panel.radius_mm = smallest_radius(surface);
  } while (panel.radius_mm < kDentedLeastMm || panel.radius_mm > kDentedMostMm);
  const Inside inside = dented_border(draws, number);
  const auto turn = number % 4 == 3 ? random_turn(draws) : Eigen::Quaterniond::Identity();
  mesh(surface, turn, inside, panel, [&] { return draws.uniform(0, 1) < 0.5; });
  return panel;
}

// Surfaces of parts of buildings, over the unit square.
Surface tube(Draws& draws) {
  const double radius = draws.uniform(200, 700), turn = draws.uniform(1.5, 4.5),
               length = draws.uniform(400, 1500);
  return [=](double u, double v) {
    const double angle = turn * (u - 0.5);
    return Vector3d(radius * std::sin(angle), length * v, radius * std::cos(angle));
  };
}

Surface cone_part(Draws& draws) {
  const double narrow = draws.uniform(200, 400), wide = narrow + draws.uniform(100, 400),
               turn = draws.uniform(1.2, 3.6), length = draws.uniform(500, 1200);
  return [=](double u, double v) {
    const double angle = turn * (u - 0.5), radius = narrow + (wide - narrow) * v;
    return Vector3d(radius * std::sin(angle), length * v, radius * std::cos(angle));
  };
}

Surface dome(Draws& draws) {
  const double radius = draws.uniform(400, 1500), a = draws.uniform(0.5, 1.4), b = draws.uniform(0.5, 1.4);
  return [=](double u, double v) -> Vector3d {
    return radius * Vector3d(std::tan(a * (u - 0.5)), std::tan(b * (v - 0.5)), 1).normalized();
  };
}

Surface ribbon(Draws& draws) {
  const double length = draws.uniform(1500, 4000), width = draws.uniform(150, 500),
               rise = draws.uniform(30, 140), waves = draws.uniform(0.7, 2.5);
  return [=](double u, double v) {
    return Vector3d(length * u, width * (v - 0.5), rise * std::sin(2 * pi * waves * u));
  };
}

Surface propeller(Draws& draws) {
  const double length = draws.uniform(800, 2500), width = draws.uniform(200, 600),
               turn = draws.uniform(0.5, 2.2), rise = draws.uniform(-90, 90);
  return [=](double u, double v) {
    const double angle = turn * u, out = width * (v - 0.5);
    return Vector3d(length * u, out * std::cos(angle), out * std::sin(angle) + rise * std::sin(pi * u));
  };
}

Surface ramp(Draws& draws) {
  const double inner = draws.uniform(400, 1000), width = draws.uniform(200, 500),
               turn = draws.uniform(0.8, 2.5), rise = draws.uniform(150, 700),
               cant = draws.uniform(-0.3, 0.3);
  return [=](double u, double v) {
    return turned_about_z(inner + width * v, turn * u, rise * u + cant * width * v);
  };
}

Surface swells(Draws& draws) {
  const double a = draws.uniform(500, 1800), b = draws.uniform(400, 1300);
  const Height up =
                   bump(draws.uniform(30, 170), draws.uniform(-0.3, 0), draws.uniform(-0.3, 0.3), 0.25, 0.25),
               down =
                   bump(-draws.uniform(20, 120), draws.uniform(0, 0.3), draws.uniform(-0.3, 0.3), 0.22, 0.25);
  return [=](double u, double v) {
    return Vector3d(a * u, b * v, up(u - 0.5, v - 0.5) + down(u - 0.5, v - 0.5));
  };
}

Surface askew_wave(Draws& draws) {
  const double a = draws.uniform(700, 2200), b = draws.uniform(500, 1100), rise = draws.uniform(20, 80),
               along = draws.uniform(-1.3, 1.3), across = draws.uniform(-1, 1);
  return [=](double u, double v) {
    return Vector3d(a * u, b * v, rise * std::sin(2 * pi * (along * u + across * v)));
  };
}

// Borders of parts of buildings, in turn.
bool in_shell(int number, int i, int j) {
  constexpr int kBorders = 7;
  const double u = grid(i) - 0.5, v = grid(j) - 0.5;
  switch (number % kBorders) {
    case 1: {
      const double across = std::max(std::abs(v), 0.5 * std::abs(v) + 0.5 * std::sqrt(3.0) * std::abs(u));
      return across <= 0.43;  // a hexagon
    }
    case 2:
      return u < 0 || v < 0;  // an angle
    case 3:
      return std::abs(u) >= 0.15 || v <= -0.1;  // a fork
    case 4:
      return std::abs(u) >= 0.02 || v <= -0.2;  // a slit
    case 5:
      return std::abs(u) >= 0.18 || std::abs(v) >= 0.2;  // a window
    case 6: {
      const double out = std::hypot(u, v);
      return out <= 0.5 && out >= 0.2;
    }
    default:
      return true;
  }
}

Panel shell(Draws& draws, int number) {
  struct Kind {
    const char* name;
    Surface (*drawn)(Draws& draws);
  };
  constexpr std::array<Kind, 8> kKinds{{{"tube", tube},
                                        {"cone", cone_part},
                                        {"dome", dome},
                                        {"ribbon", ribbon},
                                        {"propeller", propeller},
                                        {"ramp", ramp},
                                        {"swells", swells},
                                        {"wave", askew_wave}}};
  const Kind& kind = kKinds[static_cast<std::size_t>(number) % kKinds.size()];
  Panel panel;
  panel.name = numbered('s', number, kind.name);
  Surface surface;
  do {
    surface = kind.drawn(draws);
    panel.radius_mm = smallest_radius(surface);
  } while (panel.radius_mm < kPanelRadiusMm);
  const auto turn = number % 4 == 3 ? random_turn(draws) : Eigen::Quaterniond::Identity();
  mesh(
      surface, turn, [number](int i, int j) { return in_shell(number, i, j); }, panel,
      [&] { return draws.uniform(0, 1) < 0.5; });
  return panel;
}

// A ruled vault with a sharp crown and steep feet.
Panel vault(Draws& draws, int number) {
  const double width = draws.uniform(150, 230), height = width * draws.uniform(0.7, 0.92),
               length = draws.uniform(250, 400), lean = draws.uniform(-0.15, 0.15),
               full = draws.uniform(-0.25, 0.35), rises = draws.uniform(0, 0.2);
  const Surface surface = [=](double u, double v) {
    const double s = std::sin(pi * u);
    return Vector3d(width * u + lean * height * s, length * v,
                    height * s * (1 + full * (1 - s)) * (1 + rises * (v - 0.5)));
  };
  Panel panel;
  panel.name = numbered('v', number, "vault");
  panel.radius_mm = smallest_radius(surface);
  const auto turn = number % 4 == 3 ? random_turn(draws) : Eigen::Quaterniond::Identity();
  mesh(
      surface, turn, [](int, int) { return true; }, panel, [&] { return draws.uniform(0, 1) < 0.5; });
  return panel;
}

std::vector<Panel> all_drawn(std::uint64_t seed, Panel (*draw)(Draws& draws, int number)) {
  Draws draws(seed);
  std::vector<Panel> all;
  all.reserve(kPanels);
  for (int number = 0; number < kPanels; ++number) all.push_back(draw(draws, number));
  return all;
}

}  // namespace

std::vector<Panel> panels(std::uint64_t seed) {
  return all_drawn(seed, drawn);
}

std::vector<Panel> dented_panels(std::uint64_t seed) {
  return all_drawn(seed, dented);
}

std::vector<Panel> shell_panels(std::uint64_t seed) {
  return all_drawn(seed, shell);
}

std::vector<Panel> vault_panels(std::uint64_t seed) {
  return all_drawn(seed, vault);
}

std::string obj_text(const Panel& panel) {
  std::string text = "# Units: mm, +z up. Written by panel_table.\no " + panel.name + "\n";
  char line[96];
  for (const Vector3d& p : panel.points) {
    // Rounded before adding zero, so that no zero is written as -0.000000.
    const Vector3d rounded = (p * 1e6).array().round() / 1e6 + 0.0;
    std::snprintf(line, sizeof line, "v %.6f %.6f %.6f\n", rounded.x(), rounded.y(), rounded.z());
    text += line;
  }
  for (const auto& t : panel.triangles) {
    std::snprintf(line, sizeof line, "f %d %d %d\n", t[0] + 1, t[1] + 1, t[2] + 1);
    text += line;
  }
  return text;
}

}  // namespace hotblade::samples
