// An arm of six turning axes whose last three meet in a point: where its flange is for given joints, and all
// joints for a given flange.
//
// Axes are lines in base_link at joint angles of zero, as the maker's model has them, so that no maker's
// offsets or signs enter. The inverse takes the arm apart into rotations about these lines (Paden and Kahan's
// subproblems; Elias and Wen, IK-Geo, 2022): atan2 everywhere, never acos or sqrt(1 - c^2), so that digits
// stay at singularities. mm, rad.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <numbers>
#include <string>
#include <vector>

namespace hotblade::robot {

// One degree, rad. Files and messages have degrees; everything else has rad.
inline constexpr double kDegree_rad = std::numbers::pi / 180;

inline constexpr std::size_t kJoints = 6;
using JointAngles = Eigen::Matrix<double, static_cast<int>(kJoints), 1>;

// A turning axis at joint angles of zero, and what its joint may do.
struct Joint {
  std::string name;
  Eigen::Vector3d axis{0, 0, 1};      // unit
  Eigen::Vector3d point_mm{0, 0, 0};  // on the axis
  double min_rad = 0, max_rad = 0;
  double speed_rad_s = 0;
};

// How far a pair of axes is from what the closed form takes.
struct AxisError {
  enum class Relation { kParallel, kSquare, kMeeting };
  std::size_t first = 0, second = 0;  // index of the joints
  Relation relation = Relation::kParallel;
  double angle_rad = 0;    // from parallel or square
  double distance_mm = 0;  // between axes that should meet
};

// Returns what the closed form takes: 2 and 3 parallel; 1 square to 2, 3 to 4, 4 to 5, 5 to 6; 5 meets 4, and
// 6 meets both in that point.
[[nodiscard]] std::vector<AxisError> axis_errors(const std::array<Joint, kJoints>& joints);

// Errors up to which the closed form is taken as it is, and up to which it starts Newton steps on the true
// axes: files write angles with four digits or lengths in hundredths. Beyond, it is another kind of arm.
inline constexpr double kExactAxis_rad = 1e-9, kExactAxis_mm = 1e-6;
inline constexpr double kRoundedAxis_rad = 1e-4, kRoundedAxis_mm = 0.1;

// Lengths as data sheets have them (Brandstoetter, Angerer, Hofbaur 2014), without signs, mm: a1 from axis 1
// to axis 2, a2 from axis 3 to axis 4, b of the wrist beside axis 1; c1 height of axis 2, c2 from axis 2 to
// axis 3, c3 along axis 4 to the wrist, c4 from the wrist to the flange.
struct ArmLengths {
  double a1 = 0, a2 = 0, b = 0, c1 = 0, c2 = 0, c3 = 0, c4 = 0;
};

class Arm {
 public:
  // Throws std::logic_error for axes beyond the rounded bounds, for axes 2 and 3 in one line, and for a wrist
  // on axis 3.
  Arm(std::string name, const std::array<Joint, kJoints>& joints, const Eigen::Isometry3d& flange_at_zero);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::array<Joint, kJoints>& joints() const { return joints_; }
  [[nodiscard]] const Eigen::Isometry3d& flange_at_zero() const { return flange_; }
  // Where axes 4, 5 and 6 meet at zero.
  [[nodiscard]] const Eigen::Vector3d& wrist_at_zero() const { return wrist_; }
  // Whether the closed form needs no Newton steps.
  [[nodiscard]] bool exact() const { return exact_; }
  [[nodiscard]] ArmLengths lengths() const;

  // The arm with other limits. Throws std::logic_error where a least angle is not below the largest.
  [[nodiscard]] Arm with_limits(const JointAngles& min_rad, const JointAngles& max_rad) const;

 private:
  std::string name_;
  std::array<Joint, kJoints> joints_;
  Eigen::Isometry3d flange_;
  Eigen::Vector3d wrist_;
  bool exact_ = true;
};

// Returns the motion that a turn about a line is.
[[nodiscard]] Eigen::Isometry3d turn_about(const Eigen::Vector3d& axis, const Eigen::Vector3d& point_mm,
                                           double angle_rad);

// Returns the motions of base_link and links 1 to 6 from where they are at zero.
[[nodiscard]] std::array<Eigen::Isometry3d, kJoints + 1> link_motions(const Arm& arm, const JointAngles& q);

// Returns the flange (tool0) in base_link.
[[nodiscard]] Eigen::Isometry3d forward(const Arm& arm, const JointAngles& q);

// Which of two roots each subproblem takes. Along a path on which no root is double it stays the same: an arm
// changes it in a singularity only. Bits 2, 1, 0 of the index are shoulder, elbow, wrist.
inline constexpr std::size_t kBranches = 8;
// Returns 1 or -1 for shoulder, elbow and wrist.
[[nodiscard]] std::array<int, 3> branch_signs(std::size_t branch);

// All joints that bring the flange to one place, by branch; angles in (-pi, pi], whatever the limits.
struct Solutions {
  std::array<JointAngles, kBranches> q;
  std::array<bool, kBranches> there{};
};

// Returns all solutions. With the wrist straight only the sum of joints 4 and 6 counts; joint 4 is zero then.
[[nodiscard]] Solutions inverse(const Arm& arm, const Eigen::Isometry3d& flange);

// How far the wrist's centre would have to be from axis 2, and how near it may be, in the plane square to it.
// `from_axis_1_mm` less than its bound means that the wrist is too near to axis 1.
struct Reach {
  double from_axis_2_mm = 0, least_mm = 0, most_mm = 0;
  double from_axis_1_mm = 0, least_from_axis_1_mm = 0;
};
// Returns it for the shoulder that comes nearest.
[[nodiscard]] Reach reach(const Arm& arm, const Eigen::Isometry3d& flange);

// How far from singular: the Jacobian's determinant is sin(wrist) sin(elbow) shoulder times a constant, so
// nothing else can be.
struct SingularityDistances {
  double wrist_rad = 0;    // between axes 4 and 6
  double elbow_rad = 0;    // from stretched or folded
  double shoulder_mm = 0;  // of the wrist's centre from axis 1, the part square to axis 2
};
[[nodiscard]] SingularityDistances singularity_distances(const Arm& arm, const JointAngles& q);

}  // namespace hotblade::robot
