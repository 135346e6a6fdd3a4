// The commit that this build is made from. Another program may plan otherwise, so that it stands in the key
// of every plan.
#pragma once

#include <string_view>

namespace hotblade::pipeline::batch {

// Returns twelve digits, with + and a hash where the sources were changed since; `unknown` without a
// repository.
[[nodiscard]] std::string_view commit();

}  // namespace hotblade::pipeline::batch
