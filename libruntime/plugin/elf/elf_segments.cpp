// SPDX-License-Identifier: LGPL-3.0-or-later
#include "plugin/elf/elf_segments.h"

#include <algorithm>
#include <bit>

namespace mauve::plugin {

namespace {

constexpr GElf_Xword kSmallestPage = 4096;

bool fits(GElf_Addr begin, GElf_Xword size, GElf_Addr from, GElf_Xword room) {
  return begin >= from && size <= room && begin - from <= room - size;
}

/// Whole pages of the file are mapped, so address and offset agree within a page.
bool can_be_mapped(const GElf_Phdr& at) {
  return at.p_filesz <= at.p_memsz && fits(at.p_vaddr, at.p_memsz, 0, kLargestImage) &&
         std::has_single_bit(at.p_align) && at.p_align >= kSmallestPage &&
         at.p_align <= kLargestImage && (at.p_vaddr - at.p_offset) % at.p_align == 0;
}

bool are_placed_in_order(const ElfFile& file) {
  GElf_Addr end = 0;
  for (const GElf_Phdr& at : file.segments()) {
    if (at.p_type != PT_LOAD) continue;
    if (!can_be_mapped(at) || at.p_vaddr < end) return false;
    end = at.p_vaddr + at.p_memsz;
  }
  return end != 0;
}

/// Does a loaded segment contain this one, at the same distance in memory as in the file?
bool is_loaded(const ElfFile& file, const GElf_Phdr& part) {
  return std::ranges::any_of(file.segments(), [&](const GElf_Phdr& at) {
    return at.p_type == PT_LOAD && fits(part.p_vaddr, part.p_memsz, at.p_vaddr, at.p_memsz) &&
           part.p_vaddr - at.p_vaddr == part.p_offset - at.p_offset;
  });
}

}  // namespace

Status check_places(const ElfFile& file) {
  if (!are_placed_in_order(file)) return damaged("its segments overlap or cannot be placed");
  for (const GElf_Phdr& at : file.segments()) {
    const bool placed = at.p_type != PT_LOAD && at.p_type != PT_NULL && at.p_memsz > 0;
    if (placed && !is_loaded(file, at))
      return damaged("a segment lies outside of those that are loaded");
  }
  return ok();
}

}  // namespace mauve::plugin
