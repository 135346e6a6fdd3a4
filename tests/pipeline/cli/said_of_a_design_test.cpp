// What `check`, `plan` and `verify` say of a design: sizes, what was tried, and figures that are known from
// one side only.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/paths.hpp"
#include "tests/pipeline/run_program.hpp"

namespace hotblade::pipeline {
namespace {

using testing::Ended;
using ::testing::HasSubstr;
using testing::hotblade;
using ::testing::Not;
using Words = std::vector<std::string>;

const std::string kVault = hotblade::testing::source_dir() + "/samples/barrel_vault.obj";

class SaidOfADesign : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(files_ / name, std::ios::binary) << bytes;
    return (files_ / name).string();
  }
  testing::TemporaryDirectory files_;
};

// A bowl of 240 mm on its side, 30 mm deep: z is across.
std::string upright_bowl() {
  std::ostringstream text;
  constexpr int kCells = 16;
  for (int i = 0; i <= kCells; ++i) {
    for (int j = 0; j <= kCells; ++j) {
      const double a = 240.0 * i / kCells - 120, b = 240.0 * j / kCells - 120;
      text << "v " << (a * a + b * b) / 960 << " " << a << " " << b << "\n";
    }
  }
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      const int at = i * (kCells + 1) + j + 1;
      text << "f " << at << " " << at + 1 << " " << at + kCells + 2 << " " << at + kCells + 1 << "\n";
    }
  }
  return text.str();
}

TEST_F(SaidOfADesign, AnAngleToNoDirectionIsRefused) {
  Words words{"check", kVault, "--units", "mm", "--set", "design.facing_max_deg=60"};
  const Ended alone = hotblade(words);
  EXPECT_EQ(alone.code, 2);
  EXPECT_EQ(alone.err, "design.facing_max_deg (60, given without design.facing): it says nothing alone\n");
  words.insert(words.end(), {"--set", "design.facing=[0, 0, 1]"});
  EXPECT_EQ(hotblade(words).code, 0);
}

TEST_F(SaidOfADesign, CheckSaysWhatPassedWhenItWasTried) {
  const std::string bowl = write("bowl.obj", upright_bowl());
  const Ended reasons = hotblade({"check", bowl, "--units", "mm"});
  EXPECT_THAT(reasons.out, HasSubstr("says nothing about a surface that stands upright"));
  EXPECT_THAT(reasons.out, Not(HasSubstr("design.keep=back")));
  const Ended advised = hotblade({"check", bowl, "--units", "mm", "--advise"});
  EXPECT_EQ(advised.code, 0) << advised.err;
  EXPECT_THAT(advised.out, HasSubstr("--set \"design.keep=back\": passes, deviation "));
  // What was told passes.
  const auto json =
      nlohmann::json::parse(hotblade({"check", bowl, "--units", "mm", "--advise", "--json"}).out);
  ASSERT_FALSE(json["tried"].empty());
  for (const auto& told : json["tried"]) {
    Words words{"plan", bowl, "--units", "mm", "-o", (files_ / "cut").string(), "--force", "--no-pictures"};
    for (const auto& set : told["set"]) {
      const auto assignment = set.get<std::string>();
      words.insert(words.end(), {"--set", assignment});
    }
    const Ended planned = hotblade(words);
    EXPECT_EQ(planned.code, 0) << planned.err;
    EXPECT_EQ(
        nlohmann::json::parse(testing::read_bytes(files_ / "cut" / "report.json"))["deviation_mm"]["max"],
        told["deviation_mm"]);
  }
  // Nothing is suggested of a design that lies well.
  EXPECT_THAT(hotblade({"check", kVault, "--units", "mm", "--advise"}).out,
              HasSubstr("nothing: the shape suggests no other settings"));
}

