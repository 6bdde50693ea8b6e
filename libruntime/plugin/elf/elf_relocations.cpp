// SPDX-License-Identifier: LGPL-3.0-or-later
#include "plugin/elf/elf_relocations.h"

#include <algorithm>
#include <cstring>
#include <unordered_map>
#include <utility>

namespace mauve::plugin {

namespace {

#if defined(__x86_64__)
constexpr GElf_Xword kRelative = R_X86_64_RELATIVE;
constexpr GElf_Xword kResolved = R_X86_64_IRELATIVE;
#elif defined(__aarch64__)
constexpr GElf_Xword kRelative = R_AARCH64_RELATIVE;
constexpr GElf_Xword kResolved = R_AARCH64_IRELATIVE;
#elif defined(__riscv)
constexpr GElf_Xword kRelative = R_RISCV_RELATIVE;
constexpr GElf_Xword kResolved = R_RISCV_IRELATIVE;
#endif

constexpr GElf_Sxword kPackedRelocations = 36;  // DT_RELR, which older <elf.h> do not know

/// From where a pointer lies to the address it gets, both before the plugin is placed.
using Pointers = std::unordered_map<GElf_Addr, GElf_Addr>;

/// Do so many bytes at this address lie in one segment with this right, PF_W or PF_X?
bool lies_in(const ElfFile& file, GElf_Word right, GElf_Addr address, GElf_Xword size) {
  return std::ranges::any_of(file.segments(), [&](const GElf_Phdr& at) {
    return at.p_type == PT_LOAD && (at.p_flags & right) != 0 && address >= at.p_vaddr &&
           size <= at.p_memsz && address - at.p_vaddr <= at.p_memsz - size;
  });
}

bool is_code(const ElfFile& file, GElf_Addr address) { return lies_in(file, PF_X, address, 1); }

/// Also between two segments, which is mapped without any right, and at the very end.
bool is_in_image(const ElfFile& file, GElf_Addr address) {
  GElf_Addr end = 0;
  for (const GElf_Phdr& at : file.segments()) {
    if (at.p_type == PT_LOAD) end = std::max(end, at.p_vaddr + at.p_memsz);
  }
  return address <= end;
}

Status check_one(const ElfFile& file, const Elf64_Rela& one, std::size_t symbols) {
  const GElf_Xword type = ELF64_R_TYPE(one.r_info);
  const auto address = static_cast<GElf_Addr>(one.r_addend);
  if (type == 0) return ok();  // it does nothing
  if (!lies_in(file, PF_W, one.r_offset, sizeof(Elf64_Addr))) {
    return damaged("a relocation writes outside of its data");
  }
  if (ELF64_R_SYM(one.r_info) >= symbols) return damaged("a relocation takes no symbol of its own");
  if (type == kRelative && !is_in_image(file, address)) {
    return damaged("a relocation leads outside");
  }
  if (type == kResolved && !is_code(file, address)) {
    return damaged("a relocation calls a function outside of its code");
  }
  return ok();
}

/// Checks a table and notes the pointers that it makes.
Status check_table(const ElfFile& file, GElf_Sxword begin, GElf_Sxword length, std::size_t symbols,
                   Pointers& made) {
  const GElf_Xword size = file.dynamic(length).value_or(0);
  if (size == 0) return ok();
  const auto table = file.mapped(file.dynamic(begin).value_or(0), size);
  if (table.size() != size) return damaged("its relocations lie outside");
  for (std::size_t at = 0; at + sizeof(Elf64_Rela) <= table.size(); at += sizeof(Elf64_Rela)) {
    Elf64_Rela one;
    std::memcpy(&one, &table[at], sizeof one);
    if (Status good = check_one(file, one, symbols); !good) return good;
    const auto to = static_cast<GElf_Addr>(one.r_addend);
    if (ELF64_R_TYPE(one.r_info) == kRelative) made[one.r_offset] = to;
  }
  return ok();
}

constexpr const char* kCallsOutside = "its functions for start and end lie outside of its code";

Status check_called(const ElfFile& file, const Pointers& made) {
  for (const GElf_Sxword tag : {DT_INIT, DT_FINI}) {
    const auto address = file.dynamic(tag);
    if (address && !is_code(file, *address)) return damaged(kCallsOutside);
  }
  constexpr std::pair<GElf_Sxword, GElf_Sxword> kLists[] = {{DT_INIT_ARRAY, DT_INIT_ARRAYSZ},
                                                            {DT_FINI_ARRAY, DT_FINI_ARRAYSZ}};
  for (const auto& [list, length] : kLists) {
    const GElf_Addr begin = file.dynamic(list).value_or(0);
    const GElf_Xword size = file.dynamic(length).value_or(0);
    if (size == 0) continue;
    if (!lies_in(file, PF_W, begin, size)) return damaged(kCallsOutside);
    for (GElf_Addr at = begin; at < begin + size; at += sizeof(Elf64_Addr)) {
      const auto pointer = made.find(at);
      if (pointer == made.end() || !is_code(file, pointer->second)) return damaged(kCallsOutside);
    }
  }
  return ok();
}

}  // namespace

Status check_relocations(const ElfFile& file) {
  if (file.dynamic(DT_REL) || file.dynamic(kPackedRelocations)) {
    return refuse({Errc::plugin_refused, "plugin_unchecked_form"}, {},
                  "has relocations of a form that is not checked",
                  "link it without -z pack-relative-relocs");
  }
  const auto section = file.section(".dynsym");
  const std::size_t symbols = section ? section->bytes.size() / sizeof(Elf64_Sym) : 0;
  Pointers made;
  Status good = check_table(file, DT_RELA, DT_RELASZ, symbols, made);
  if (good) good = check_table(file, DT_JMPREL, DT_PLTRELSZ, symbols, made);
  return good ? check_called(file, made) : good;
}

}  // namespace mauve::plugin
