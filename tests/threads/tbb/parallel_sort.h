#pragma once

#include "tests/threads/tbb_over_threads.hpp"
