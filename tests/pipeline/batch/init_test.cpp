// What a batch directory holds after `batch init`, and what an update changes in it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "pipeline/batch/csv.hpp"
#include "pipeline/batch/init.hpp"
#include "pipeline/batch/key.hpp"
#include "pipeline/batch/measured.hpp"
#include "pipeline/batch/result.hpp"
#include "pipeline/settings/error.hpp"
#include "surface/read/design_surface.hpp"
#include "tests/pipeline/batch/stand_in.hpp"

namespace hotblade::pipeline::batch {
namespace {

namespace fs = std::filesystem;
using pipeline::testing::read_bytes;
using pipeline::testing::TemporaryDirectory;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::square_panel;
using testing::StandInBatch;
using testing::thrown;

class BatchInit : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(files_ / name, std::ios::binary) << text;
    return (files_ / name).string();
  }
  Asked facade(const std::string& text) const {
    Asked asked;
    asked.design = write("facade.obj", text);
    asked.split = "group";
    asked.units = "mm";
    return asked;
  }
  InitReport init(const std::optional<Asked>& asked, bool update = false) const {
    return init_batch(directory_, asked, update, {});
  }
  [[nodiscard]] JobTable jobs() const { return read_jobs(directory_, read_batch(directory_)); }

  TemporaryDirectory files_;
  BatchDirectory directory_{files_ / "batch"};
};

TEST_F(BatchInit, NamesGoToTheJobsAndEqualPanelsAreOnePlan) {
  const InitReport report = init(
      facade(square_panel("north wall", 1).replace(7, 1, "_") + square_panel("b", 2) + square_panel("c", 1)));
  EXPECT_EQ(report.batch.panels, 3U);
  EXPECT_EQ(report.batch.designs, 2U);
  EXPECT_EQ(report.batch.jobs, 3U);
  EXPECT_EQ(report.batch.plans, 2U);
  const JobTable table = jobs();
  ASSERT_EQ(table.jobs.size(), 3U);
  EXPECT_EQ(table.jobs[0].panel, "north_wall");
  EXPECT_EQ(table.jobs[0].key, table.jobs[2].key);
  EXPECT_NE(table.jobs[0].key, table.jobs[1].key);
  std::set<std::string> planned;
  for (int i = 0; i < report.batch.chunks; ++i) {
    for (const PlannedKey& one : read_chunk(directory_, i)) {
      EXPECT_EQ(chunk_of(one.key, report.batch.chunks), i);
      EXPECT_TRUE(planned.insert(one.key).second);
      EXPECT_TRUE(fs::exists(directory_.design(one.design_sha256)));
      EXPECT_THAT(read_bytes(directory_.settings(one.settings_sha256)), HasSubstr("units = \"mm\""));
    }
  }
  EXPECT_EQ(planned.size(), 2U);
}

TEST_F(BatchInit, SweepsMultiplyAndAreColumns) {
  Asked asked = facade(square_panel("a", 1) + square_panel("b", 2));
  asked.sweeps = {"design.tolerance_mm=0.5,1", "blade.free_lengths_mm=[400,600],[800]"};
  asked.sweep_file = write("sweep.csv", "motion.feed_mm_s,design.keep\n5,below\n6,above\n7,\"below\"\n");
  EXPECT_EQ(init(asked).batch.jobs, 24U);
  const JobTable table = jobs();
  EXPECT_THAT(table.keys,
              ElementsAre("design.tolerance_mm", "blade.free_lengths_mm", "motion.feed_mm_s", "design.keep"));
  EXPECT_THAT(table.jobs[0].values, ElementsAre("0.5", "[400,600]", "5", "below"));
  EXPECT_THAT(table.jobs[11].values, ElementsAre("1", "[800]", "7", "below"));
  EXPECT_EQ(table.jobs[11].panel, "a");
}

