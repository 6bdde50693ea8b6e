// SPDX-License-Identifier: LGPL-3.0-or-later
#include "plugin/elf/elf_file.h"

#include <cxxabi.h>

#include <cstdlib>
#include <cstring>

namespace mauve::plugin {

namespace {

#if defined(__x86_64__)
constexpr GElf_Half kMachine = EM_X86_64;
#elif defined(__aarch64__)
constexpr GElf_Half kMachine = EM_AARCH64;
#elif defined(__riscv)
constexpr GElf_Half kMachine = EM_RISCV;
#else
#error "give the plugin check the ELF machine number of this architecture"
#endif
constexpr unsigned char kByteOrder =
    __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__ ? ELFDATA2LSB : ELFDATA2MSB;

bool inside(std::size_t size, GElf_Off offset, GElf_Xword length) {
  return offset <= size && length <= size - offset;
}

Status check_header(std::span<const std::byte> bytes) {
  Elf64_Ehdr header;
  if (bytes.size() < sizeof header || std::memcmp(bytes.data(), ELFMAG, SELFMAG) != 0) {
    return refuse({Errc::plugin_refused, "plugin_not_elf"}, {}, "is not a shared object",
                  "build it with mauve_add_plugin()");
  }
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.e_ident[EI_CLASS] != ELFCLASS64 || header.e_ident[EI_DATA] != kByteOrder ||
      header.e_machine != kMachine) {
    return refuse({Errc::plugin_refused, "plugin_other_machine"}, {},
                  "is built for another machine", "build it with this machine's compiler");
  }
  if (header.e_type != ET_DYN || header.e_version != EV_CURRENT) {
    return refuse({Errc::plugin_refused, "plugin_not_elf"}, {}, "is not a shared object",
                  "build it with mauve_add_plugin()");
  }
  if (header.e_ehsize != sizeof(Elf64_Ehdr) || header.e_phentsize != sizeof(Elf64_Phdr) ||
      header.e_shentsize != sizeof(Elf64_Shdr)) {
    return refuse({Errc::plugin_refused, "plugin_damaged"}, {},
                  "is damaged: its ELF header has wrong sizes", "build or copy it again");
  }
  if (!inside(bytes.size(), header.e_phoff, GElf_Xword{header.e_phnum} * sizeof(Elf64_Phdr)) ||
      !inside(bytes.size(), header.e_shoff, GElf_Xword{header.e_shnum} * sizeof(Elf64_Shdr))) {
    return refuse({Errc::plugin_refused, "plugin_damaged"}, {},
                  "is cut off: its tables lie behind its end", "build or copy it again");
  }
  return ok();
}

}  // namespace

Error damaged(const char* way) {
  return refuse({Errc::plugin_refused, "plugin_damaged"}, {}, std::string("is damaged: ") + way,
                "build or copy it again");
}

std::string readable_symbol(const std::string& symbol) {
  if (!symbol.starts_with("_Z")) return symbol;
  int status = 0;
  const std::unique_ptr<char, decltype(&std::free)> text(
      abi::__cxa_demangle(symbol.c_str(), nullptr, nullptr, &status), &std::free);
  return text ? text.get() : symbol;
}

Result<ElfFile> ElfFile::open(std::span<const std::byte> bytes) {
  if (Status good = check_header(bytes); !good) return good.error();
  elf_version(EV_CURRENT);
  ElfFile file;
  file.bytes_ = bytes;
  // libelf only reads a file of the machine's own byte order, although it asks for char*.
  auto* memory = const_cast<char*>(reinterpret_cast<const char*>(bytes.data()));
  file.elf_.reset(elf_memory(memory, bytes.size()));
  if (!file.elf_ || elf_kind(file.elf_.get()) != ELF_K_ELF) {
    return refuse({Errc::plugin_refused, "plugin_damaged"}, {}, "is damaged: libelf cannot read it",
                  "build or copy it again");
  }
  if (Status good = file.read_segments(); !good) return good.error();
  if (Status good = file.check_sections(); !good) return good.error();
  file.read_dynamic();
  return file;
}

Status ElfFile::read_segments() {
  std::size_t count = 0;
  if (elf_getphdrnum(elf_.get(), &count) != 0 || count == 0) {
    return refuse({Errc::plugin_refused, "plugin_damaged"}, {}, "is damaged: it has no segments",
                  "build or copy it again");
  }
  for (std::size_t i = 0; i < count; ++i) {
    GElf_Phdr segment;
    if (gelf_getphdr(elf_.get(), static_cast<int>(i), &segment) == nullptr ||
        !inside(bytes_.size(), segment.p_offset, segment.p_filesz)) {
      return refuse({Errc::plugin_refused, "plugin_damaged"}, {},
                    "is cut off: a segment lies behind its end", "build or copy it again");
    }
    segments_.push_back(segment);
  }
  return ok();
}

