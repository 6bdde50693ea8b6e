// SPDX-License-Identifier: LGPL-3.0-or-later
#include "plugin/elf/checksum.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>
#include <vector>

#include "mauve/plugin.h"

namespace mauve::plugin {

namespace {

/// First byte and the one behind the last.
using Range = std::pair<std::size_t, std::size_t>;

std::uint64_t hash(std::span<const std::byte> bytes, std::uint64_t seed) {
  return detail::hash({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, seed);
}

/// The bytes that may change after the file was stamped, in the order of the file.
std::array<Range, 3> left_out(std::size_t manifest) {
  const std::size_t own = manifest + offsetof(PluginManifest, checksum);
  std::array<Range, 3> ranges = {{{offsetof(Elf64_Ehdr, e_shoff), offsetof(Elf64_Ehdr, e_flags)},
                                  {offsetof(Elf64_Ehdr, e_shnum), sizeof(Elf64_Ehdr)},
                                  {own, own + sizeof(PluginManifest::checksum)}}};
  std::ranges::sort(ranges);
  return ranges;
}

}  // namespace

Result<std::size_t> find_manifest(const ElfFile& file) {
  const auto symbols = file.symbols(SHT_DYNSYM);
  const auto entry = std::ranges::find_if(symbols, [](const ElfSymbol& at) {
    return at.name == kEntry && at.symbol.st_shndx != SHN_UNDEF;
  });
  if (entry == symbols.end()) {
    return refuse({Errc::plugin_refused, "not_a_plugin"}, {},
                  "is not a mauve plugin: it does not export mauve_plugin",
                  "write MAUVE_PLUGIN(plugin) { ... } in one of its sources");
  }
  const auto section = file.section(".mauve.manifest");
  if (!section) {
    return refuse({Errc::plugin_refused, "not_a_plugin"}, {},
                  "is not a mauve plugin: it has no section .mauve.manifest",
                  "build it with mauve_add_plugin()");
  }
  // The entry that dlsym will give out must be the manifest that is checked here.
  const GElf_Sym& symbol = entry->symbol;
  const GElf_Xword offset = symbol.st_value - section->header.sh_addr;
  const std::size_t size = section->bytes.size();
  if (symbol.st_value < section->header.sh_addr || offset > size ||
      size - offset < sizeof(PluginEntry) || symbol.st_size < sizeof(PluginEntry)) {
    return refuse({Errc::plugin_refused, "plugin_damaged"}, {},
                  "is damaged: its manifest is too short", "build or copy it again");
  }
  return section->header.sh_offset + offset;
}

std::uint64_t checksum_of(const ElfFile& file, std::span<const std::byte> bytes,
                          std::size_t manifest) {
  const auto ranges = left_out(manifest);
  std::uint64_t sum = detail::kHashSeed;
  for (const GElf_Phdr& segment : file.segments()) {
    sum = hash(std::as_bytes(std::span(&segment, 1)), sum);
    if (segment.p_type != PT_LOAD) continue;
    std::size_t from = segment.p_offset;
    const std::size_t end = segment.p_offset + segment.p_filesz;
    for (const auto& [skip, go_on] : ranges) {
      if (go_on <= from || skip >= end) continue;
      if (skip > from) sum = hash(bytes.subspan(from, skip - from), sum);
      from = std::min(go_on, end);
    }
    sum = hash(bytes.subspan(from, end - from), sum);
  }
  return sum;
}

Status stamp(std::span<std::byte> bytes) {
  const Result<ElfFile> file = ElfFile::open(bytes);
  if (!file) return file.error();
  const Result<std::size_t> manifest = find_manifest(*file);
  if (!manifest) return manifest.error();
  const std::uint64_t sum = checksum_of(*file, bytes, *manifest);
  std::memcpy(bytes.data() + *manifest + offsetof(PluginManifest, checksum), &sum, sizeof sum);
  return ok();
}

}  // namespace mauve::plugin
