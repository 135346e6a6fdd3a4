#include "robot/arm/urdf_elements.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <map>
#include <set>
#include <sstream>
#include <string_view>

#include "robot/arm/model_file.hpp"
#include "robot/arm/stl.hpp"

namespace hotblade::robot {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using tinyxml2::XMLElement;

// No link is so long; a number beyond is in millimetres or a slip.
constexpr double kLongest_m = 100;
constexpr double kMostSpeed_rad_s = 100, kMostFactor = 1000;
// Wrists of makers turn by two turns or three either way, and what turns on is continuous; an arm in degrees
// has some limit beyond, which would be 31 degrees.
constexpr double kMostAngle_rad = 5 * 2 * M_PI;
// A joint without limits may turn so often either way, more than any program asks for.
constexpr double kContinuous_rad = 100 * 2 * M_PI;
// Axes are written with five digits or more; a shorter or longer one has a slip in it.
constexpr double kUnitSlack = 1e-3;
constexpr double kMmPerM = 1000;

class Elements {
 public:
  Elements(const std::string& name, const std::filesystem::path& folder) : name_(name), folder_(folder) {}

  UrdfElements read(const std::string& text) {
    if (text.size() > kMostTextBytes) {
      throw ModelError(name_ + ": " + std::to_string(text.size()) + " bytes, " +
                       std::to_string(kMostTextBytes) + " at most: is this a robot's description?");
    }
    tinyxml2::XMLDocument document;
    if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
      fail(document.ErrorLineNum(), std::string("is no XML (") + document.ErrorName() + ")");
    const XMLElement* robot = document.RootElement();
    if (robot == nullptr) fail(1, "no <robot>");
    refuse_macros(*robot);
    if (std::string_view(robot->Name()) != "robot")
      fail(*robot, "<" + std::string(robot->Name()) + ">, must be <robot>");
    if (const XMLElement* next = robot->NextSiblingElement()) fail(*next, "a second element beside <robot>");
    UrdfElements found;
    found.robot = text_of(*robot, "name");
    found.line = robot->GetLineNum();
    for (const XMLElement* e = robot->FirstChildElement(); e != nullptr; e = e->NextSiblingElement())
      add(*e, found);
    for (const auto& [what, count] : ignored_) found.ignored.push_back(what + " x" + std::to_string(count));
    return found;
  }

 private:
  [[noreturn]] void fail(int line, const std::string& what) const {
    throw ModelError(name_ + ":" + std::to_string(line) + ": " + what);
  }
  [[noreturn]] void fail(const XMLElement& element, const std::string& what) const {
    fail(element.GetLineNum(), what);
  }

  void refuse_macros(const XMLElement& element) const {
    const auto macro = [](const char* text) {
      const std::string_view t = text == nullptr ? "" : text;
      return t.find("${") != std::string_view::npos || t.find("$(") != std::string_view::npos;
    };
    const auto named = [](const char* text) {
      return std::string_view(text).find("xacro") != std::string_view::npos;
    };
    bool found = named(element.Name()) || macro(element.GetText());
    for (const auto* a = element.FirstAttribute(); a != nullptr; a = a->Next())
      found = found || named(a->Name()) || macro(a->Value());
    if (found)
      fail(element,
           "<" + std::string(element.Name()) + "> has xacro in it: expand it first (xacro FILE > arm.urdf)");
    for (const XMLElement* e = element.FirstChildElement(); e != nullptr; e = e->NextSiblingElement())
      refuse_macros(*e);
  }

  void ignore(const XMLElement& element) { ++ignored_[element.Name()]; }

  void add(const XMLElement& element, UrdfElements& found) {
    const std::string_view what = element.Name();
    if (what == "link") {
      found.links.push_back(link(element));
    } else if (what == "joint") {
      found.joints.push_back(joint(element));
    } else if (what == "material" || what == "gazebo" || what == "transmission") {
      ignore(element);
    } else {
      fail(element, "<" + std::string(what) + "> is not read in <robot>");
    }
  }

