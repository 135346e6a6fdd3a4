// Makes a batch directory, or brings it up to what is asked now: designs split and hashed, settings resolved,
// a key a plan, plans parted into chunks.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "pipeline/batch/batch.hpp"

namespace hotblade::pipeline::batch {

struct InitReport {
  Batch batch;
  std::size_t plans_there = 0;  // that have a result
  int chunks_changed = 0;       // whose lists were written
};

struct InitHooks {
  std::function<void(const std::string& stage, double share)> progress = nullptr;
  std::function<bool()> stop = nullptr;  // asked for each panel
};

// Makes the batch. With `update` one that is there is brought up to date: its number of chunks stays, and
// only the lists that differ are written; `asked` absent repeats what it was asked. All combinations of
// settings are checked before any file is written, and batch.json is written last. Throws Error:
// kBadSettings; kFile, also for a batch that is there without `update`; kBadInput for a list; kInterrupted;
// and surface::MeshError for a line of the design. A listed design that is no OBJ stays in the batch as it
// is: its plan will say why.
[[nodiscard]] InitReport init_batch(const BatchDirectory& directory, std::optional<Asked> asked, bool update,
                                    const InitHooks& hooks);

}  // namespace hotblade::pipeline::batch
