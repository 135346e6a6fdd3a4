// Chunks are planned once, whatever ends a plan or a runner.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <random>
#include <thread>

#include "pipeline/batch/csv.hpp"
#include "pipeline/batch/gather.hpp"
#include "pipeline/batch/result.hpp"
#include "pipeline/batch/status.hpp"
#include "pipeline/settings/error.hpp"
#include "tests/pipeline/batch/stand_in.hpp"

namespace hotblade::pipeline::batch {
namespace {

namespace fs = std::filesystem;
using namespace testing;
using pipeline::testing::read_bytes;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;
using ::testing::UnorderedElementsAre;

std::vector<int> heights(int count) {
  std::vector<int> list;
  for (int i = 1; i <= count; ++i) list.push_back(i);
  return list;
}

std::map<std::string, Result> results_by_panel(const StandInBatch& batch) {
  std::map<std::string, Result> results;
  for (const Job& job : read_jobs(batch.directory(), read_batch(batch.directory())).jobs) {
    if (has_result(batch.directory(), job.key))
      results.emplace(job.panel, read_result(batch.directory().result(job.key)));
  }
  return results;
}

TEST(Batch, RefusalsAreResults) {
  const StandInBatch batch({1, kBadInput, kRefused, kOver});
  const RunReport report = batch.run();
  EXPECT_EQ(report.planned, 4U);
  EXPECT_THAT(report.failures, IsEmpty());
  EXPECT_EQ(batch.starts(), 4U);
  const std::map<std::string, Result> results = results_by_panel(batch);
  ASSERT_EQ(results.size(), 4U);
  EXPECT_EQ(results.at("p1").verdict, "passed");
  EXPECT_EQ(results.at("p903").verdict, "bad input");
  EXPECT_THAT(results.at("p903").message, HasSubstr(".obj:5: no face has an area"));
  EXPECT_EQ(results.at("p904").verdict, "refused");
  EXPECT_EQ(results.at("p904").message, "S001: deviation 2 mm (limit 1)");
  EXPECT_EQ(results.at("p905").verdict, "over tolerance");
  std::vector<std::string> files;
  for (const ResultFile& file : results.at("p1").files) files.push_back(file.name);
  EXPECT_THAT(files, ElementsAre("program.json", "report.html", "report.json", "stderr.txt"));  // no ribs
  EXPECT_TRUE(fs::exists(batch.directory().stamp(0)));
  EXPECT_THAT(batch.litter(), IsEmpty());
  // A second run has nothing to do.
  EXPECT_EQ(batch.run().there, 4U);
  EXPECT_EQ(batch.starts(), 4U);
}

TEST(Batch, ProgramsAreKeptPackedWhereThatIsAskedUnderOtherKeys) {
  const StandInBatch batch({1});
  const std::string key = read_chunk(batch.directory(), 0).front().key;
  Asked asked = batch.asked();
  asked.gzip = true;
  (void)init_batch(batch.directory(), asked, true, {});
  EXPECT_NE(read_chunk(batch.directory(), 0).front().key, key);
  EXPECT_TRUE(read_batch(batch.directory()).asked.gzip);
  (void)batch.run();
  const fs::path result = batch.directory().result(read_chunk(batch.directory(), 0).front().key);
  EXPECT_TRUE(fs::exists(result / "program.json.gz"));
  EXPECT_FALSE(fs::exists(result / "program.json"));
}

TEST(Batch, CrashIsRetriedThenNamed) {
  const StandInBatch batch({1, kExits, kNoFile, kAborts, kSleeps, kEats, 2});
  const RunReport report = batch.run(2, 3, 40);
  EXPECT_EQ(report.planned, 2U);
  EXPECT_EQ(batch.starts(), 2U + 5 * 3);
  std::vector<std::string> named;
  for (const Failure& failure : report.failures) {
    named.push_back(failure.panel + ": " + failure.why);
    EXPECT_EQ(failure.attempts, 3);
  }
  EXPECT_THAT(named, UnorderedElementsAre(
                         "p901: exit code 1, its memory limited to 40 MB (--limit-mb)", "p907: exit code 7",
                         "p910: signal 6 (Aborted), its memory limited to 40 MB (--limit-mb)",
                         "p911: over its 3 s", StartsWith("p912: ")));
  EXPECT_THAT(
      named,
      ::testing::Not(::testing::Contains("p912: over its 3 s")));  // a shell without memory ends as it likes
  EXPECT_FALSE(fs::exists(batch.directory().stamp(0)));
  const std::vector<Failure> kept = read_failures(batch.directory(), 0);
  ASSERT_EQ(kept.size(), 5U);
  for (const Failure& failure : kept) {
    if (failure.panel != "p901") continue;
    EXPECT_THAT(failure.last_lines, ElementsAre("internal error: broken"));
  }
  EXPECT_THAT(batch.litter(), IsEmpty());
  const BatchStatus status = status_of(batch.directory());
  EXPECT_EQ(status.results, 2U);
  EXPECT_EQ(status.failures.size(), 5U);
  EXPECT_EQ(status.chunks_done, 0);
}

// Plans all chunks in a process of its own.
pid_t start_runner(const StandInBatch& batch, int jobs = 2) {
  const pid_t pid = ::fork();
  if (pid != 0) return pid;
  int code = 1;
  try {
    code = batch.run(jobs).failures.empty() ? 0 : 2;
  } catch (const std::exception&) {
  }
  ::_exit(code);
}

int exit_of_runner(pid_t pid) {
  int status = 0;
  ::waitpid(pid, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

// The rows of results.csv without times and places.
std::vector<std::vector<std::string>> rows_that_repeat(const StandInBatch& batch) {
  (void)gather(batch.directory(), false, {});
  const CsvTable table = read_csv(batch.directory().path() / "results.csv");
  std::vector<std::vector<std::string>> rows{table.columns};
  for (const CsvRow& row : table.rows) {
    rows.push_back(row.cells);
    for (const char* column : {"plan_s", "cpu_s", "peak_mb", "node"})
      rows.back()[table.column(column)].clear();
  }
  return rows;
}

TEST(Batch, KilledAnywhere) {
  const StandInBatch undisturbed(heights(60), 0.1), killed(heights(60), 0.1);
  EXPECT_THAT(undisturbed.run().failures, IsEmpty());
  std::mt19937 random(7);
  int kills = 0;
  for (int i = 0; i < 50; ++i) {
    const pid_t runner = start_runner(killed);
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 60'000));
    ::kill(runner, SIGKILL);
    kills += exit_of_runner(runner) == 128 + SIGKILL ? 1 : 0;
  }
  EXPECT_GT(kills, 10);
  EXPECT_EQ(exit_of_runner(start_runner(killed)), 0);
  EXPECT_EQ(rows_that_repeat(killed), rows_that_repeat(undisturbed));
  EXPECT_THAT(killed.litter(), IsEmpty());
  EXPECT_EQ(status_of(killed.directory()).chunks_done, static_cast<int>(killed.chunks().size()));
}

TEST(Batch, AKilledRunnerLeavesNoPlanBehind) {
  const StandInBatch batch({kSleeps, kSleeps + 10});
  const pid_t runner = start_runner(batch);
  // The one that does not sleep has ended: what a shell has started may outlive it, and write meanwhile.
  while (batch.starts() < 2 || results_by_panel(batch).empty())
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  ::kill(runner, SIGKILL);
  exit_of_runner(runner);
  // The work places carry the runner's number and the next run clears them; locks are free at once.
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(batch.run(2, 0.3).failures.size(), 1U);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
  EXPECT_THAT(batch.litter(), IsEmpty());
}

TEST(Batch, TwoRunnersOneChunk) {
  const StandInBatch batch(heights(40));
  const pid_t one = start_runner(batch), two = start_runner(batch);
  EXPECT_EQ(exit_of_runner(one), 0);
  EXPECT_EQ(exit_of_runner(two), 0);
  EXPECT_EQ(batch.starts(), 40U);  // the locks keep each from the other's
  EXPECT_EQ(results_by_panel(batch).size(), 40U);
  EXPECT_THAT(batch.litter(), IsEmpty());
}

TEST(Batch, OnePanelMovedIsOnePlan) {
  const StandInBatch batch(heights(30), 0.1);
  (void)batch.run();
  std::string text = read_bytes(batch.asked().design);
  const auto at = text.find(" 17.500000\n");
  std::ofstream(batch.asked().design) << text.replace(at, 11, " 18.600000\n");
  const InitReport update = init_batch(batch.directory(), std::nullopt, true, {});
  EXPECT_EQ(update.plans_there, 29U);
  EXPECT_LE(update.chunks_changed, 2);  // where it was, and where it is
  EXPECT_EQ(batch.run().planned, 1U);
  EXPECT_EQ(batch.starts(), 31U);
}

TEST(Batch, WhatWasChangedUnderAKeyIsNotPlanned) {
  const StandInBatch batch({1});
  const PlannedKey planned = read_chunk(batch.directory(), 0).front();
  std::ofstream(batch.directory().design(planned.design_sha256), std::ios::app) << "v 0 0 0\n";
  const RunReport report = batch.run();
  ASSERT_EQ(report.failures.size(), 1U);
  EXPECT_THAT(report.failures[0].why, HasSubstr(".obj: was changed"));
  EXPECT_EQ(batch.starts(), 0U);
}

// What a damaged disk or a copy that was cut off leaves.
TEST(Batch, WhatIsNoWholeResultIsPlannedAgain) {
  const StandInBatch batch({1, 2, 3, 4, 5, 6});
  (void)batch.run();
  std::vector<fs::path> places;
  for (const PlannedKey& planned : read_chunk(batch.directory(), 0))
    places.push_back(batch.directory().result(planned.key));
  ASSERT_EQ(places.size(), 6U);
  std::ofstream(places[0] / "result.json") << "{\"format\"";
  fs::remove(places[1] / "result.json");
  fs::remove(places[2] / "report.json");
  std::ofstream(places[3] / "program.json") << "";
  fs::remove(places[4] / "program.json");  // to have room
  EXPECT_EQ(status_of(batch.directory()).results, 2U);
  EXPECT_EQ(batch.run().planned, 4U);
  EXPECT_EQ(status_of(batch.directory()).results, 6U);
  EXPECT_EQ(batch.starts(), 10U);
  EXPECT_THAT(batch.litter(), IsEmpty());
}

TEST(Batch, WhatPassesWithoutAReportHasFailed) {
  const StandInBatch batch({1});
  std::ofstream(batch.program()) << "#!/bin/sh\nexit 0\n";
  const RunReport report = batch.run();
  ASSERT_EQ(report.failures.size(), 1U);
  EXPECT_EQ(report.failures[0].why, "exit code 0 without report.json");
}

TEST(Batch, AChunkWithoutAJobOfItsIsRefused) {
  const StandInBatch batch({1, 2});
  (void)batch.run();
  const fs::path chunk = batch.directory().chunk(0);
  std::string text = read_bytes(chunk);
  text.erase(text.find('\n') + 1, 3 * 65);  // a key, a design and settings
  std::ofstream(chunk) << text;
  EXPECT_THAT(thrown([&] { (void)batch.run(); }), HasSubstr("0.csv: is not as it was made: job "));
  EXPECT_THAT(thrown([&] { (void)gather(batch.directory(), false, {}); }), HasSubstr("is missing: run"));
}

TEST(Batch, FullDisk) {
  const pipeline::testing::TemporaryDirectory place;
  if (::mount("none", place.path().c_str(), "tmpfs", 0, "size=300k") != 0)
    GTEST_SKIP() << "no right to mount a small file system";
  {
    const StandInBatch batch(heights(30), 10, place.path());
    std::string said;
    std::size_t failures = 0;
    try {
      failures = batch.run().failures.size();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind, ErrorKind::kFile);
      said = error.what();
    }
    EXPECT_TRUE(failures > 0 || said.find("No space left") != std::string::npos) << said;
    for (const auto& [panel, result] : results_by_panel(batch)) {
      for (const ResultFile& file : result.files)
        EXPECT_EQ(fs::file_size(batch.directory().result(result.key) / file.name), file.bytes);
    }
    ::mount("none", place.path().c_str(), "tmpfs", MS_REMOUNT, "size=20m");
    EXPECT_THAT(batch.run().failures, IsEmpty());
    EXPECT_EQ(results_by_panel(batch).size(), 30U);
  }
  ::umount(place.path().c_str());
}

}  // namespace
}  // namespace hotblade::pipeline::batch
