// Descriptions of arms: against another reader, against data sheets, and broken.
#include "robot/arm/urdf.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <urdf_parser/urdf_parser.h>

#include <cmath>
#include <cstring>
#include <fstream>

#include "robot/arm/model_file.hpp"
#include "robot/arm/stl.hpp"
#include "tests/pipeline/temporary_directory.hpp"
#include "tests/robot/arm/arms.hpp"

namespace hotblade::robot {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using ::testing::HasSubstr;

TEST(Urdf, LengthsAreThoseOfTheDataSheet) {
  const auto expect = [](const ArmModel& model, const std::array<double, 7>& sheet, const Vector3d& home) {
    const ArmLengths l = model.arm.lengths();
    const std::array<double, 7> found{l.a1, l.a2, l.b, l.c1, l.c2, l.c3, l.c4};
    for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(found[i], sheet[i], 1e-6) << model.arm.name() << " " << i;
    EXPECT_LE((model.arm.flange_at_zero().translation() - home).norm(), 1e-6) << model.arm.name();
    EXPECT_TRUE(model.arm.exact());
  };
  for (const auto& file : arm_files()) {
    if (file.string().find("abb") != std::string::npos) {
      expect(read_urdf(file), {175, 175, 0, 495, 1095, 1270, 135}, {1580, 0, 1765});
    } else {
      expect(read_urdf(file), {175, 50, 0, 575, 1290, 1035, 185}, {2685, 0, 625});
    }
  }
}

Isometry3d pose_of(const urdf::Pose& pose) {
  Isometry3d place = Isometry3d::Identity();
  double x = 0, y = 0, z = 0, w = 1;
  pose.rotation.getQuaternion(x, y, z, w);
  place.linear() = Eigen::Quaterniond(w, x, y, z).toRotationMatrix();
  place.translation() = 1000 * Vector3d(pose.position.x, pose.position.y, pose.position.z);
  return place;
}

Isometry3d at_zero(const urdf::ModelInterface& model, const std::string& link) {
  Isometry3d place = Isometry3d::Identity();
  for (auto l = model.getLink(link); l->parent_joint && l->name != "base_link"; l = l->getParent())
    place = pose_of(l->parent_joint->parent_to_joint_origin_transform) * place;
  return place;
}

TEST(Urdf, AgreesWithUrdfdom) {
  for (const auto& file : arm_files()) {
    const ArmModel ours = read_urdf(file);
    const auto theirs = urdf::parseURDFFile(file.string());
    ASSERT_TRUE(theirs) << file;
    for (const Joint& joint : ours.arm.joints()) {
      const auto other = theirs->getJoint(joint.name);
      const Isometry3d at = at_zero(*theirs, other->child_link_name);
      EXPECT_LE((at.linear() * Vector3d(other->axis.x, other->axis.y, other->axis.z) - joint.axis).norm(),
                1e-12);
      EXPECT_LE((at.translation() - joint.point_mm).norm(), 1e-9) << joint.name;
      EXPECT_EQ(other->limits->lower, joint.min_rad);
      EXPECT_EQ(other->limits->upper, joint.max_rad);
      EXPECT_EQ(other->limits->velocity, joint.speed_rad_s);
    }
    const Isometry3d flange = at_zero(*theirs, "tool0");
    EXPECT_LE((flange.matrix() - ours.arm.flange_at_zero().matrix()).norm(), 1e-9);
    for (const Body& body : ours.bodies) {
      const auto& collisions = theirs->getLink(body.link)->collision_array;
      ASSERT_EQ(collisions.size(), body.shapes.size()) << body.link;
      for (std::size_t i = 0; i < body.shapes.size(); ++i) {
        const Isometry3d place = at_zero(*theirs, body.link) * pose_of(collisions[i]->origin);
        EXPECT_LE((place.matrix() - body.shapes[i].place.matrix()).norm(), 1e-9) << file << body.link;
      }
    }
  }
}

TEST(Urdf, TheMakersFilesAreRead) {
  for (const char* name : kShippedArms) {
    if (!std::filesystem::exists(makers_arm(name)))
      GTEST_SKIP() << "no files of the makers: " << makers_arm(name);
    const ArmModel makers = read_urdf(makers_arm(name)), own = read_urdf(shipped_arm(name));
    ASSERT_EQ(makers.bodies.size(), 7U);
    for (std::size_t i = 0; i < makers.bodies.size(); ++i) {
      EXPECT_EQ(makers.bodies[i].moved_by, own.bodies[i].moved_by);
      EXPECT_TRUE(std::holds_alternative<Mesh>(makers.bodies[i].shapes.front().solid));
    }
    for (std::size_t i = 0; i < kJoints; ++i) {
      const Joint &a = makers.arm.joints()[i], &b = own.arm.joints()[i];
      EXPECT_LE((a.axis - b.axis).norm(), 1e-12) << name << i;
      EXPECT_LE((a.point_mm - b.point_mm).cross(a.axis).norm(), 1e-9) << name << i;
      EXPECT_EQ(a.min_rad, b.min_rad);
      EXPECT_EQ(a.max_rad, b.max_rad);
      EXPECT_EQ(a.speed_rad_s, b.speed_rad_s);
    }
    EXPECT_LE((makers.arm.flange_at_zero().matrix() - own.arm.flange_at_zero().matrix()).norm(), 1e-9);
  }
}

// How deep a point is in the deepest of a body's shapes.
double depth_in(const Body& body, const Vector3d& point) {
  double depth = -1e9;
  for (const Shape& shape : body.shapes) depth = std::max(depth, depth_mm(shape, point));
  return depth;
}

TEST(ShippedArms, EncloseTheMakersMeshes) {
  for (const char* name : kShippedArms) {
    if (!std::filesystem::exists(makers_arm(name)))
      GTEST_SKIP() << "no files of the makers: " << makers_arm(name);
    const ArmModel makers = read_urdf(makers_arm(name)), own = read_urdf(shipped_arm(name));
    for (std::size_t i = 0; i < makers.bodies.size(); ++i) {
      double slack = 0, least = 1e9;
      std::size_t corners = 0;
      for (const Shape& shape : makers.bodies[i].shapes) {
        for (const auto& triangle : std::get<Mesh>(shape.solid).triangles) {
          std::array<Vector3d, 3> at;
          for (std::size_t k = 0; k < 3; ++k) at[k] = shape.place * triangle[k];
          for (const Vector3d& corner : at) {
            const double depth = depth_in(own.bodies[i], corner);
            slack += depth;
            least = std::min(least, depth);
            ++corners;
          }
          // Faces between the corners: 4 mm apart or nearer in a triangle of 100 mm.
          constexpr int kSteps = 25;
          for (int u = 0; u <= kSteps; ++u) {
            for (int v = 0; u + v <= kSteps; ++v) {
              const Vector3d p = (u * at[0] + v * at[1] + (kSteps - u - v) * at[2]) / kSteps;
              least = std::min(least, depth_in(own.bodies[i], p));
            }
          }
        }
      }
      slack /= static_cast<double>(corners);
      EXPECT_GE(least, 0) << name << " " << own.bodies[i].link;
      EXPECT_LE(slack, 25) << name << " " << own.bodies[i].link;
      std::printf("%s %s: %zu shapes, nearest %.1f mm inside, %.1f mm on average\n", name,
                  own.bodies[i].link.c_str(), own.bodies[i].shapes.size(), least, slack);
    }
  }
}

// ---- broken files ----

std::string own_text() {
  return read_model_file(shipped_arm("abb_irb4600_40_255"));
}

// The text with the first `from` replaced; the test fails where there is none.
std::string with(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

int line_of(const std::string& text, const std::string& part) {
  const auto at = text.find(part);
  EXPECT_NE(at, std::string::npos) << part;
  return 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

struct Broken {
  std::string name, from, to, line_at, says;
};

class BrokenUrdf : public ::testing::TestWithParam<Broken> {};

TEST_P(BrokenUrdf, RefusesWithTheLine) {
  const Broken& broken = GetParam();
  const std::string text = with(own_text(), broken.from, broken.to);
  const std::string place = "arm.urdf:" + std::to_string(line_of(text, broken.line_at)) + ": ";
  try {
    (void)parse_urdf(text, "arm.urdf", {});
    FAIL() << "it was taken";
  } catch (const ModelError& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with(place)) << error.what() << " at " << place;
    EXPECT_THAT(error.what(), HasSubstr(broken.says));
  }
}

const std::string kJoint3 = R"(<joint name="joint_3" type="revolute">)";
const std::string kLimit3 = R"(<limit lower="-3.141592653589793" upper="1.3089969389957472")";

INSTANTIATE_TEST_SUITE_P(
    Urdf, BrokenUrdf,
    ::testing::Values(
        Broken{"swapped_axis", R"(<child link="link_5"/>
    <axis xyz="0 1 0"/>)",
               R"(<child link="link_5"/>
    <axis xyz="1 0 0"/>)",
               R"(<joint name="joint_5")", "joint_5 axis is 90 deg from square to joint_4"},
        Broken{"tilted_axis", R"(<child link="link_3"/>
    <axis xyz="0 1 0"/>)",
               R"(<child link="link_3"/>
    <axis xyz="0 0.99999 0.001"/>)",
               kJoint3, "from parallel to joint_2, 0.0057 at most"},
        Broken{"wrist_apart", R"(<origin xyz="0.135 0 0"/>)", R"(<origin xyz="0.135 0.003 0"/>)",
               R"(<joint name="joint_6")", "joint_6 axis is 3 mm from meeting joint_5, 0.1 at most"},
        Broken{"three_parallel", R"(<child link="link_4"/>
    <axis xyz="1 0 0"/>)",
               R"(<child link="link_4"/>
    <axis xyz="0 1 0"/>)",
               R"(<joint name="joint_4")", "spherical wrist"},
        Broken{"in_one_line", R"(<origin xyz="0 0 1.095"/>)", R"(<origin xyz="0 0 0"/>)", kJoint3,
               "in one line"},
        Broken{"no_xml", "</robot>", "</robat>", "<robot name", "is no XML"},
        Broken{"xacro_element", "<link name=\"tool0\"/>", "<xacro:tool name=\"a\"/>", "<xacro:tool",
               "expand it first"},
        Broken{"xacro_value", R"(lower="-3.141592653589793" upper="1.3)", R"(lower="${-pi}" upper="1.3)",
               "lower=\"${-pi}\"", "expand it first"},
        Broken{"unknown_element", "<link name=\"tool0\"/>", "<link name=\"tool0\"/><sensor/>", "<sensor/>",
               "<sensor> is not read in <robot>"},
        Broken{"unknown_in_link", "<link name=\"tool0\"/>", "<link name=\"tool0\"><shape/></link>",
               "<shape/>", "<shape> is not read in <link>"},
        Broken{"unknown_in_joint", kJoint3, kJoint3 + "<limits/>", "<limits/>",
               "<limits> is not read in <joint>"},
        Broken{"unknown_attribute", R"(<limit lower="-3.141592653589793" upper="1.3)",
               R"(<limit low="-3.141592653589793" upper="1.3)", "<limit low=", "has no attribute low"},
        Broken{"no_lower", kLimit3, R"(<limit upper="1.3089969389957472")",
               R"(<limit upper="1.3089969389957472")", "needs the attribute lower"},
        Broken{"lower_over_upper", kLimit3, R"(<limit lower="3" upper="1.3089969389957472")",
               R"(<limit lower="3")", "lower is not below upper"},
        Broken{"not_a_number", kLimit3, R"(<limit lower="-3,14" upper="1.3")", R"(lower="-3,14")",
               "is no number"},
        Broken{"nan", kLimit3, R"(<limit lower="nan" upper="1.3")", R"(lower="nan")", "is no number"},
        Broken{"in_degrees", kLimit3, R"(<limit lower="-1800" upper="1.3")", R"(lower="-1800")", "must be"},
        Broken{"few_degrees", kLimit3, R"(<limit lower="-90" upper="1.3")", R"(lower="-90")",
               "must be -31.4159 to 31.4159: angles are in rad"},
        Broken{"turned_in_degrees", R"(<origin xyz="0 0 1.095"/>)",
               R"(<origin xyz="0 0 1.095" rpy="0 90 0"/>)", R"(rpy="0 90 0")", "angles in rad"},
        Broken{"soft_in_degrees", kJoint3, kJoint3 + R"(<safety_controller soft_upper_limit="60"/>)",
               "<safety_controller", "angles are in rad"},
        Broken{"soft_leaves_nothing", kJoint3, kJoint3 + R"(<safety_controller soft_lower_limit="1.4"/>)",
               "<safety_controller", "leave no range to turn in"},
        Broken{"soft_unknown", kJoint3, kJoint3 + R"(<safety_controller soft_lower="0"/>)",
               "<safety_controller", "has no attribute soft_lower"},
        Broken{"no_speed", R"(upper="1.3089969389957472" effort="0" velocity="3.0543261909900767")",
               R"(upper="1.3089969389957472" effort="0" velocity="0")",
               R"(upper="1.3089969389957472" effort="0" velocity="0")", "velocity"},
        Broken{
            "no_limit",
            R"(<limit lower="-3.141592653589793" upper="1.3089969389957472" effort="0" velocity="3.0543261909900767"/>)",
            "", kJoint3, "needs <limit>"},
        Broken{"prismatic", kJoint3, R"(<joint name="joint_3" type="prismatic">)",
               R"(<joint name="joint_3" type="prismatic">)",
               "is prismatic, must be revolute, continuous or fixed"},
        Broken{"fixed_of_six", kJoint3, R"(<joint name="joint_3" type="fixed">)", "<link name=\"tool0\"/>",
               "5 turning joints between base_link and tool0, must be six"},
        Broken{"no_tool0", "<link name=\"tool0\"/>", "<link name=\"tool\"/>", "<joint name=\"flange\"",
               "names no link: \"tool0\""},
        Broken{"two_parents", R"(<child link="link_4"/>)", R"(<child link="link_3"/>)",
               R"(<joint name="joint_4")", "is the child of"},
        Broken{"circle", R"(<parent link="base_link"/>)", R"(<parent link="link_6"/>)",
               "<link name=\"tool0\"/>", "tool0 does not hang on base_link"},
        Broken{"second_link", "<link name=\"tool0\"/>", "<link name=\"tool0\"/>\n<link name=\"link_3\"/>",
               "<link name=\"link_3\"/>", "a second link \"link_3\""},
        Broken{"second_joint", R"(<joint name="joint_4")", R"(<joint name="joint_3" )",
               R"(<joint name="joint_3"  )", "a second joint \"joint_3\""},
        Broken{"long_axis", R"(<child link="link_3"/>
    <axis xyz="0 1 0"/>)",
               R"(<child link="link_3"/>
    <axis xyz="0 2 0"/>)",
               R"(<axis xyz="0 2 0"/>)", "must have length 1"},
        Broken{"two_numbers", R"(<origin xyz="0 0 1.095"/>)", R"(<origin xyz="0 1.095"/>)",
               R"(<origin xyz="0 1.095"/>)", "2 numbers, must be 3"},
        Broken{"in_millimetres", R"(<origin xyz="0 0 1.095"/>)", R"(<origin xyz="0 0 1095"/>)",
               R"(<origin xyz="0 0 1095"/>)", "lengths are in metres"},
        Broken{
            "flat_box", "<link name=\"tool0\"/>",
            "<link name=\"tool0\"><collision><geometry><box size=\"1 1 0\"/></geometry></collision></link>",
            "<box size=\"1 1 0\"/>", "must be positive"},
        Broken{"package", "<link name=\"tool0\"/>",
               "<link name=\"tool0\"><collision><geometry><mesh "
               "filename=\"package://a/b.stl\"/></geometry></collision></link>",
               "package://a", "replace package://NAME/"},
        Broken{"mesh_missing", "<link name=\"tool0\"/>",
               "<link name=\"tool0\"><collision><geometry><mesh "
               "filename=\"not_there.stl\"/></geometry></collision></link>",
               "not_there.stl", "cannot be read"},
        Broken{"side_joint", "<link name=\"tool0\"/>",
               "<link name=\"tool0\"/><link name=\"spring\"/>\n<joint name=\"s\" type=\"revolute\"><parent "
               "link=\"link_1\"/>"
               "<child link=\"spring\"/><limit lower=\"0\" upper=\"1\" velocity=\"1\"/></joint>",
               "<joint name=\"s\"", "turns on its own beside the six"},
        Broken{"hanging_nowhere", "<link name=\"tool0\"/>",
               "<link name=\"tool0\"/>\n<link name=\"x\"><collision><geometry><sphere "
               "radius=\"1\"/></geometry></collision></link>",
               "<link name=\"x\">", "does not hang on base_link"}),
    [](const auto& instance) { return instance.param.name; });

