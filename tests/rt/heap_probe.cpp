// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/heap_probe.h"

#include <atomic>
#include <cstdlib>

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* memory);
}

namespace {

std::atomic<std::size_t> total{0};
[[gnu::tls_model("initial-exec")]] thread_local bool watched = false;

void count() {
  if (watched) total.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

extern "C" {
void* malloc(std::size_t size) { return count(), __libc_malloc(size); }
void* calloc(std::size_t n, std::size_t size) { return count(), __libc_calloc(n, size); }
void* realloc(void* memory, std::size_t size) { return count(), __libc_realloc(memory, size); }
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return count(), __libc_memalign(alignment, size);
}
void free(void* memory) {
  if (memory != nullptr) count();
  __libc_free(memory);
}
}

namespace heap {

std::size_t calls() { return total.load(); }
void watch_this_thread(bool on) { watched = on; }

}  // namespace heap
