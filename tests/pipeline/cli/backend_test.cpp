// --backend from outside: the same bytes whatever computes the distances, and a word about what did.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "tests/paths.hpp"
#include "tests/pipeline/run_program.hpp"

namespace hotblade::pipeline::testing {
namespace {

namespace fs = std::filesystem;

const std::string kSamples = hotblade::testing::source_dir() + "/samples/";

Ended plan(const fs::path& directory, const std::string& backend, const std::string& jobs) {
  return hotblade({"plan", kSamples + "hypar.obj", "--config", kSamples + "hypar.toml", "--backend", backend,
                   "--jobs", jobs, "--no-pictures", "-o", directory.string()});
}

// Every file but run.json, which says what may differ.
void expect_same_files(const fs::path& a, const fs::path& b) {
  std::size_t compared = 0;
  for (const auto& entry : fs::recursive_directory_iterator(a)) {
    if (!entry.is_regular_file() || entry.path().filename() == "run.json") continue;
    const fs::path other = b / fs::relative(entry.path(), a);
    EXPECT_EQ(read_bytes(entry.path()), read_bytes(other)) << entry.path();
    ++compared;
  }
  EXPECT_GE(compared, 2u);
}

TEST(Backend, PlansAreTheSameBytesOnEveryBackendAndThreadCount) {
  const TemporaryDirectory files;
  const Ended cpu = plan(files / "cpu", "cpu", "1");
  ASSERT_EQ(cpu.code, 0) << cpu.err;
  for (const auto& [backend, jobs] :
       {std::pair{"cpu", "2"}, {"opencl", "1"}, {"opencl", "2"}, {"auto", "2"}}) {
    const fs::path directory = files / (std::string(backend) + jobs);
    const Ended other = plan(directory, backend, jobs);
    ASSERT_EQ(other.code, 0) << other.err;
    EXPECT_EQ(other.out.substr(0, other.out.find("\nprogram ")),
              cpu.out.substr(0, cpu.out.find("\nprogram ")));
    expect_same_files(files / "cpu", directory);
  }
}

TEST(Backend, VerifyGivesTheSameVerdictOnEveryBackendAndThreadCount) {
  const TemporaryDirectory files;
  ASSERT_EQ(plan(files / "cut", "cpu", "2").code, 0);
  const auto verified = [&](const std::string& backend, const std::string& jobs) {
    return hotblade({"verify", (files / "cut" / "program.json").string(), "--design", kSamples + "hypar.obj",
                     "--backend", backend, "--jobs", jobs, "--sample", "1"});
  };
  const Ended expected = verified("cpu", "1");
  EXPECT_EQ(expected.code, 0) << expected.err;
  EXPECT_NE(expected.out.find("deviation max"), std::string::npos) << expected.out;
  for (const auto& [backend, jobs] :
       {std::pair{"cpu", "2"}, {"opencl", "1"}, {"opencl", "2"}, {"auto", "2"}}) {
    const Ended other = verified(backend, jobs);
    EXPECT_EQ(other.code, expected.code) << other.err;
    EXPECT_EQ(other.out, expected.out) << backend << ", " << jobs;
  }
}

TEST(Backend, VerifySaysWhyOpenClDidNotAnswer) {
  const TemporaryDirectory files;
  ASSERT_EQ(plan(files / "cut", "cpu", "2").code, 0);
  setenv("HOTBLADE_OPENCL_DEVICE", "no such device", 1);
  const Ended verified = hotblade({"verify", (files / "cut" / "program.json").string(), "--design",
                                   kSamples + "hypar.obj", "--backend", "opencl"});
  unsetenv("HOTBLADE_OPENCL_DEVICE");
  EXPECT_EQ(verified.code, 0) << verified.err;
  EXPECT_NE(verified.err.find("no such device"), std::string::npos) << verified.err;
  EXPECT_NE(verified.err.find("on the CPU"), std::string::npos) << verified.err;
}

TEST(Backend, AutoSaysWhatItPickedWhenAsked) {
  const TemporaryDirectory files;
  const Ended planned = plan(files / "cut", "auto", "2");
  EXPECT_EQ(planned.err.find("distances to the design: "), std::string::npos) << planned.err;
  const Ended verified = hotblade(
      {"verify", (files / "cut" / "program.json").string(), "--design", kSamples + "hypar.obj", "-v"});
  EXPECT_NE(verified.err.find("distances to the design: "), std::string::npos) << verified.err;
}

}  // namespace
}  // namespace hotblade::pipeline::testing
