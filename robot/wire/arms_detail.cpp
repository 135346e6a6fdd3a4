// What a controller says of arms, in words.
#include <charconv>
#include <cmath>

#include "robot/wire/protocol.hpp"

namespace hotblade::robot::protocol {
namespace {

constexpr std::uint8_t kTool = 7;

std::string number(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::general, 4).ptr;
  return {text, end};
}

std::string arm_name(std::uint8_t arm, const std::array<std::string, 2>& names) {
  const std::string& given = arm >= 1 && arm <= names.size() ? names[arm - 1u] : names[0];
  return "arm " + (given.empty() || arm < 1 || arm > names.size() ? std::to_string(arm) : given);
}

std::string link_name(std::uint8_t link) {
  if (link == kTool) return "tool";
  return link == 0 ? "base" : "link " + std::to_string(link);
}

// What is no link of an arm.
std::string thing_name(ArmsOther thing) {
  switch (thing) {
    case ArmsOther::kBlade:
      return "the blade";
    case ArmsOther::kTable:
      return "the table";
    case ArmsOther::kObstacle:
      return "an obstacle";
    case ArmsOther::kBlock:
      return "the block";
    case ArmsOther::kPlinth:
      return "the plinth";
    default:
      return "something";
  }
}

std::string first_name(const ArmsDetail& detail, const std::array<std::string, 2>& names) {
  if (detail.arm == 0) return thing_name(static_cast<ArmsOther>(detail.part));
  return arm_name(detail.arm, names) + " " + link_name(detail.part);
}

std::string other_name(const ArmsDetail& detail, const std::array<std::string, 2>& names) {
  if (detail.other == ArmsOther::kOtherArm)
    return arm_name(static_cast<std::uint8_t>(3 - detail.arm), names) + " " + link_name(detail.other_part);
  if (detail.other == ArmsOther::kItself) return "its own " + link_name(detail.other_part);
  return thing_name(detail.other);
}

constexpr double kMillionth = 1e-6, kThousandth = 1e-3, kDegrees = 180 / 3.14159265358979323846;

}  // namespace

std::string describe(const ArmsDetail& detail, Limit limit, const std::array<std::string, 2>& arm_names) {
  if (detail == ArmsDetail{}) return "";
  const double rad = detail.amount * kMillionth, mm = detail.amount * kThousandth;
  const std::string arm = arm_name(detail.arm, arm_names), part = std::to_string(detail.part);
  switch (limit) {
    case Limit::kArmReach:
      return arm + " " + number(mm) + " mm short";
    case Limit::kJointAngle:
      return arm + " joint " + part + ", " + number(rad * kDegrees) + " degrees over";
    case Limit::kJointSpeed:
      return arm + " joint " + part + ", " + number(rad) + " rad/s over";
    case Limit::kJointAcceleration:
      return arm + " joint " + part + ", " + number(rad) + " rad/s2 over";
    case Limit::kNearSingular:
      if (detail.part == 1) return arm + " shoulder, " + number(mm) + " mm too near to axis 1";
      return arm + (detail.part == 3 ? " elbow, " : " wrist, ") + number(rad * kDegrees) +
             " degrees too near";
    case Limit::kConfiguration:
      return arm + (detail.part == 1 ? " shoulder" : detail.part == 3 ? " elbow" : " wrist");
    case Limit::kArmClearance:
      return first_name(detail, arm_names) + " and " + other_name(detail, arm_names) + ", " + number(mm) +
             " mm too near";
    case Limit::kJointJerk:
      if (detail.arm > 0) return arm + " joint " + part + ", " + number(rad) + " rad/s3 over";
      return std::string("clamp ") + (detail.part == 1 ? "A" : "B") + ", " +
             (detail.other == ArmsOther::kNothing ? number(mm) + " mm/s3 over"
                                                  : number(rad) + " rad/s3 over");
    default:
      return "";
  }
}

}  // namespace hotblade::robot::protocol
