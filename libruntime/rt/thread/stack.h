// SPDX-License-Identifier: LGPL-3.0-or-later
/// The stacks of ordinary threads. Memory is locked, so the 8 MB of the system would be real.
/// Below each stack lies a guard page: a thread whose stack is full gets SIGSEGV.
#pragma once

#include <cstddef>
#include <cstdint>

namespace mauve::rt {

/// Of each thread of mauved that asks for no size of its own, also of one that a plugin starts.
inline constexpr std::size_t kOrdinaryStack = std::size_t{512} * 1024;

/// Of the thread that runs constructors, hooks and destructors of plugins: as much as a program
/// usually has.
inline constexpr std::size_t kHookStack = std::size_t{8} * 1024 * 1024;

/// New threads of this process that ask for no size have a stack of `bytes`. Call it before the
/// first thread starts. The main thread is as before, and so are threads under a sanitizer.
void set_default_stack(std::size_t bytes);

/// Is this address just below the stack of the calling thread? A fault there says that the stack
/// is full.
[[nodiscard]] bool below_stack(std::uintptr_t address);

/// While it lives, the stack of the calling thread is locked only as far as it was used. Its first
/// use of a page is a page fault, so it is for ordinary threads. Without locked memory it does
/// nothing.
class LockedAsUsed {
 public:
  LockedAsUsed();
  ~LockedAsUsed();
  LockedAsUsed(const LockedAsUsed&) = delete;
  LockedAsUsed& operator=(const LockedAsUsed&) = delete;

 private:
  void* begin_ = nullptr;  ///< null: nothing was done
  std::size_t size_ = 0;
};

}  // namespace mauve::rt