TEST_F(BatchInit, AListGivesEachDesignItsUnitGroupAndSettings) {
  write("one.obj", square_panel("a", 1) + square_panel("b", 2));
  write("broken.obj", "v 1 2\nf 1 2 3\n");
  Asked asked;
  asked.list = write("designs.csv",
                     "path,units,up,group,design.tolerance_mm\r\none.obj,mm,,a,0.5\r\none.obj,cm,y,b,\r\n"
                     "one.obj,mm,,,\r\nbroken.obj,m,,,2\r\none.obj,mm,,,\r\n");
  const InitReport report = init(asked);
  EXPECT_EQ(report.batch.panels, 5U);
  EXPECT_EQ(report.batch.designs, 4U);
  const JobTable table = jobs();
  EXPECT_THAT(table.keys, ElementsAre("design.tolerance_mm"));
  std::vector<std::string> names;
  for (const Job& job : table.jobs) names.push_back(job.panel);
  EXPECT_THAT(names, ElementsAre("one:a", "one:b", "one", "broken", "one#2"));
  EXPECT_EQ(table.jobs[2].key, table.jobs[4].key);
  for (int i = 0; i < report.batch.chunks; ++i) {
    for (const PlannedKey& one : read_chunk(directory_, i)) {
      if (one.key != table.jobs[3].key) continue;
      EXPECT_EQ(read_bytes(directory_.design(one.design_sha256)),
                "v 1 2\nf 1 2 3\n");  // as it is, lines and all
      EXPECT_THAT(read_bytes(directory_.settings(one.settings_sha256)), HasSubstr("tolerance_mm = 2"));
    }
  }
}

// As `plan` takes it, though the batch keeps designs by their hashes.
// A file may be called as the second use of another would be.
TEST_F(BatchInit, NoTwoListedDesignsHaveOneName) {
  DesignList list;
  for (const char* name : {"x", "x", "x#2", "x", "y", "x#2"}) {
    list.designs.emplace_back();
    list.designs.back().name = name;
  }
  std::vector<std::string> names;
  for (const NamedDesign& one : named_designs(list)) names.push_back(one.name);
  EXPECT_THAT(names, ElementsAre("x", "x#3", "x#2", "x#4", "y", "x#2#2"));
}

TEST_F(BatchInit, AListGivesUnitsInOnePlaceAndItsLineWithASettingThatIsWrongBesideOthers) {
  (void)write("a.obj", square_panel("a", 1));
  Asked asked;
  const auto refused = [&](const std::string& list) {
    asked.list = write("list.csv", list);
    return thrown([&] { (void)init(asked); });
  };
  EXPECT_THAT(refused("path,units,design.units\na.obj,mm,cm\n"),
              HasSubstr("list.csv:1: design.units: call the column `units`"));
  EXPECT_THAT(refused("path,units,design.up\na.obj,mm,y\n"), HasSubstr("call the column `up`"));
  const std::string said = refused("path,units,stock.sizes_mm\na.obj,mm,\na.obj,mm,\"[[300, 300, 300]]\"\n");
  EXPECT_THAT(said, HasSubstr("list.csv:3: "));
  EXPECT_THAT(said, HasSubstr("is within none of stock.sizes_mm"));
}

