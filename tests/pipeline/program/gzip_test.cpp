// Packed programs: the same text comes back, and nothing else is taken for one.
#include "pipeline/program/gzip.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <random>

#include "pipeline/program/program.hpp"
#include "pipeline/program/refused_plan.hpp"
#include "pipeline/program/strip_jobs.hpp"
#include "pipeline/settings/error.hpp"
#include "tests/pipeline/temporary_directory.hpp"
#include "tests/pipeline/vault_program.hpp"

namespace hotblade::pipeline {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryDirectory;
using testing::vault_program;

// The message that bytes are refused with; empty: they are taken.
std::string refusal_to_unpack(const std::string& bytes) {
  try {
    (void)unpacked(bytes, "job.json.gz");
    return "";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::kBadInput);
    EXPECT_THAT(error.what(), HasSubstr("job.json.gz: "));
    return error.what();
  }
}

std::string random_text(std::size_t size, int letters) {
  std::mt19937 random(11);
  std::string text(size, '\0');
  for (char& c : text) c = static_cast<char>(random() % static_cast<unsigned>(letters));
  return text;
}

TEST(Gzip, GivesTheTextBack) {
  for (const std::string& text : {std::string(), std::string("a"), random_text(200'000, 256),
                                  random_text(3'000'000, 4), to_json(vault_program())}) {
    const std::string bytes = packed(text);
    EXPECT_TRUE(unpacked(bytes, "t.gz") == text) << text.size();
    EXPECT_TRUE(packed(text) == bytes);
  }
}

TEST(Gzip, HoldsNoTime) {
  EXPECT_EQ(packed(random_text(3000, 20)).substr(4, 4), std::string(4, '\0'));
}

TEST(Gzip, IsWhatOtherProgramsRead) {
  const TemporaryDirectory directory;
  const std::string text = random_text(100'000, 30);
  std::ofstream(directory / "t.gz", std::ios::binary) << packed(text);
  const std::string command =
      "gzip -dc '" + (directory / "t.gz").string() + "' > '" + (directory / "t").string() + "'";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_TRUE(testing::read_bytes(directory / "t") == text);
  // And the other way round, with several members and a name in the head.
  const std::string other =
      "cd '" + directory.path().string() + "' && gzip -9 -k t && cat t.gz t.gz > two.gz";
  std::filesystem::remove(directory / "t.gz");
  ASSERT_EQ(std::system(other.c_str()), 0);
  EXPECT_TRUE(unpacked(testing::read_bytes(directory / "two.gz"), "two.gz") == text + text);
}

TEST(Gzip, ThatIsCutOffAtAnyByteIsRefused) {
  const std::string bytes = packed(random_text(2000, 10));
  EXPECT_THAT(refusal_to_unpack(""), HasSubstr("is no gzip file"));
  EXPECT_THAT(refusal_to_unpack(bytes.substr(0, 1)), HasSubstr("is no gzip file"));
  for (std::size_t size = 2; size < bytes.size(); ++size)
    ASSERT_THAT(refusal_to_unpack(bytes.substr(0, size)), HasSubstr("is cut off")) << size;
  EXPECT_EQ(refusal_to_unpack(bytes), "");
}

TEST(Gzip, WithAnyByteChangedIsRefusedOrHasTheSameText) {
  const std::string text = random_text(2000, 10), bytes = packed(text);
  int refused = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string changed = bytes;
    changed[i] = static_cast<char>(changed[i] ^ 0x55);
    try {
      EXPECT_TRUE(unpacked(changed, "t.gz") == text) << i;  // the head has bytes that say nothing of the text
    } catch (const Error& error) {
      EXPECT_EQ(error.kind, ErrorKind::kBadInput);
      ++refused;
    }
  }
  EXPECT_GE(refused, static_cast<int>(bytes.size()) - 10);
}

TEST(Gzip, WithSomethingBehindItIsRefused) {
  const std::string bytes = packed("text");
  EXPECT_THAT(refusal_to_unpack(bytes + "x"), HasSubstr("goes on after its end"));
  EXPECT_THAT(refusal_to_unpack(bytes + bytes.substr(0, 7)), HasSubstr("is cut off"));
}

TEST(Gzip, MadeToFillTheMemoryIsRefused) {
  const std::string bytes = packed(std::string(std::size_t{65} << 20, '0'));
  EXPECT_LT(bytes.size(), 400'000U);
  EXPECT_THAT(refusal_to_unpack(bytes), HasSubstr("unpacks to more than 200 times its size"));
}

// ---- programs ----

class PackedProgram : public ::testing::Test {
 protected:
  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(directory_ / name, std::ios::binary) << bytes;
  }
  template <typename Read>
  static std::string message(const Read& read, ErrorKind kind) {
    try {
      read();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind, kind);
      return error.what();
    }
    return "read";
  }
  TemporaryDirectory directory_;
  std::string text_ = to_json(vault_program());
};

TEST_F(PackedProgram, IsReadByItsNameAndHasTheSameJobs) {
  write("a.json", text_);
  write("a.json.gz", packed(text_));
  EXPECT_EQ(to_json(read_program(directory_ / "a.json.gz")), text_);
  const StripJobs plain = read_strip_jobs(directory_ / "a.json", false),
                  from_packed = read_strip_jobs(directory_ / "a.json.gz", false);
  ASSERT_EQ(plain.jobs.size(), from_packed.jobs.size());
  // A strip that was begun from one goes on from the other: the jobs' numbers come of the plain text.
  for (std::size_t i = 0; i < plain.jobs.size(); ++i) EXPECT_EQ(plain.jobs[i].id, from_packed.jobs[i].id);
}

TEST_F(PackedProgram, ThatIsNoneIsSaid) {
  const std::string bytes = packed(text_);
  write("plain.json.gz", text_);
  write("packed.json", bytes);
  write("half.json.gz", bytes.substr(0, bytes.size() / 2));
  write("other.json.gz", packed("{}"));
  const auto read = [&](const char* name, ErrorKind kind) {
    return message([&] { (void)read_program(directory_ / name); }, kind);
  };
  EXPECT_THAT(read("plain.json.gz", ErrorKind::kBadInput), HasSubstr("plain.json.gz: is no gzip file"));
  EXPECT_THAT(read("packed.json", ErrorKind::kBadInput), HasSubstr("packed.json: is packed (gzip): give it"));
  EXPECT_THAT(read("half.json.gz", ErrorKind::kBadInput), HasSubstr("half.json.gz: is cut off"));
  EXPECT_THAT(read("other.json.gz", ErrorKind::kBadInput), HasSubstr("other.json.gz: "));
  EXPECT_THAT(read("missing.json.gz", ErrorKind::kFile), HasSubstr("cannot be read"));
}

TEST_F(PackedProgram, ARefusedPlanIsReadPackedToo) {
  RefusedPlan plan;
  plan.found = vault_program();
  plan.reasons = {{"S001: radius 55 mm (limit 70 mm)", std::nullopt}};
  write("refused.json.gz", packed(to_json(plan)));
  write("program.json.gz", packed(text_));
  EXPECT_TRUE(is_refused_plan(directory_ / "refused.json.gz"));
  EXPECT_EQ(read_refused_plan(directory_ / "refused.json.gz").reasons[0].message, plan.reasons[0].message);
  EXPECT_FALSE(is_refused_plan(directory_ / "program.json.gz"));
  EXPECT_FALSE(is_refused_plan(directory_ / "missing.json.gz"));
}

}  // namespace
}  // namespace hotblade::pipeline
