// Lines of designs as they were given. A plan names lines of its panel's own text; what a user has open is
// the facade that the panel was taken from.
#pragma once

#include "pipeline/batch/batch_facts.hpp"

namespace hotblade::pipeline::batch {

// Names the given files and their lines in messages and warnings, of equal panels those of the first. The
// designs are read again only where a plan names a line, and their lines hold only where the panel is still
// what was planned: where the file is missing, unreadable or changed since, the text stays as the plan has
// it.
void name_given_lines(const BatchDirectory& directory, BatchFacts& all);

}  // namespace hotblade::pipeline::batch