Status ElfFile::check_sections() {
  for (Elf_Scn* at = nullptr; (at = elf_nextscn(elf_.get(), at)) != nullptr;) {
    GElf_Shdr header;
    if (gelf_getshdr(at, &header) == nullptr ||
        (header.sh_type != SHT_NOBITS &&
         !inside(bytes_.size(), header.sh_offset, header.sh_size))) {
      return refuse({Errc::plugin_refused, "plugin_damaged"}, {},
                    "is cut off: a section lies behind its end", "build or copy it again");
    }
  }
  return ok();
}

void ElfFile::read_dynamic() {
  for (Elf_Scn* at = nullptr; (at = elf_nextscn(elf_.get(), at)) != nullptr;) {
    GElf_Shdr header;
    if (gelf_getshdr(at, &header) == nullptr || header.sh_type != SHT_DYNAMIC) continue;
    Elf_Data* data = elf_getdata(at, nullptr);
    if (data == nullptr) continue;
    dynamic_strings_ = header.sh_link;
    GElf_Dyn entry;
    for (int i = 0; gelf_getdyn(data, i, &entry) != nullptr && entry.d_tag != DT_NULL; ++i) {
      dynamic_.push_back(entry);
    }
  }
}

std::optional<GElf_Xword> ElfFile::dynamic(GElf_Sxword tag) const {
  std::optional<GElf_Xword> value;
  for (const GElf_Dyn& entry : dynamic_) {
    if (entry.d_tag == tag) value = entry.d_un.d_val;
  }
  return value;
}

std::string ElfFile::text(std::size_t strings, std::size_t offset) const {
  const char* found = elf_strptr(elf_.get(), strings, offset);
  return found != nullptr ? found : "";
}

std::vector<std::string> ElfFile::needed() const {
  std::vector<std::string> names;
  for (const GElf_Dyn& entry : dynamic_) {
    if (entry.d_tag == DT_NEEDED) names.push_back(text(dynamic_strings_, entry.d_un.d_val));
  }
  return names;
}

std::vector<ElfSymbol> ElfFile::symbols(GElf_Word table) const {
  std::vector<ElfSymbol> found;
  for (Elf_Scn* at = nullptr; (at = elf_nextscn(elf_.get(), at)) != nullptr;) {
    GElf_Shdr header;
    if (gelf_getshdr(at, &header) == nullptr || header.sh_type != table) continue;
    Elf_Data* data = elf_getdata(at, nullptr);
    if (data == nullptr) continue;
    GElf_Sym symbol;
    for (int i = 1; gelf_getsym(data, i, &symbol) != nullptr; ++i) {
      found.push_back({text(header.sh_link, symbol.st_name), symbol});
    }
  }
  return found;
}

std::optional<ElfFile::Section> ElfFile::section(const std::string& name) const {
  std::size_t names = 0;
  if (elf_getshdrstrndx(elf_.get(), &names) != 0) return std::nullopt;
  for (Elf_Scn* at = nullptr; (at = elf_nextscn(elf_.get(), at)) != nullptr;) {
    GElf_Shdr header;
    if (gelf_getshdr(at, &header) == nullptr || text(names, header.sh_name) != name) continue;
    if (header.sh_type == SHT_NOBITS) return std::nullopt;
    return Section{header, bytes_.subspan(header.sh_offset, header.sh_size)};
  }
  return std::nullopt;
}

std::span<const std::byte> ElfFile::mapped(GElf_Addr address, GElf_Xword size) const {
  for (const GElf_Phdr& at : segments_) {
    const bool here = at.p_type == PT_LOAD && address >= at.p_vaddr &&
                      address - at.p_vaddr < at.p_filesz && at.p_offset <= bytes_.size();
    if (!here) continue;
    const auto segment = bytes_.subspan(at.p_offset);
    const GElf_Xword skipped = address - at.p_vaddr;
    if (skipped >= segment.size()) return {};
    const GElf_Xword left = std::min<GElf_Xword>(at.p_filesz, segment.size()) - skipped;
    return segment.subspan(skipped, std::min(size, left));
  }
  return {};
}

}  // namespace mauve::plugin
