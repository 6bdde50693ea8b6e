// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/guardian/guardian_page.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <new>
#include <string>
#include <system_error>

#include <mauve/host/clock.h>

#include "rt/thread/pi_mutex.h"

namespace mauve::rt {
namespace {

std::atomic<guardian::Page*> heard_page{nullptr};
/// Of the one thread that owns a page. The thread uses no robust mutex, so it needs no other list.
robust_list_head page_list{};

/// The last words of say_starved().
struct {
  PiMutex mutex;
  std::array<char, 64> name{};
  std::size_t size = 0;
  Instant said = 0;  // 0: never
} starved;

Error no_page(const char* doing) {
  return refuse({Errc::system, "guardian_failed"}, "guardian",
                std::string("cannot ") + doing + ": " + std::generic_category().message(errno));
}

void own(guardian::Page& page) {
  auto* const entry = reinterpret_cast<robust_list*>(&page.entry);
  page.entry = &page_list.list;
  page_list.list.next = entry;
  page_list.futex_offset = static_cast<long>(offsetof(guardian::Page, owner)) -
                           static_cast<long>(offsetof(guardian::Page, entry));
}

}  // namespace

bool beats_are_heard() { return heard_page.load(std::memory_order_acquire) != nullptr; }

void beat() {
  guardian::Page* const page = heard_page.load(std::memory_order_acquire);
  if (page != nullptr) page->beats.fetch_add(1, std::memory_order_relaxed);
}

void say_starved(Duration time, std::string_view component) {
  guardian::Page* const page = heard_page.load(std::memory_order_acquire);
  if (page == nullptr) return;
  if (time > Duration{0}) {
    const PiMutexLock lock(starved.mutex);
    starved.size = component.copy(starved.name.data(), starved.name.size());
    starved.said = MonotonicClock().now();
  }
  page->starved_ms.store(static_cast<std::uint32_t>(time / 1ms), std::memory_order_relaxed);
}

std::string starved_component() {
  std::array<char, sizeof starved.name> name{};
  std::size_t size = 0;
  {
    const PiMutexLock lock(starved.mutex);
    const bool lately = MonotonicClock().now() - starved.said < Duration{1s}.count();
    if (starved.said != 0 && lately) size = starved.size;
    name = starved.name;
  }
  return {name.data(), size};
}

namespace guardian {

Status OwnPage::open() {
  file_ = Descriptor(memfd_create("mauve:guardian", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  if (!file_ || ftruncate(file_.get(), sizeof(Page)) != 0) return no_page("make a file in memory");
  if (fcntl(file_.get(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0) {
    return no_page("seal a file in memory");
  }
  void* const memory =
      mmap(nullptr, sizeof(Page), PROT_READ | PROT_WRITE, MAP_SHARED, file_.get(), 0);
  if (memory == MAP_FAILED) return no_page("map a file in memory");
  Page& page = *new (memory) Page{};
  owner_ = static_cast<pid_t>(syscall(SYS_gettid));
  page.version = kVersion;
  page.owner = owner_word(owner_);
  own(page);
  if (syscall(SYS_set_robust_list, &page_list, sizeof page_list) != 0) {
    return no_page("have the kernel mark the end of a thread");
  }
  heard_page.store(&page, std::memory_order_release);
  return ok();
}

void OwnPage::let_go() {
  heard_page.store(nullptr, std::memory_order_release);
  page_list.list.next = &page_list.list;
}

}  // namespace guardian
}  // namespace mauve::rt
