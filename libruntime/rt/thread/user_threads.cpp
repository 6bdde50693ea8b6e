// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/thread/user_threads.h"

#include <algorithm>
#include <array>
#include <deque>
#include <list>

#include <dlfcn.h>
#include <execinfo.h>
#include <link.h>
#include <pthread.h>

#include "base/mutex.h"
#include "rt/thread/run_guarded.h"

namespace mauve::rt {
namespace {

/// The callers of pthread_create(), the innermost first.
struct Started {
  std::array<void*, 24> callers{};
  int count = 0;
  pthread_t thread{};
  bool known = false;  // which thread it is
};

struct Registry {
  Mutex mutex;
  std::list<Started> threads MAUVE_GUARDED_BY(mutex);
  /// The newest ones that have ended: who started them may not have joined them yet.
  std::deque<pthread_t> ended MAUVE_GUARDED_BY(mutex);

  static constexpr std::size_t kMostEnded = 64;

  void note_end(const Started& one) MAUVE_REQUIRES(mutex) {
    if (one.known) ended.push_back(one.thread);
    if (ended.size() > kMostEnded) ended.pop_front();
  }
  /// A new thread may have the handle of one that has been joined.
  void forget_end(pthread_t thread) MAUVE_REQUIRES(mutex) {
    std::erase_if(ended, [thread](pthread_t one) { return pthread_equal(one, thread) != 0; });
  }
};

/// Never destroyed: threads may end while the process does.
Registry& registry() {
  static auto* const one = new Registry;
  return *one;
}

struct Search {
  std::uintptr_t address;
  CodeRange found;
};

int look_into(dl_phdr_info* object, std::size_t /*size*/, void* search_of) {
  auto& search = *static_cast<Search*>(search_of);
  CodeRange range{~std::uintptr_t{0}, 0};
  for (int i = 0; i < object->dlpi_phnum; ++i) {
    const ElfW(Phdr)& part = object->dlpi_phdr[i];
    if (part.p_type != PT_LOAD) continue;
    const std::uintptr_t begin = object->dlpi_addr + part.p_vaddr;
    range.begin = std::min(range.begin, begin);
    range.end = std::max(range.end, begin + part.p_memsz);
  }
  if (!range.contains(search.address)) return 0;
  search.found = range;
  return 1;
}

}  // namespace

CodeRange code_around(const void* address) {
  Search search{reinterpret_cast<std::uintptr_t>(address), {}};
  dl_iterate_phdr(look_into, &search);
  return search.found;
}

std::vector<std::string> threads_started_by(const CodeRange& range) {
  std::vector<std::string> names;
  Registry& all = registry();
  const mauve::MutexLock lock(all.mutex);
  for (const Started& one : all.threads) {
    const auto* const end = one.callers.data() + one.count;
    const bool ours = std::any_of(one.callers.data(), end, [&](const void* caller) {
      return range.contains(reinterpret_cast<std::uintptr_t>(caller));
    });
    if (!ours) continue;
    std::array<char, 16> name{};
    if (one.known) pthread_getname_np(one.thread, name.data(), name.size());
    names.emplace_back(name.data());
  }
  return names;
}

bool started_in_body(pthread_t thread) {
  Registry& all = registry();
  const mauve::MutexLock lock(all.mutex);
  const auto is_it = [thread](pthread_t one) { return pthread_equal(one, thread) != 0; };
  return std::any_of(all.ended.begin(), all.ended.end(), is_it) ||
         std::any_of(all.threads.begin(), all.threads.end(),
                     [&](const Started& one) { return one.known && is_it(one.thread); });
}

}  // namespace mauve::rt

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which have their own
namespace {

using mauve::rt::registry;
using mauve::rt::Started;

/// Is the calling thread one of them?
bool& started_by_user_code() {
  [[gnu::tls_model("initial-exec")]] static thread_local bool started = false;
  return started;
}

/// The arguments that such a thread begins with.
struct Start {
  void* (*function)(void*);
  void* argument;
  std::list<Started>::iterator entry;
};

void* run_started(void* start_of) {
  // Leaves the registry however the thread ends, also by pthread_exit().
  struct Entry {
    std::list<Started>::iterator self;
    ~Entry() {
      auto& all = registry();
      const mauve::MutexLock lock(all.mutex);
      all.note_end(*self);
      all.threads.erase(self);
    }
  };
  const Start start = *static_cast<Start*>(start_of);
  delete static_cast<Start*>(start_of);
  const Entry entry{start.entry};
  const mauve::rt::FaultStack stack;  // the safe values are written also when its own is full
  started_by_user_code() = true;
  return start.function(start.argument);
}

}  // namespace

extern "C" {

/// Stands before that of the C library.
int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*function)(void*),
                   void* argument) noexcept {
  using Create = int(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  static auto* const create = reinterpret_cast<Create*>(dlsym(RTLD_NEXT, "pthread_create"));
  auto& all = registry();
  if (!mauve::rt::in_body() && !started_by_user_code()) {
    const int error = create(thread, attributes, function, argument);
    const mauve::MutexLock lock(all.mutex);
    if (error == 0) all.forget_end(*thread);
    return error;
  }
  Started started;
  started.count = backtrace(started.callers.data(), static_cast<int>(started.callers.size()));
  auto* const start = new Start{function, argument, {}};
  // The new thread leaves the registry under this lock, so its entry is there until it is complete.
  const mauve::MutexLock lock(all.mutex);
  const auto entry = start->entry = all.threads.insert(all.threads.end(), started);
  const int error = create(thread, attributes, run_started, start);
  if (error != 0) {
    all.threads.erase(entry);
    delete start;
  } else {
    all.forget_end(*thread);
    entry->thread = *thread;
    entry->known = true;
  }
  return error;
}

}  // extern "C"
#endif