// A world below, frames and a flange have nothing that could hit anything; links that move have.
TEST(Urdf, LinksThatNoShapeIsGivenAreNamed) {
  for (const auto& file : arm_files()) EXPECT_THAT(read_urdf(file).shapeless, ::testing::IsEmpty()) << file;
  std::string bare = own_text();
  for (const std::string link : {"link_2", "link_5"}) {
    const auto from = bare.find("<link name=\"" + link + "\">"), to = bare.find("</link>", from);
    ASSERT_NE(from, std::string::npos);
    bare.replace(from, to - from, "<link name=\"" + link + "\">");
  }
  bare = with(bare, "<link name=\"tool0\"/>",
              "<link name=\"tool0\"/><link name=\"world\"/><link name=\"mark\"/>"
              "<joint name=\"w\" type=\"fixed\"><parent link=\"world\"/><child link=\"base_link\"/></joint>"
              "<joint name=\"m\" type=\"fixed\"><parent link=\"link_3\"/><child link=\"mark\"/></joint>");
  EXPECT_THAT(parse_urdf(bare, "arm.urdf", {}).shapeless, ::testing::ElementsAre("link_2", "link_5"));
}

// The narrower of hard and soft limits, on each side, and those alone that are given.
TEST(Urdf, SoftLimitsNarrowThoseOfTheJoint) {
  const Joint hard = parse_urdf(own_text(), "arm.urdf", {}).arm.joints()[2];
  const auto soft = [](const std::string& attributes) {
    return parse_urdf(with(own_text(), kJoint3, kJoint3 + "<safety_controller " + attributes + "/>"),
                      "arm.urdf", {})
        .arm.joints()[2];
  };
  const Joint narrow = soft(R"(soft_lower_limit="-0.5" soft_upper_limit="0.4" k_velocity="1")");
  EXPECT_EQ(narrow.min_rad, -0.5);
  EXPECT_EQ(narrow.max_rad, 0.4);
  const Joint wide = soft(R"(soft_lower_limit="-4" soft_upper_limit="0.4" k_position="1" k_velocity="1")");
  EXPECT_EQ(wide.min_rad, hard.min_rad);
  EXPECT_EQ(wide.max_rad, 0.4);
  const Joint speed_alone = soft(R"(k_velocity="1")");
  EXPECT_EQ(speed_alone.min_rad, hard.min_rad);
  EXPECT_EQ(speed_alone.max_rad, hard.max_rad);
  const std::string on =
      with(own_text(), R"(<joint name="joint_6" type="revolute">)",
           R"(<joint name="joint_6" type="continuous"><safety_controller soft_lower_limit="-9")"
           R"( soft_upper_limit="9" k_velocity="1"/>)");
  EXPECT_EQ(parse_urdf(on, "arm.urdf", {}).arm.joints()[5].max_rad, 9);
}

