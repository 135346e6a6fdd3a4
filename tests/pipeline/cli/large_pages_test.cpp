// A program of its own, as all that it allocates is asked for.
#include "pipeline/cli/large_pages.hpp"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <cstring>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace hotblade::pipeline {
namespace {

constexpr std::size_t kMb = 1 << 20;

long faults() {
  rusage used{};
  getrusage(RUSAGE_THREAD, &used);
  return used.ru_minflt;
}

// How often the system gave this thread a page as it wrote so many pieces of this size, all held.
long faults_of(std::size_t pieces, std::size_t bytes) {
  const long before = faults();
  std::vector<std::unique_ptr<char[]>> held;
  for (std::size_t i = 0; i < pieces; ++i) {
    held.push_back(std::make_unique_for_overwrite<char[]>(bytes));
    std::memset(held.back().get(), static_cast<int>(i), bytes);
  }
  EXPECT_EQ(held.back()[bytes - 1], static_cast<char>(pieces - 1));
  return faults() - before;
}

// Whether the system gives large pages to who asks now: it has none where memory is in pieces.
bool given() {
  constexpr std::size_t kBytes = 16 * kMb;
  void* place = mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (place == MAP_FAILED) return false;
  (void)madvise(place, kBytes, MADV_HUGEPAGE);
  const long before = faults();
  std::memset(place, 1, kBytes);
  const long all = faults() - before;
  munmap(place, kBytes);
  return all < static_cast<long>(kBytes / 4096) / 3;  // the ends have small ones
}

class LargePages : public testing::Test {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "a sanitizer allocates";
#endif
    std::ifstream file("/sys/kernel/mm/transparent_hugepage/enabled");
    std::string choice;
    std::getline(file, choice);
    if (choice.empty() || choice.find("[never]") != std::string::npos)
      GTEST_SKIP() << "the system gives no large pages: " << choice;
    if (!given()) GTEST_SKIP() << "the system gives no large pages now: " << choice;
    static const bool asked = (use_large_pages(), true);
    ASSERT_TRUE(asked);
  }
  static constexpr long kSmallPage = 4096, kFew = 4;
  // A quarter of what small pages would be; one in 512 where all are large.
  static constexpr long few(std::size_t mb) {
    return static_cast<long>(mb * kMb) / kSmallPage / kFew;
  }
};

TEST_F(LargePages, HoldSmallPieces) {
  EXPECT_LT(faults_of(1000, 64 << 10), few(62));
}

TEST_F(LargePages, HoldLargePieces) {
  EXPECT_LT(faults_of(2, 32 * kMb), few(64));
}

TEST_F(LargePages, HoldThoseOfOtherThreads) {
  long own = 0;
  std::thread([&] { own = faults_of(200, 64 << 10); }).join();
  EXPECT_LT(own, few(12) + 512);  // the first page is in use before it is asked for
}

TEST_F(LargePages, NothingIsLostByThem) {
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < 2000; ++i) texts.emplace_back(i * 37 % 9000, static_cast<char>('a' + i % 26));
  for (std::size_t i = 0; i < texts.size(); ++i)
    EXPECT_EQ(texts[i], std::string(i * 37 % 9000, static_cast<char>('a' + i % 26)));
}

}  // namespace
}  // namespace hotblade::pipeline