TEST_F(BatchInit, AListedFilesFormatIsThatOfItsOwnNameAndBytes) {
  const std::string text =
      "solid part\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
      "endloop\nendfacet\nendsolid part\n";
  const std::map<std::string, std::string> files{{"a.obj", square_panel("a", 1)},
                                                 {"t.stl", text},
                                                 {"p.ply", "ply\nformat ascii 1.0\nend_header\n"},
                                                 {"g.glb", std::string("glTF\2\0\0\0", 8)},
                                                 {"lies.ply", text},
                                                 {"given.dat", text}};
  Asked asked;
  asked.units = "mm";
  std::string list = "path,group,design.format\n";
  for (const auto& [name, bytes] : files) {
    write(name, bytes);
    list += name + (name == "t.stl" ? ",part," : name == "given.dat" ? ",,stl" : ",,") + "\n";
  }
  asked.list = write("designs.csv", list);
  const InitReport report = init(asked);
  std::map<std::string, PlannedKey> planned;
  for (int i = 0; i < report.batch.chunks; ++i)
    for (const PlannedKey& one : read_chunk(directory_, i)) planned[one.key] = one;
  const std::map<std::string, std::string> formats{{"a", "auto"}, {"t:part", "stl"}, {"p", "ply"},
                                                   {"g", "gltf"}, {"lies", "ply"},   {"given", "stl"}};
  for (const Job& job : jobs().jobs) {
    const PlannedKey& plan = planned.at(job.key);
    const std::string settings = read_bytes(directory_.settings(plan.settings_sha256));
    EXPECT_THAT(settings, HasSubstr("format = \"" + formats.at(job.panel) + "\"")) << job.panel;
    EXPECT_THAT(settings, HasSubstr(job.panel == "t:part" ? "group = \"part\"" : "group = \"\""))
        << job.panel;
    // glTF is in metres, whatever the others are in.
    EXPECT_THAT(settings, HasSubstr(job.panel == "g" ? "units = \"m\"" : "units = \"mm\"")) << job.panel;
    EXPECT_THAT(settings, HasSubstr(job.panel == "g" ? "up = \"y\"" : "up = \"z\"")) << job.panel;
    if (job.panel == "t:part" || job.panel == "lies") {
      EXPECT_EQ(read_bytes(directory_.design(plan.design_sha256)), text);
    }
  }
}

TEST_F(BatchInit, WrongSettingsAreSaidBeforeAnythingIsWritten) {
  const Asked good = facade(square_panel("a", 1));
  const auto refused = [&](const std::function<void(Asked&)>& change) {
    Asked asked = good;
    change(asked);
    return thrown([&] { (void)init(asked); });
  };
  EXPECT_THAT(refused([](Asked& a) { a.units.clear(); }), HasSubstr("no unit given"));
  EXPECT_THAT(refused([](Asked& a) { a.assignments.emplace_back("design.facing_max_deg=60"); }),
              HasSubstr("given without design.facing"));
  EXPECT_THAT(refused([](Asked& a) { a.sweeps = {"design.tolerance_mm=1,-1"}; }),
              HasSubstr("design.tolerance_mm"));
  EXPECT_THAT(refused([](Asked& a) { a.sweeps = {"design.toll=1"}; }), HasSubstr("design.toll"));
  EXPECT_THAT(refused([](Asked& a) { a.sweeps = {"design.tolerance_mm"}; }), HasSubstr("KEY=VALUE"));
  EXPECT_THAT(refused([](Asked& a) {
                a.sweeps = {"slice.gaps=apart", "slice.gaps=bridge"};
              }),
              HasSubstr("slice.gaps is swept twice"));
  EXPECT_THAT(refused([](Asked& a) { a.assignments = {"design.group=a"}; }),
              HasSubstr("design.group is set"));
  EXPECT_FALSE(fs::exists(directory_.path()));
}

TEST_F(BatchInit, ABatchThatIsThereIsLeftAlone) {
  const Asked asked = facade(square_panel("a", 1));
  (void)init(asked);
  EXPECT_THAT(thrown([&] { (void)init(asked); }), HasSubstr("already there: use --update"));
  EXPECT_THAT(thrown([&] { (void)init_batch(BatchDirectory(files_ / "none"), std::nullopt, true, {}); }),
              HasSubstr("no batch is here"));
}

// All files of a directory with their bytes and times of change.
std::map<std::string, std::pair<std::string, fs::file_time_type>> snapshot(const fs::path& directory) {
  std::map<std::string, std::pair<std::string, fs::file_time_type>> files;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(directory)) {
    if (entry.is_regular_file())
      files[entry.path().lexically_relative(directory)] = {read_bytes(entry.path()), entry.last_write_time()};
  }
  return files;
}