TEST(Urdf, ASpringFollowsItsJoint) {
  const std::string text =
      with(own_text(), "<link name=\"tool0\"/>",
           "<link name=\"tool0\"/><link name=\"spring\"><collision><geometry><sphere "
           "radius=\"0.1\"/></geometry></collision>"
           "</link><joint name=\"s\" type=\"revolute\"><origin xyz=\"0.1 0 0.2\"/><parent link=\"link_1\"/>"
           "<child link=\"spring\"/><axis xyz=\"0 1 0\"/><limit lower=\"-9\" upper=\"9\" velocity=\"9\"/>"
           "<mimic joint=\"joint_2\" multiplier=\"-0.5\" offset=\"0.1\"/></joint>");
  const ArmModel model = parse_urdf(text, "arm.urdf", {});
  const auto spring = std::find_if(model.bodies.begin(), model.bodies.end(),
                                   [](const Body& b) { return b.link == "spring"; });
  ASSERT_NE(spring, model.bodies.end());
  const JointAngles q = (JointAngles() << 0.3, 0.4, 0.5, 0.6, 0.7, 0.8).finished();
  const Isometry3d moved = body_motions(model, q)[static_cast<std::size_t>(spring - model.bodies.begin())];
  const Isometry3d expected = turn_about(Vector3d::UnitZ(), Vector3d::Zero(), 0.3) *
                              turn_about(Vector3d::UnitY(), Vector3d(100, 0, 695), -0.5 * 0.4 + 0.1);
  EXPECT_LE((moved.matrix() - expected.matrix()).norm(), 1e-9);
}

