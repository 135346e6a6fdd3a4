// Arms: all joints for a place beside KDL's iterations, a strip's path of two arms with all branches, places
// of its block, and its proof of being clear beside dense sampling.
#include <benchmark/benchmark.h>

#include <kdl/chain.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#include <random>

#include "pipeline/cell/cell_file.hpp"
#include "pipeline/plan/arms/arms.hpp"
#include "pipeline/plan/arms/places.hpp"
#include "pipeline/plan/arms/strip_clearance.hpp"
#include "robot/arm/arm_path.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace {

using namespace hotblade::robot;

const Arm& irb4600() {
  static const Cell cell = hotblade::pipeline::read_cell("two_irb4600");
  return cell.arms[0].model.arm;
}

std::vector<JointAngles> random_joints(std::size_t count) {
  std::mt19937_64 random(1);
  std::vector<JointAngles> all(count);
  for (JointAngles& q : all) {
    for (std::size_t i = 0; i < kJoints; ++i) {
      const Joint& joint = irb4600().joints()[i];
      q[static_cast<int>(i)] = std::uniform_real_distribution(joint.min_rad, joint.max_rad)(random);
    }
  }
  return all;
}

// All eight solutions.
void ArmInverse(benchmark::State& state) {
  std::vector<Eigen::Isometry3d> flanges;
  for (const JointAngles& q : random_joints(1000)) flanges.push_back(forward(irb4600(), q));
  for (auto _ : state) {
    for (const Eigen::Isometry3d& flange : flanges) benchmark::DoNotOptimize(inverse(irb4600(), flange));
  }
  state.SetItemsProcessed(state.iterations() * 1000);
}
BENCHMARK(ArmInverse);

// One solution from 0.3 rad away; `solved` is the share that is found.
void ArmInverseKdlPeer(benchmark::State& state) {
  const auto vector = [](const Eigen::Vector3d& v) { return KDL::Vector(v.x(), v.y(), v.z()); };
  KDL::Chain chain;
  for (const Joint& joint : irb4600().joints()) {
    chain.addSegment(
        KDL::Segment(KDL::Joint("j", vector(joint.point_mm / 1000), vector(joint.axis), KDL::Joint::RotAxis),
                     KDL::Frame::Identity()));
  }
  chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None),
                                KDL::Frame(vector(irb4600().flange_at_zero().translation() / 1000))));
  KDL::ChainIkSolverPos_LMA solver(chain);
  std::vector<KDL::Frame> frames;
  std::vector<KDL::JntArray> starts;
  for (const JointAngles& q : random_joints(100)) {
    KDL::JntArray start(6);
    for (unsigned i = 0; i < 6; ++i) start(i) = q[static_cast<int>(i)] + (i % 2 == 0 ? 0.3 : -0.3);
    starts.push_back(start);
    KDL::Frame frame = KDL::Frame::Identity();
    for (unsigned i = 0; i < 6; ++i) frame = frame * chain.getSegment(i).pose(q[static_cast<int>(i)]);
    frames.push_back(frame * chain.getSegment(6).pose(0));
  }
  std::size_t solved = 0, asked = 0;
  for (auto _ : state) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
      KDL::JntArray found(6);
      solved += solver.CartToJnt(starts[i], frames[i], found) >= 0 ? 1 : 0;
      ++asked;
    }
  }
  state.counters["solved"] = static_cast<double>(solved) / static_cast<double>(asked);
  state.SetItemsProcessed(static_cast<std::int64_t>(asked));
}
BENCHMARK(ArmInverseKdlPeer);

// 2,000 poses, two arms, two ways round, eight branches each.
void ArmPath(benchmark::State& state) {
  std::vector<Eigen::Isometry3d> flanges;
  for (int i = 0; i < 2000; ++i) {
    const double s = i / 1999.0;
    const JointAngles q =
        (JointAngles() << 0.8 * s - 0.4, 0.3 * s, 0.2 - 0.3 * s, 0.5 * s, 0.7 + 0.2 * s, -s).finished();
    flanges.push_back(forward(irb4600(), q));
  }
  for (auto _ : state) {
    for (int arm_and_flip = 0; arm_and_flip < 4; ++arm_and_flip) {
      for (const BranchPath& path : follow_branches(irb4600(), flanges)) {
        if (path.size() < flanges.size()) continue;
        benchmark::DoNotOptimize(fit_turns(irb4600(), path));
        benchmark::DoNotOptimize(path_margins(irb4600(), path));
      }
    }
  }
}
BENCHMARK(ArmPath)->Unit(benchmark::kMillisecond);