TEST_F(BatchInit, AnUpdateWithNothingNewWritesNothing) {
  (void)init(facade(square_panel("a", 1) + square_panel("b", 2)));
  const auto before = snapshot(directory_.path());
  const InitReport report = init(std::nullopt, true);  // as asked before
  EXPECT_EQ(report.chunks_changed, 0);
  EXPECT_EQ(snapshot(directory_.path()), before);
}

TEST_F(BatchInit, ANewPanelAnywhereChangesOneChunkAndDropsItsStampAlone) {
  std::string many;
  for (int i = 0; i < 60; ++i) many += square_panel("p" + std::to_string(i), i);
  Asked asked = facade(many);
  asked.chunk_minutes = 0.2;
  const int chunks = init(asked).batch.chunks;
  ASSERT_EQ(chunks, 8);  // 60 plans of 1.5 s in chunks of 12 s
  for (int i = 0; i < chunks; ++i) std::ofstream(directory_.stamp(i)) << "\n";
  (void)facade(square_panel("first", 1000) + many);
  const InitReport report = init(std::nullopt, true);
  EXPECT_EQ(report.batch.chunks, chunks);
  EXPECT_EQ(report.chunks_changed, 1);
  int stamps = 0;
  for (int i = 0; i < chunks; ++i) stamps += fs::exists(directory_.stamp(i)) ? 1 : 0;
  EXPECT_EQ(stamps, chunks - 1);
}

TEST_F(BatchInit, WhatWasChangedByHandIsRefused) {
  (void)init(facade(square_panel("a", 1)));
  std::string text = read_bytes(directory_.batch());
  std::ofstream(directory_.batch()) << text.replace(text.find("\"chunks\": 1"), 11, "\"chunks\": 2");
  EXPECT_THAT(thrown([&] { (void)read_batch(directory_); }), HasSubstr("was changed"));
  std::ofstream(directory_.batch()) << text.replace(text.find("\"chunks\": 2"), 11, "\"chunks\": 1");
  std::ofstream(directory_.jobs(), std::ios::app) << "2,b,0,0\n";
  EXPECT_THAT(thrown([&] { (void)jobs(); }), HasSubstr("not that of batch.json"));
}

// ---- estimates ----

TEST(Batch, WhatPlansTookIsTheEstimateOfTheOthers) {
  const StandInBatch batch({1, 2, 3});
  EXPECT_DOUBLE_EQ(read_batch(batch.directory()).estimate_s, 1.5 + 0.1 * 0.01 + 1e-5 * 2);
  EXPECT_EQ(measured_plan_s(batch.directory()), std::nullopt);
  (void)batch.run();
  std::vector<double> seconds;
  for (const Job& job : read_jobs(batch.directory(), read_batch(batch.directory())).jobs)
    seconds.push_back(read_result(batch.directory().result(job.key)).seconds);
  const InitReport update = init_batch(batch.directory(), std::nullopt, true, {});
  EXPECT_DOUBLE_EQ(update.batch.estimate_s, median_of(seconds));
  EXPECT_LT(update.batch.estimate_s, 1);
  EXPECT_EQ(update.batch.minutes, 30);  // three times what was asked
}

TEST(Batch, AChunkMayTakeAsLongAsItsPlansTook) {
  const StandInBatch batch({1, 2, 3}, 0.5);
  (void)batch.run();
  // As if a plan had taken ten minutes.
  for (const Job& job : read_jobs(batch.directory(), read_batch(batch.directory())).jobs) {
    Result result = read_result(batch.directory().result(job.key));
    result.seconds = 600;
    std::ofstream(batch.directory().result(job.key) / "result.json") << result_text(result);
  }
  const InitReport update = init_batch(batch.directory(), std::nullopt, true, {});
  EXPECT_EQ(update.batch.chunks, 1);  // stays
  EXPECT_EQ(update.batch.minutes, 3 * 30);
}

TEST(Batch, AMedianIsTheMiddleOne) {
  EXPECT_EQ(median_of({3}), 3);
  EXPECT_EQ(median_of({9, 1, 5}), 5);
  EXPECT_EQ(median_of({9, 1, 5, 7}), 7);
  EXPECT_THROW((void)median_of({}), std::logic_error);
}