  // ---- attributes ----

  void only(const XMLElement& element, std::initializer_list<std::string_view> names) const {
    for (const auto* a = element.FirstAttribute(); a != nullptr; a = a->Next()) {
      if (std::find(names.begin(), names.end(), a->Name()) == names.end())
        fail(a->GetLineNum(), "<" + std::string(element.Name()) + "> has no attribute " + a->Name());
    }
  }

  std::string text_of(const XMLElement& element, const char* attribute) const {
    const char* text = element.Attribute(attribute);
    if (text == nullptr || *text == 0)
      fail(element, "<" + std::string(element.Name()) + "> needs the attribute " + attribute);
    return text;
  }

  std::vector<double> numbers(const XMLElement& element, const char* attribute, std::size_t count) const {
    const std::string text = text_of(element, attribute);
    std::istringstream words(text);
    std::vector<double> values;
    for (std::string word; words >> word;) {
      double value = 0;
      const char* begin = word.data() + (word.front() == '+' ? 1 : 0);
      const auto [end, code] = std::from_chars(begin, word.data() + word.size(), value);
      if (code != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
        fail(element, said(element, attribute, text) + ": \"" + word + "\" is no number");
      values.push_back(value);
    }
    if (values.size() != count) {
      fail(element, said(element, attribute, text) + ": " + std::to_string(values.size()) +
                        " numbers, must be " + std::to_string(count));
    }
    return values;
  }

  static std::string said(const XMLElement& element, const char* attribute, const std::string& text) {
    return "<" + std::string(element.Name()) + "> " + attribute + "=\"" + text + "\"";
  }

  double number(const XMLElement& element, const char* attribute, double least, double most,
                const std::string& hint = "") const {
    const double value = numbers(element, attribute, 1).front();
    if (!(value >= least && value <= most)) {
      std::ostringstream range;
      range << least << " to " << most;
      fail(element,
           said(element, attribute, text_of(element, attribute)) + ": must be " + range.str() + hint);
    }
    return value;
  }

  double angle(const XMLElement& element, const char* attribute) const {
    return number(element, attribute, -kMostAngle_rad, kMostAngle_rad,
                  ": angles are in rad; a joint that turns on without end is continuous");
  }

  Vector3d vector(const XMLElement& element, const char* attribute, const Vector3d& absent,
                  double most) const {
    if (element.Attribute(attribute) == nullptr) return absent;
    const std::vector<double> v = numbers(element, attribute, 3);
    for (const double x : v) {
      if (std::abs(x) > most) {
        fail(element, said(element, attribute, text_of(element, attribute)) + ": over " +
                          std::to_string(static_cast<int>(most)) + ": lengths are in metres, angles in rad");
      }
    }
    return {v[0], v[1], v[2]};
  }

  // The only child of a name; null where there is none and it may be absent.
  const XMLElement* child(const XMLElement& element, const char* name, bool needed) const {
    const XMLElement* first = element.FirstChildElement(name);
    if (first == nullptr && needed)
      fail(element, "<" + std::string(element.Name()) + "> needs <" + name + ">");
    if (first == nullptr) return nullptr;
    if (const XMLElement* second = first->NextSiblingElement(name))
      fail(*second, "a second <" + std::string(name) + ">");
    return first;
  }

  Isometry3d origin(const XMLElement& parent) const {
    Isometry3d place = Isometry3d::Identity();
    const XMLElement* e = child(parent, "origin", false);
    if (e == nullptr) return place;
    only(*e, {"xyz", "rpy"});
    const Vector3d rpy = vector(*e, "rpy", Vector3d::Zero(), kMostAngle_rad);
    place.translation() = kMmPerM * vector(*e, "xyz", Vector3d::Zero(), kLongest_m);
    place.linear() =
        (Eigen::AngleAxisd(rpy.z(), Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Vector3d::UnitY()) *
         Eigen::AngleAxisd(rpy.x(), Vector3d::UnitX()))
            .toRotationMatrix();
    return place;
  }

  // ---- links ----

  UrdfLink link(const XMLElement& element) {
    only(element, {"name", "type"});
    UrdfLink found{text_of(element, "name"), element.GetLineNum(), {}};
    if (!link_names_.insert(found.name).second) fail(element, "a second link \"" + found.name + "\"");
    for (const XMLElement* e = element.FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
      const std::string_view what = e->Name();
      if (what == "collision") {
        found.shapes.push_back(shape(*e));
      } else if (what == "visual" || what == "inertial") {
        ignore(*e);
      } else {
        fail(*e, "<" + std::string(what) + "> is not read in <link>");
      }
    }
    return found;
  }

  Shape shape(const XMLElement& collision) const {
    for (const XMLElement* e = collision.FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
      const std::string_view what = e->Name();
      if (what != "origin" && what != "geometry")
        fail(*e, "<" + std::string(what) + "> is not read in <collision>");
    }
    const XMLElement& geometry = *child(collision, "geometry", true);
    const XMLElement* solid = geometry.FirstChildElement();
    if (solid == nullptr) fail(geometry, "<geometry> is empty");
    if (const XMLElement* second = solid->NextSiblingElement()) fail(*second, "a second shape in <geometry>");
    return {origin(collision), solid_of(*solid)};
  }

  std::variant<Box, Cylinder, Sphere, Mesh> solid_of(const XMLElement& e) const {
    constexpr double kLeast_m = 1e-6;
    const std::string_view what = e.Name();
    if (what == "box") {
      only(e, {"size"});
      (void)text_of(e, "size");
      const Vector3d size = vector(e, "size", Vector3d::Zero(), kLongest_m);
      if (size.minCoeff() < kLeast_m) fail(e, said(e, "size", e.Attribute("size")) + ": must be positive");
      return Box{kMmPerM * size};
    }
    if (what == "cylinder") {
      only(e, {"radius", "length"});
      return Cylinder{kMmPerM * number(e, "radius", kLeast_m, kLongest_m),
                      kMmPerM * number(e, "length", kLeast_m, kLongest_m)};
    }
    if (what == "sphere") {
      only(e, {"radius"});
      return Sphere{kMmPerM * number(e, "radius", kLeast_m, kLongest_m)};
    }
    if (what == "mesh") return mesh(e);
    fail(e, "<" + std::string(what) + "> is no shape: must be mesh, box, cylinder or sphere");
  }

  Mesh mesh(const XMLElement& e) const {
    only(e, {"filename", "scale"});
    const std::string file = text_of(e, "filename");
    const Vector3d scale = vector(e, "scale", Vector3d::Ones(), kMmPerM);
    if (!(scale.minCoeff() > 0)) fail(e, said(e, "scale", e.Attribute("scale")) + ": must be positive");
    if (file.find("://") != std::string::npos) {
      fail(e, said(e, "filename", file) +
                  ": must be a path beside the file: replace package://NAME/ by the way to it");
    }
    std::string ending = std::filesystem::path(file).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (ending != ".stl") fail(e, said(e, "filename", file) + ": must be a binary STL");
    try {
      return {file, read_stl(folder_ / file, scale)};
    } catch (const ModelError& error) {
      throw ModelError(name_ + ":" + std::to_string(e.GetLineNum()) + ": " + error.what(), error.missing);
    }
  }

  // ---- joints ----

  UrdfJoint joint(const XMLElement& element) {
    only(element, {"name", "type"});
    UrdfJoint found;
    found.name = text_of(element, "name");
    found.line = element.GetLineNum();
    if (!joint_names_.insert(found.name).second) fail(element, "a second joint \"" + found.name + "\"");
    for (const XMLElement* e = element.FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
      static constexpr std::string_view kRead[] = {"origin", "parent",           "child", "axis", "limit",
                                                   "mimic",  "safety_controller"};
      static constexpr std::string_view kIgnored[] = {"dynamics", "calibration"};
      if (std::find(std::begin(kIgnored), std::end(kIgnored), e->Name()) != std::end(kIgnored)) {
        ignore(*e);
      } else if (std::find(std::begin(kRead), std::end(kRead), e->Name()) == std::end(kRead)) {
        fail(*e, "<" + std::string(e->Name()) + "> is not read in <joint>");
      }
    }
    found.origin = origin(element);
    found.parent = link_of(element, "parent");
    found.child = link_of(element, "child");
    const std::string type = text_of(element, "type");
    if (type == "fixed") return found;
    if (type != "revolute" && type != "continuous")
      fail(element, "joint \"" + found.name + "\" is " + type + ", must be revolute, continuous or fixed");
    found.kind = UrdfJointKind::kTurning;
    found.axis = axis(element);
    read_limit(element, type == "revolute", found);
    read_mimic(element, found);
    return found;
  }

  std::string link_of(const XMLElement& joint, const char* which) const {
    const XMLElement& e = *child(joint, which, true);
    only(e, {"link"});
    return text_of(e, "link");
  }

  Vector3d axis(const XMLElement& joint) const {
    const XMLElement* e = child(joint, "axis", false);
    if (e == nullptr) return Vector3d::UnitX();
    only(*e, {"xyz"});
    (void)text_of(*e, "xyz");
    const Vector3d u = vector(*e, "xyz", Vector3d::UnitX(), kLongest_m);
    if (!(std::abs(u.norm() - 1) <= kUnitSlack))
      fail(*e, said(*e, "xyz", e->Attribute("xyz")) + ": must have length 1");
    return u.normalized();
  }

  void read_limit(const XMLElement& joint, bool limited, UrdfJoint& found) const {
    const XMLElement& e = *child(joint, "limit", true);
    only(e, {"lower", "upper", "velocity", "effort"});
    found.speed_rad_s = number(e, "velocity", 1e-3, kMostSpeed_rad_s);
    found.min_rad = limited ? angle(e, "lower") : -kContinuous_rad;
    found.max_rad = limited ? angle(e, "upper") : kContinuous_rad;
    if (!(found.min_rad < found.max_rad)) fail(e, "joint \"" + found.name + "\": lower is not below upper");
    read_soft_limits(joint, found);
  }

  // Where the arm's controller holds a joint back before its limit: of both the narrower counts.
  void read_soft_limits(const XMLElement& joint, UrdfJoint& found) const {
    const XMLElement* e = child(joint, "safety_controller", false);
    if (e == nullptr) return;
    only(*e, {"soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity"});
    if (e->Attribute("soft_lower_limit") != nullptr)
      found.min_rad = std::max(found.min_rad, angle(*e, "soft_lower_limit"));
    if (e->Attribute("soft_upper_limit") != nullptr)
      found.max_rad = std::min(found.max_rad, angle(*e, "soft_upper_limit"));
    if (!(found.min_rad < found.max_rad))
      fail(*e, "joint \"" + found.name + "\": soft and hard limits leave no range to turn in");
  }

  void read_mimic(const XMLElement& joint, UrdfJoint& found) const {
    const XMLElement* e = child(joint, "mimic", false);
    if (e == nullptr) return;
    only(*e, {"joint", "multiplier", "offset"});
    UrdfMimic mimic{text_of(*e, "joint"), 1, 0, e->GetLineNum()};
    if (e->Attribute("multiplier") != nullptr)
      mimic.factor = number(*e, "multiplier", -kMostFactor, kMostFactor);
    if (e->Attribute("offset") != nullptr) mimic.offset_rad = angle(*e, "offset");
    found.mimic = mimic;
  }

  const std::string& name_;
  const std::filesystem::path& folder_;
  std::map<std::string, std::size_t> ignored_;
  std::set<std::string> link_names_, joint_names_;
};

}  // namespace

UrdfElements parse_urdf_elements(const std::string& text, const std::string& name,
                                 const std::filesystem::path& folder) {
  return Elements(name, folder).read(text);
}

}  // namespace hotblade::robot
