// What hotblade/batch.py reads of a batch's directory.
#include "pipeline/batch/batch.hpp"

#include <nlohmann/json.hpp>

#include "gpu/backend/stop.hpp"
#include "pipeline/batch/batch_facts.hpp"
#include "pipeline/batch/given_lines.hpp"
#include "pipeline/batch/result.hpp"
#include "pipeline/batch/status.hpp"
#include "python/module.hpp"

namespace hotblade::python {
namespace {

namespace batch = pipeline::batch;

batch::BatchDirectory batch_at(const py::object& place) {
  return batch::BatchDirectory(path_of(place, "directory"));
}

// Runs what reads files of a batch.
template <typename Work>
auto reading_batch(const batch::BatchDirectory& directory, const Work& work) {
  return placed(work, [&](const std::string& what) { throw_placed_below(what, directory.path().string()); });
}

// What was asked, the settings that change from job to job, and of every job number, panel, key, chunk and
// values.
py::tuple open_batch(const py::object& place) {
  const batch::BatchDirectory directory = batch_at(place);
  batch::Batch made;
  batch::JobTable table;
  {
    const Unlocked release;
    reading_batch(directory, [&] {
      made = read_batch(directory);
      table = read_jobs(directory, made);
    });
  }
  using namespace py::literals;
  const py::dict facts("version"_a = made.version, "commit"_a = made.commit, "simd"_a = made.simd,
                       "panels"_a = made.panels, "designs"_a = made.designs, "jobs"_a = made.jobs,
                       "plans"_a = made.plans, "chunks"_a = made.chunks,
                       "asked"_a = to_python(to_json(made.asked)));
  py::list jobs;
  for (const batch::Job& job : table.jobs)
    jobs.append(py::make_tuple(job.number, path_text(job.panel), job.key, job.chunk, texts(job.values)));
  return py::make_tuple(facts, texts(table.keys), jobs);
}

// By key the hashes of design and settings, of one chunk.
py::dict planned_keys(const py::object& place, int chunk) {
  py::dict all;
  const batch::BatchDirectory directory = batch_at(place);
  for (const batch::PlannedKey& planned :
       reading_batch(directory, [&] { return unlocked([&] { return read_chunk(directory, chunk); }); }))
    all[py::str(planned.key)] = py::make_tuple(planned.design_sha256, planned.settings_sha256);
  return all;
}

py::object batch_status(const py::object& place) {
  const batch::BatchDirectory directory = batch_at(place);
  return to_python(
      reading_batch(directory, [&] { return unlocked([&] { return to_json(status_of(directory)); }); }));
}

py::tuple job_files(const py::object& place, const std::string& key, const std::string& design_sha256,
                    const std::string& settings_sha256) {
  const batch::BatchDirectory directory = batch_at(place);
  return py::make_tuple(path_text(directory.result(key).string()),
                        path_text(directory.design(design_sha256).string()),
                        path_text(directory.settings(settings_sha256).string()));
}

py::object job_result(const py::object& place, const std::string& key) {
  const batch::BatchDirectory directory = batch_at(place);
  const std::string text = reading_batch(directory, [&] {
    const Unlocked release;
    return has_result(directory, key) ? result_text(batch::read_result(directory.result(key))) : "";
  });
  return text.empty() ? py::none() : parsed(text);
}

// A number that a table has as text; its text where it is none.
py::object cell_value(const batch::Cell& cell) {
  if (!cell.number) return path_text(cell.text);
  return py::float_(py::str(cell.text));
}

// The columns of the plans in results.csv, and their values job by job.
py::tuple batch_table(const py::object& place, const py::object& partly, const py::object& progress) {
  const batch::BatchDirectory directory = batch_at(place);
  const bool partial = truth(partly, "partial");
  batch::BatchFacts all;
  reading_batch(directory, [&] {
    run_watched(py::int_(1), progress, [&](const Tell& tell) {
      batch::GatherHooks hooks;
      hooks.progress = [&tell](double share) { tell("gather", share); };
      all = read_facts(directory, partial, hooks);
      name_given_lines(directory, all);
    });
  });
  py::list rows;
  for (const batch::JobFacts& job : all.rows()) {
    py::list row;
    for (const batch::Cell& cell : job.facts->cells) row.append(cell_value(cell));
    rows.append(row);
  }
  return py::make_tuple(texts(batch::plan_columns()), rows);
}

}  // namespace

void add_batch(py::module_& module) {
  py::module_ batch = module.def_submodule("batch", "Batches; use them through `hotblade.Batch`");
  batch.def(
      "path", [](const py::object& place) { return path_text(path_of(place, "directory")); },
      py::arg("directory"));
  batch.def("open", &open_batch, py::arg("directory"));
  batch.def("planned", &planned_keys, py::arg("directory"), py::arg("chunk"));
  batch.def("status", &batch_status, py::arg("directory"));
  batch.def("files", &job_files, py::arg("directory"), py::arg("key"), py::arg("design_sha256"),
            py::arg("settings_sha256"));
  batch.def("result", &job_result, py::arg("directory"), py::arg("key"));
  batch.def("table", &batch_table, py::arg("directory"), py::arg("partial"), py::arg("progress"));
}

}  // namespace hotblade::python