TEST_F(SaidOfADesign, PlanAndCheckSayTheSameOfASize) {
  struct Case {
    const char *file, *units;
    Words hints;
  };
  // Less than clamps are apart, and more than a plan may have strips.
  const std::string small = write("small.obj", "v 0 0 0\nv 23 0 0\nv 23 13 0\nv 0 13 0\nf 1 2 3 4\n");
  const std::string large = write("large.obj", "v 0 0 0\nv 900 0 0\nv 900 500 0\nv 0 500 0\nf 1 2 3 4\n");
  for (const Case& c :
       {Case{small.c_str(), "mm", {"584.2 x 330.2 x 0 mm if in in", "23000 x 13000 x 0 mm if in m ("}},
        Case{large.c_str(), "m", {"900 x 500 x 0 mm if in mm", "9000 x 5000 x 0 mm if in cm"}}}) {
    const Ended checked = hotblade({"check", c.file, "--units", c.units});
    const Ended planned = hotblade(
        {"plan", c.file, "--units", c.units, "-o", (files_ / "cut").string(), "--force", "--no-pictures"});
    for (const std::string& hint : c.hints) {
      EXPECT_THAT(checked.out, HasSubstr(hint)) << c.units;
      EXPECT_THAT(planned.err, HasSubstr(hint)) << c.units;
      EXPECT_EQ(planned.err.find(hint), planned.err.rfind(hint)) << planned.err;
    }
    // Where it is refused the units are tried, and say what came of them.
    if (planned.code != 0) {
      EXPECT_THAT(planned.err, HasSubstr("): --units mm: passes, "));
    }
  }
}

// Part of a cylinder, and where `flap` is, a flap at its end that no blade of the cylinder's program reaches.
std::string flapped_cylinder(bool flap) {
  std::ostringstream text;
  constexpr int kAround = 60, kPlain = 4, kFlap = 10;
  const int rows = flap ? kPlain + kFlap : kPlain;
  for (int i = 0; i <= rows; ++i) {
    const double up = std::max(0, i - kPlain);
    for (int j = 0; j <= kAround; ++j) {
      const double phi = 0.6 * (static_cast<double>(j) / kAround - 0.5), r = 400 + 6 * up;
      text << "v " << 75 * std::min(i, kPlain) + 12 * up << " " << r * std::sin(phi) << " "
           << r * std::cos(phi) - 370 << "\n";
    }
  }
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < kAround; ++j) {
      const int a = i * (kAround + 1) + j + 1, c = a + kAround + 1;
      text << "f " << a << " " << c << " " << c + 1 << " " << a + 1 << "\n";
    }
  }
  return text.str();
}

// What lies past the edge of a cut is left out of the deviation from three tolerances on.
TEST_F(SaidOfADesign, VerifyWritesADeviationAsAtLeastWhereTheSearchForItEnded) {
  const std::string plain = write("plain.obj", flapped_cylinder(false)),
                    flapped = write("flapped.obj", flapped_cylinder(true));
  const auto directory = files_ / "cut";
  ASSERT_EQ(hotblade({"plan", plain, "--units", "mm", "--no-pictures", "-o", directory.string()}).code, 0);
  const auto sha_of = [&](const std::string& file) {
    return nlohmann::json::parse(hotblade({"check", file, "--units", "mm", "--json"}).out)["sha256"]
        .get<std::string>();
  };
  const auto verified = [&](const std::string& program, const std::string& design) {
    return hotblade({"verify", program, "--design", design, "--sample", "0.5"});
  };
  std::string bytes = testing::read_bytes(directory / "program.json");
  EXPECT_THAT(verified((directory / "program.json").string(), plain).out, HasSubstr("deviation max 0."));
  const std::string sha = sha_of(plain);
  bytes.replace(bytes.find(sha), sha.size(), sha_of(flapped));
  const std::string patched = write("patched.json", bytes);
  const Ended ended = verified(patched, flapped);
  EXPECT_EQ(ended.code, 5);
  EXPECT_THAT(ended.out, HasSubstr("deviation max >= 2.8"));
  const auto json = nlohmann::json::parse(
      hotblade({"verify", patched, "--design", flapped, "--sample", "0.5", "--json"}).out);
  EXPECT_TRUE(json["deviation_mm"]["capped"].get<bool>());
}

TEST_F(SaidOfADesign, AWarningIsPrintedOnceAndASizeInOtherUnits) {
  write("speck.obj", "v 0 0 0\nv 0.9 0 0\nv 0.9 0.5 0\nv 0 0.5 0\nf 1 2 3 4\n");
  const Ended ended = hotblade({"plan", (files_ / "speck.obj").string(), "--units", "mm", "-o",
                                (files_ / "cut").string(), "--no-pictures"});
  const std::string hint = "900 x 500 x 0 mm if in m";
  ASSERT_THAT(ended.err, HasSubstr(hint));
  EXPECT_EQ(ended.err.find(hint), ended.err.rfind(hint)) << ended.err;
}

}  // namespace
}  // namespace hotblade::pipeline
