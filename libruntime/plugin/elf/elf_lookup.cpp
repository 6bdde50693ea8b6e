// SPDX-License-Identifier: LGPL-3.0-or-later
#include "plugin/elf/elf_lookup.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>

namespace mauve::plugin {

namespace {

constexpr GElf_Xword kAll = std::numeric_limits<GElf_Xword>::max();

/// A table of numbers of one size; bytes behind its end are not read.
template <typename Number>
class Table {
 public:
  explicit Table(std::span<const std::byte> bytes) : bytes_(bytes) {}

  [[nodiscard]] std::size_t size() const { return bytes_.size() / sizeof(Number); }
  [[nodiscard]] Number operator[](std::size_t at) const {
    Number number;
    std::memcpy(&number, bytes_.data() + at * sizeof number, sizeof number);
    return number;
  }

 private:
  std::span<const std::byte> bytes_;
};

/// As the dynamic linker finds them: from the first to the one that the sections end with.
Result<Table<Elf64_Sym>> symbols_of(const ElfFile& file) {
  const auto section = file.section(".dynsym");
  const GElf_Addr address = file.dynamic(DT_SYMTAB).value_or(0);
  if (!section || section->header.sh_addr != address) {
    return damaged("its symbols are not where the dynamic linker looks for them");
  }
  const Table<Elf64_Sym> symbols(file.mapped(address, section->bytes.size()));
  if (symbols.size() * sizeof(Elf64_Sym) != section->bytes.size()) {
    return damaged("its symbols lie outside");
  }
  return symbols;
}

Status check_names(const ElfFile& file, const Table<Elf64_Sym>& symbols) {
  const GElf_Xword size = file.dynamic(DT_STRSZ).value_or(0);
  const auto names = file.mapped(file.dynamic(DT_STRTAB).value_or(0), size);
  if (size == 0 || names.size() != size || names.back() != std::byte{0}) {
    return damaged("the names of its symbols lie outside");
  }
  for (std::size_t i = 0; i < symbols.size(); ++i) {
    if (symbols[i].st_name >= size) return damaged("the name of a symbol lies outside");
  }
  return ok();
}

/// A chain of hashes ends with an odd one.
bool ends(const Table<std::uint32_t>& chains, std::size_t from, std::size_t count) {
  for (std::size_t at = from; at < std::min(chains.size(), count); ++at) {
    if ((chains[at] & 1) != 0) return true;
  }
  return false;
}

/// Four numbers, a filter of 64-bit words, buckets with the first symbol of each, and a hash for
/// each symbol ("GNU Hash ELF Sections", Ali Bahrami, Oracle 2010).
Status check_hashes(const ElfFile& file, std::size_t symbols) {
  constexpr std::size_t kHead = 4;
  const auto bytes = file.mapped(file.dynamic(DT_GNU_HASH).value_or(0), kAll);
  const Table<std::uint32_t> head(bytes);
  if (!file.dynamic(DT_GNU_HASH)) {
    return refuse({Errc::plugin_refused, "plugin_unchecked_form"}, {},
                  "has no table of symbols of the GNU style",
                  "link it with -Wl,--hash-style=gnu, or build it with mauve_add_plugin()");
  }
  constexpr const char* kBad = "its table of symbols leads behind its end";
  if (head.size() < kHead) return damaged(kBad);
  const std::size_t buckets = head[0];
  const std::size_t first = head[1];
  const std::size_t filter = std::size_t{head[2]} * 2;
  const bool sound = buckets > 0 && std::has_single_bit(filter) && filter > 1 && head[3] < 64 &&
                     first <= symbols && filter + buckets <= head.size() - kHead;
  if (!sound) return damaged(kBad);
  const std::size_t chains = kHead + filter + buckets;
  const Table<std::uint32_t> hashes(bytes.subspan(chains * sizeof(std::uint32_t)));
  for (std::size_t at = chains - buckets; at < chains; ++at) {
    const std::size_t symbol = head[at];
    if (symbol == 0) continue;
    if (symbol < first || !ends(hashes, symbol - first, symbols - first)) return damaged(kBad);
  }
  return ok();
}

template <typename Entry>
bool read_at(const ElfFile& file, GElf_Addr address, Entry& entry) {
  const auto bytes = file.mapped(address, sizeof entry);
  if (bytes.size() == sizeof entry) std::memcpy(&entry, bytes.data(), sizeof entry);
  return bytes.size() == sizeof entry;
}

constexpr const char* kBadVersions = "the versions of its symbols lead outside";
constexpr const char* kOfNoLibrary = "a version of its symbols is of no library that it needs";

/// The highest number of a version that the plugin needs. The file has a list of libraries, each
/// with a list of versions. See the System V gABI as extended by Solaris, and "Symbol Versioning"
/// in the Linux Standard Base.
Result<std::uint32_t> highest_version(const ElfFile& file) {
  std::uint32_t highest = 1;  // 0 and 1 are local and global
  const auto needed = file.needed();
  GElf_Addr library = file.dynamic(DT_VERNEED).value_or(0);
  for (GElf_Xword left = file.dynamic(DT_VERNEEDNUM).value_or(0); left > 0; --left) {
    Elf64_Verneed of{};
    if (!read_at(file, library, of)) return damaged(kBadVersions);
    const auto name = file.dynamic_text(of.vn_file);  // the dynamic linker asserts that it is there
    if (std::find(needed.begin(), needed.end(), name) == needed.end()) return damaged(kOfNoLibrary);
    GElf_Addr at = library + of.vn_aux;
    for (unsigned versions = of.vn_cnt; versions > 0; --versions) {
      Elf64_Vernaux one{};
      if (!read_at(file, at, one)) return damaged(kBadVersions);
      highest = std::max<std::uint32_t>(highest, one.vna_other & 0x7fffU);
      if ((one.vna_next == 0) != (versions == 1)) return damaged(kBadVersions);
      at += one.vna_next;
    }
    if ((of.vn_next == 0) != (left == 1)) return damaged(kBadVersions);
    library += of.vn_next;
  }
  return highest;
}

Status check_versions(const ElfFile& file, std::size_t symbols) {
  if (!file.dynamic(DT_VERSYM)) return ok();
  if (file.dynamic(DT_VERDEF)) {
    return refuse({Errc::plugin_refused, "plugin_unchecked_form"}, {},
                  "gives its symbols versions of its own",
                  "link it without names of versions, or build it with mauve_add_plugin()");
  }
  const auto highest = highest_version(file);
  if (!highest) return highest.error();
  const Table<std::uint16_t> versions(
      file.mapped(*file.dynamic(DT_VERSYM), symbols * sizeof(std::uint16_t)));
  if (versions.size() != symbols) return damaged(kBadVersions);
  for (std::size_t at = 0; at < symbols; ++at) {
    if ((versions[at] & 0x7fffU) > *highest) return damaged(kBadVersions);
  }
  return ok();
}

}  // namespace

Status check_lookup(const ElfFile& file) {
  const auto symbols = symbols_of(file);
  if (!symbols) return symbols.error();
  if (Status good = check_names(file, *symbols); !good) return good;
  if (Status good = check_versions(file, symbols->size()); !good) return good;
  return check_hashes(file, symbols->size());
}

}  // namespace mauve::plugin