// ---- binary STL ----

std::string stl(std::uint32_t count, const std::vector<float>& corners) {
  std::string bytes(80, ' ');
  const auto append = [&bytes](const auto& value) {
    std::array<char, sizeof value> raw;
    std::memcpy(raw.data(), &value, sizeof value);
    bytes.append(raw.data(), raw.size());
  };
  append(count);
  for (std::size_t i = 0; i < corners.size(); i += 9) {
    for (int k = 0; k < 3; ++k) append(0.0F);
    for (std::size_t k = 0; k < 9; ++k) append(corners[i + k]);
    append(std::uint16_t{0});
  }
  return bytes;
}

TEST(Stl, IsReadInMillimetres) {
  const auto triangles = parse_stl(stl(1, {0, 0, 0, 1, 0, 0, 0, 0.5F, 0.25F}), "a.stl", {1, 2, 4});
  ASSERT_EQ(triangles.size(), 1U);
  EXPECT_EQ(triangles[0][1], Vector3d(1000, 0, 0));
  EXPECT_EQ(triangles[0][2], Vector3d(0, 1000, 1000));
}

TEST(Stl, RefusesWhatIsNone) {
  const auto message = [](const std::string& bytes) {
    try {
      (void)parse_stl(bytes, "a.stl", Vector3d::Ones());
      return std::string("it was taken");
    } catch (const ModelError& error) {
      return std::string(error.what());
    }
  };
  const std::vector<float> one{0, 0, 0, 1, 0, 0, 0, 1, 0};
  EXPECT_THAT(message(""), HasSubstr("a.stl: 0 bytes, a binary STL has at least 84"));
  EXPECT_THAT(message(stl(2, one)), HasSubstr("134 bytes, 2 triangles make 184"));
  EXPECT_THAT(message(stl(1, one) + "x"), HasSubstr("135 bytes, 1 triangles make 134"));
  EXPECT_THAT(message(stl(0, {})), HasSubstr("no triangle"));
  EXPECT_THAT(message("solid a\nfacet normal 0 0 1" + std::string(100, ' ')), HasSubstr("text STL"));
  EXPECT_THAT(message(stl(1, {0, 0, 0, NAN, 0, 0, 0, 1, 0})), HasSubstr("not finite"));
  EXPECT_THAT(message(stl(1, {0, 0, 0, 500, 0, 0, 0, 1, 0})), HasSubstr("in millimetres?"));
}

}  // namespace
}  // namespace hotblade::robot