// ---- keys ----

const KeyParts kParts{"0.2.0", "c0ffee", "avx2", "5e77", "de51", "thumb", "program"};

TEST(Batch, KeyChangesWithEachOfItsParts) {
  std::set<std::string> keys{key_of(kParts)};
  std::string KeyParts::*const parts[] = {
      &KeyParts::version,       &KeyParts::commit,   &KeyParts::simd, &KeyParts::settings_sha256,
      &KeyParts::design_sha256, &KeyParts::pictures, &KeyParts::keep};
  for (std::string KeyParts::*part : parts) {
    KeyParts other = kParts;
    (other.*part)[0] ^= 1;
    keys.insert(key_of(other));
  }
  EXPECT_EQ(keys.size(), 8U);
  EXPECT_EQ(key_of(kParts), key_of(KeyParts(kParts)));
}

TEST_F(BatchInit, KeyChangesWithASettingAndAByteAndNotWithNameOrOrder) {
  (void)init(facade(square_panel("a", 1) + square_panel("b", 2)));
  const JobTable first = jobs();
  (void)init(facade(square_panel("x", 2) + square_panel("y", 1)), true);
  EXPECT_EQ(jobs().jobs[0].key, first.jobs[1].key);
  EXPECT_EQ(jobs().jobs[1].key, first.jobs[0].key);
  std::set<std::string> keys{first.jobs[0].key};
  Asked asked = facade(square_panel("a", 1));
  for (const char* setting : {"design.tolerance_mm=0.9", "blade.kerf_mm=1.6", "motion.waypoint_s=0.04"}) {
    asked.assignments = {setting};
    (void)init(asked, true);
    EXPECT_TRUE(keys.insert(jobs().jobs[0].key).second) << setting;
  }
  (void)init(facade(square_panel("a", 1.000001)), true);
  EXPECT_TRUE(keys.insert(jobs().jobs[0].key).second);
}

TEST(Batch, ChunksShareTheKeysEvenly) {
  std::vector<int> counts(10);
  for (int i = 0; i < 10'000; ++i) {
    KeyParts parts = kParts;
    parts.design_sha256 = std::to_string(i);
    ++counts[static_cast<std::size_t>(chunk_of(key_of(parts), 10))];
  }
  for (const int count : counts) EXPECT_NEAR(count, 1000, 150);  // five standard deviations
}

// ---- tables ----

TEST(Batch, TablesAreReadAsTheyAreWritten) {
  const std::vector<std::string> odd{"plain", "a,b", "he said \"no\"", "two\nlines", "", " blank "};
  const CsvTable table = parse_csv(csv_line({"a", "b", "c", "d", "e", "f"}) + "\n" + csv_line(odd), "t.csv");
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_EQ(table.rows[0].cells, odd);
  EXPECT_EQ(table.rows[0].line, 3U);
}

TEST(Batch, WhatIsNoTableIsRefusedWithItsLine) {
  const auto refusal = [](const std::string& text) {
    return thrown([&] { (void)parse_csv(text, "t.csv"); });
  };
  EXPECT_EQ(refusal(""), "t.csv:1: no columns: the first line names them");
  EXPECT_EQ(refusal("a,b\n1,2\n1\n"), "t.csv:3: 1 cells (the first line names 2 columns)");
  EXPECT_EQ(refusal("a,b\n1,\"2\n"), "t.csv:2: a quote that is not closed");
  EXPECT_EQ(refusal("a,b\n1,2\"\n"),
            "t.csv:2: a quote inside a cell: quote the whole cell, and double the quotes in it");
  EXPECT_EQ(refusal("a,a\n"), "t.csv:1: column a is there twice: leave one");
  EXPECT_EQ(refusal("a,\n"), "t.csv:1: column 2 has no name");
}

}  // namespace
}  // namespace hotblade::pipeline::batch
