#include "pipeline/cli/operator_answer.hpp"

namespace hotblade::pipeline {

bool agrees_to_start(std::string_view answer, std::string_view strip_id) {
  return answer == "yes" || answer == strip_id;
}

}  // namespace hotblade::pipeline
