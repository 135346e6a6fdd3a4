#include "pipeline/cli/large_pages.hpp"

#include <cstdlib>  // says whether this is the GNU library

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <new>

namespace hotblade::pipeline {
namespace {

constexpr std::size_t kMb = 1 << 20;
constexpr std::uintptr_t kPage = 2 * kMb;

// The allocator has three sources. Its first heap grows upwards from where the program's data ends; a thread
// may have one of its own, cut from stretches of 64 MB that begin at a multiple of that; and pieces from a
// threshold on are mapped one by one.
constexpr std::uintptr_t kHeapSpan = std::uintptr_t{1} << 40;  // that the first heap is below
constexpr std::uintptr_t kStretch = 64 * kMb;
constexpr std::size_t kMapped = kMb;

std::uintptr_t heap = 0;                  // where the first heap begins; 0: nobody asks for large pages
std::atomic<std::uintptr_t> asked_up_to;  // in the first heap
std::array<std::atomic<std::uintptr_t>, 256> asked_stretches;  // by their number

std::uintptr_t address(const void* p) {
  return reinterpret_cast<std::uintptr_t>(p);
}

// Of addresses about a place. Whole pages only: what is next to them stays as it is. What the allocator hands
// back and takes again later has small ones.
void advise(const void* place, std::uintptr_t from, std::uintptr_t to) {
  from = (from + kPage - 1) / kPage * kPage;
  to = to / kPage * kPage;
  if (from >= to) return;
  char* begin =
      static_cast<char*>(const_cast<void*>(place)) + static_cast<std::ptrdiff_t>(from - address(place));
  (void)madvise(begin, to - from, MADV_HUGEPAGE);  // where it fails pages are small
}

void ask_of_heap() {
  const void* place = sbrk(0);
  const std::uintptr_t end = address(place), before = asked_up_to.exchange(end, std::memory_order_relaxed);
  // The page that the end was in is whole now.
  advise(place, std::max(heap, before / kPage * kPage), end);
}

// Of a piece just allocated.
void ask_for(const void* piece, std::size_t size) {
  const std::uintptr_t at = address(piece);
  if (heap == 0 || at < heap) return;
  if (at - heap < kHeapSpan) {
    if (at + size > asked_up_to.load(std::memory_order_relaxed)) ask_of_heap();
  } else if (size >= kMapped) {
    advise(piece, at, at + size);
  } else {
    const std::uintptr_t stretch = at / kStretch;
    auto& asked = asked_stretches[stretch % asked_stretches.size()];
    if (asked.load(std::memory_order_relaxed) == stretch) return;
    asked.store(stretch, std::memory_order_relaxed);
    advise(piece, stretch * kStretch, (stretch + 1) * kStretch);
  }
}

void* allocated(std::size_t size) {
  if (size == 0) size = 1;
  for (;;) {
    if (void* piece = std::malloc(size)) {
      ask_for(piece, size);
      return piece;
    }
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}

}  // namespace

void use_large_pages() {
  // Kept by the allocator pieces serve again: handed back, a fifth of all pages came anew from the system.
  // Those of a megabyte and more, a strip's poses among them, are mapped one by one and leave no gaps: of
  // more than four the roof takes a tenth less time and 16 MB more, which is too much (docs/benchmarks.md).
  mallopt(M_MMAP_THRESHOLD, kMapped);
  mallopt(M_TRIM_THRESHOLD, 32 * kMb);
  mallopt(M_TOP_PAD, 16 * kMb);
  heap = address(sbrk(0));
  asked_up_to = heap;
}

}  // namespace hotblade::pipeline

void* operator new(std::size_t size) {
  return hotblade::pipeline::allocated(size);
}
void* operator new[](std::size_t size) {
  return hotblade::pipeline::allocated(size);
}
void operator delete(void* piece) noexcept {
  std::free(piece);
}
void operator delete(void* piece, std::size_t) noexcept {
  std::free(piece);
}
void operator delete[](void* piece) noexcept {
  std::free(piece);
}
void operator delete[](void* piece, std::size_t) noexcept {
  std::free(piece);
}

#else

namespace hotblade::pipeline {
void use_large_pages() {}
}  // namespace hotblade::pipeline

#endif
