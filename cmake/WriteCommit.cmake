# cmake -DSOURCE=DIR -DOUTPUT=FILE -P WriteCommit.cmake: writes the source that says which commit a build is made from; it is
# touched only where that has changed.
set(rooms elastica gpu pipeline robot surface)
execute_process(COMMAND git -C "${SOURCE}" rev-parse --short=12 HEAD
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(commit unknown)
else()
  execute_process(COMMAND git -C "${SOURCE}" diff HEAD -- ${rooms} OUTPUT_VARIABLE changes ERROR_QUIET)
  if(changes)
    string(SHA256 hash "${changes}")
    string(SUBSTRING "${hash}" 0 8 hash)
    string(APPEND commit "+${hash}")
  endif()
endif()
file(CONFIGURE OUTPUT "${OUTPUT}" CONTENT [[#include "pipeline/batch/commit.hpp"

namespace hotblade::pipeline::batch {

std::string_view commit() {
  return "@commit@";
}

}  // namespace hotblade::pipeline::batch
]] @ONLY)
