#include "pipeline/calibrate/scan_file.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "pipeline/settings/error.hpp"
#include "tests/pipeline/temporary_directory.hpp"

namespace hotblade::pipeline {
namespace {

class ScanFiles : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& text) {
    std::ofstream(directory_ / name, std::ios::binary) << text;
    return directory_ / name;
  }
  std::string refusal(const std::filesystem::path& file, ErrorKind kind = ErrorKind::kBadInput) {
    try {
      (void)read_scan(file, "mm");
    } catch (const Error& error) {
      EXPECT_EQ(error.kind, kind) << error.what();
      return error.what();
    }
    return "read";
  }
  testing::TemporaryDirectory directory_;
};

// A bent patch, row by row; the line `replaced` stands in place of the twentieth.
std::string rows(const std::string& replaced = "") {
  std::string text;
  for (int i = 0; i < 300; ++i)
    text += i == 19 && !replaced.empty()
                ? replaced + "\n"
                : fmt::format("{},{},{}\n", i % 20, i / 20, 0.01 * (i % 20) * (i % 20));
  return text;
}

TEST_F(ScanFiles, RowsWithAHeadAndWithoutAreTheSamePoints) {
  const auto plain = read_scan(write("a.csv", rows()), "mm"),
             named = read_scan(write("b.csv", "X, y ,z\r\n" + rows()), "mm");
  ASSERT_EQ(plain.size(), 300U);
  ASSERT_EQ(named.size(), 300U);
  EXPECT_EQ(plain[57], Eigen::Vector3d(17, 2, 0.01 * 17 * 17));
  EXPECT_EQ(named[57], plain[57]);
  EXPECT_EQ(read_scan(write("c.csv", "# a scanner's remark\n\n" + rows()), "in")[57], 25.4 * plain[57]);
}

TEST_F(ScanFiles, WhatIsWrittenIsReadAgain) {
  const auto points = read_scan(write("a.csv", rows()), "mm");
  const auto again = read_scan(write("b.csv", scan_csv(points)), "mm");
  ASSERT_EQ(again.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_LT((points[i] - again[i]).norm(), 1e-4);
}

TEST_F(ScanFiles, WhatIsNoPointNamesItsLine) {
  const auto says = [&](const std::string& row, const std::string& what) {
    const std::string said = refusal(write("a.csv", rows(row)));
    EXPECT_NE(said.find("a.csv:20: "), std::string::npos) << said;
    EXPECT_NE(said.find(what), std::string::npos) << said;
  };
  says("1,nan,3", "out of range (nan");
  says("1,inf,3", "out of range (inf");
  says("1,2e9,3", "out of range (2e9, at most 1e+07)");
  says("1,two,3", "is not a number (\"two\")");
  says("1,2", "wrong number of columns (2, must be 3)");
  says("1;2;3", "wrong number of columns (1, must be 3)");
  says("1,2,3,4", "wrong number of columns (4, must be 3)");
  says("x,y,z", "is not a number");
}

TEST_F(ScanFiles, TooFewPointsAndPointsOnALineAreNoSurface) {
  EXPECT_NE(refusal(write("a.csv", "1,2,3\n4,5,7\n")).find("too few points (2, at least 200)"),
            std::string::npos);
  EXPECT_NE(refusal(write("a.csv", "")).find("too few points (0"), std::string::npos);
  std::string line, place;
  for (int i = 0; i < 300; ++i) {
    line += fmt::format("{0},{0},{0}\n", i);
    place += "1,2,3\n";
  }
  EXPECT_NE(refusal(write("a.csv", line)).find("on one line"), std::string::npos);
  EXPECT_NE(refusal(write("a.csv", place)).find("in one place"), std::string::npos);
}

TEST_F(ScanFiles, APlyNeedsNoFaces) {
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 300\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nend_header\n";
  for (int i = 0; i < 300; ++i) text += fmt::format("{} {} {} 7\n", i % 20, i / 20, 0.5 * (i % 3));
  const auto points = read_scan(write("a.ply", text), "mm");
  ASSERT_EQ(points.size(), 300U);
  EXPECT_EQ(points[41], Eigen::Vector3d(1, 2, 1));
  text.replace(text.find("5 0 1 7\n"), 7, "5 0 nan 7");
  EXPECT_NE(refusal(write("b.ply", text)).find("b.ply:"), std::string::npos);
}

TEST_F(ScanFiles, MissingFilesAndDirectoriesAreFileErrors) {
  (void)refusal(directory_ / "none.csv", ErrorKind::kFile);
  (void)refusal(directory_.path(), ErrorKind::kFile);
}

}  // namespace
}  // namespace hotblade::pipeline
