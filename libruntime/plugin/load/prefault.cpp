// SPDX-License-Identifier: LGPL-3.0-or-later
#include "plugin/load/prefault.h"

#include <link.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>

#ifndef MADV_POPULATE_READ  // Linux 5.14
#define MADV_POPULATE_READ 22
#define MADV_POPULATE_WRITE 23
#endif

namespace mauve::plugin {

namespace {

/// Whole pages; a kernel without the call leaves the faults to memory locking.
void populate(std::uintptr_t begin, std::uintptr_t end, int advice) {
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  begin -= begin % page;
  if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, advice);
}

bool holds(const dl_phdr_info& object, std::uintptr_t address) {
  return std::any_of(object.dlpi_phdr, object.dlpi_phdr + object.dlpi_phnum, [&](const auto& part) {
    const std::uintptr_t begin = object.dlpi_addr + part.p_vaddr;
    return part.p_type == PT_LOAD && address >= begin && address - begin < part.p_memsz;
  });
}

int visit(dl_phdr_info* object, std::size_t /*size*/, void* address) {
  if (!holds(*object, reinterpret_cast<std::uintptr_t>(address))) return 0;
  // Pages that the linker made read-only after relocation cannot be populated for writing, and need
  // not be.
  std::uintptr_t sealed = 0;
  for (int i = 0; i < object->dlpi_phnum; ++i) {
    const ElfW(Phdr)& part = object->dlpi_phdr[i];
    if (part.p_type == PT_GNU_RELRO) sealed = object->dlpi_addr + part.p_vaddr + part.p_memsz;
  }
  for (int i = 0; i < object->dlpi_phnum; ++i) {
    const ElfW(Phdr)& part = object->dlpi_phdr[i];
    if (part.p_type != PT_LOAD) continue;
    const std::uintptr_t begin = object->dlpi_addr + part.p_vaddr;
    const std::uintptr_t end = begin + part.p_memsz;
    populate(begin, end, MADV_POPULATE_READ);
    if ((part.p_flags & PF_W) != 0) populate(std::max(begin, sealed), end, MADV_POPULATE_WRITE);
  }
  return 1;
}

}  // namespace

void prefault(const void* address) { dl_iterate_phdr(visit, const_cast<void*>(address)); }

}  // namespace mauve::plugin