// A strip of 2,000 poses, slow enough for every joint.
hotblade::pipeline::Program slow_strip() {
  hotblade::pipeline::Program program = hotblade::pipeline::testing::vault_program({.poses = 2000});
  program.settings.machine.envelope_mm = {4000, 4000, 3000};
  return program;
}

// Five heights, both ways of holding the blade; the grid of the search as a cell has it by default.
void PlaceHeights(benchmark::State& state, const char* name) {
  namespace pipeline = hotblade::pipeline;
  const Cell cell = pipeline::read_cell(name);
  const pipeline::Program program = slow_strip();
  for (auto _ : state) {
    const pipeline::PlaceScorer score(program.strips.front(), cell);
    for (const pipeline::ArmPlace& place : pipeline::heights(cell.place))
      benchmark::DoNotOptimize(score(place));
  }
}
BENCHMARK_CAPTURE(PlaceHeights, two_irb4600, "two_irb4600")->Unit(benchmark::kMillisecond);

void PlaceGrid(benchmark::State& state, const char* name) {
  namespace pipeline = hotblade::pipeline;
  const Cell cell = pipeline::read_cell(name);
  const pipeline::Program program = slow_strip();
  std::size_t places = 0, reached = 0;
  for (auto _ : state) {
    const pipeline::PlaceScorer score(program.strips.front(), cell);
    places = reached = 0;
    for (const pipeline::ArmPlace& place : pipeline::grid(cell.place)) {
      ++places;
      if (score(place) > 0) ++reached;
    }
  }
  state.counters["places"] = static_cast<double>(places);
  state.counters["reached"] = static_cast<double>(reached);
}
BENCHMARK_CAPTURE(PlaceGrid, two_irb4600, "two_irb4600")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(PlaceGrid, two_kr50, "two_kr50")->Unit(benchmark::kMillisecond);

// The strip as both arms of a cell serve it, and what stands around it.
struct ArmedStrip {
  Cell cell;
  std::vector<Standing> standing;
  CellPath path;
};

ArmedStrip armed_strip(const char* name) {
  namespace pipeline = hotblade::pipeline;
  ArmedStrip armed{pipeline::read_cell(name), {}, {}};
  const pipeline::ArmedProgram served = pipeline::with_arms(slow_strip(), armed.cell);
  if (!served.report.refusals.empty()) throw std::runtime_error(describe(served.report.refusals.front()));
  const pipeline::Strip& strip = served.program.strips.front();
  pipeline::HeldJoints held;
  const std::size_t a = armed.cell.arms[0].id == strip.arms->a.arm ? 0 : 1;
  held.arm = {a, 1 - a};
  for (const pipeline::ClampJoints& joints : strip.joints) {
    held.joints[0].emplace_back(Eigen::Map<const JointAngles>(joints.a.data()));
    held.joints[1].emplace_back(Eigen::Map<const JointAngles>(joints.b.data()));
  }
  armed.path = pipeline::cell_path(strip, served.program.blade, held);
  armed.standing = pipeline::surroundings(strip, armed.cell);
  return armed;
}

void Clearance(benchmark::State& state, const char* name) {
  const ArmedStrip armed = armed_strip(name);
  std::size_t asked = 0;
  for (auto _ : state) {
    const hotblade::robot::Clearance clear = prove_clear(armed.cell, armed.standing, armed.path);
    if (clear.worst) state.SkipWithError("not clear");
    asked = clear.asked;
  }
  state.counters["asked"] = static_cast<double>(asked);
}
BENCHMARK_CAPTURE(Clearance, two_irb4600, "two_irb4600")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Clearance, two_kr50, "two_kr50")->Unit(benchmark::kMillisecond);

// Every pose, nothing proved between.
void ClearanceSampledPeer(benchmark::State& state, const char* name) {
  const ArmedStrip armed = armed_strip(name);
  std::size_t asked = 0;
  for (auto _ : state) asked = sampled_clearance(armed.cell, armed.standing, armed.path, 1).asked;
  state.counters["asked"] = static_cast<double>(asked);
}
BENCHMARK_CAPTURE(ClearanceSampledPeer, two_irb4600, "two_irb4600")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ClearanceSampledPeer, two_kr50, "two_kr50")->Unit(benchmark::kMillisecond);

}  // namespace
