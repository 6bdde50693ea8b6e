// SPDX-License-Identifier: LGPL-3.0-or-later
/// The parts of a shared object that the check looks at, parsed by libelf.
#pragma once

#include <gelf.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mauve/result.h"

namespace mauve::plugin {

/// One entry of the symbol table for the dynamic linker, or of the one for people.
struct ElfSymbol {
  std::string name;
  GElf_Sym symbol;
};

/// "zoo::calls" of "_ZN3zoo5callsE"; a text that is no mangled name stays as it is.
[[nodiscard]] std::string readable_symbol(const std::string& symbol);

/// "is damaged: " and in which way.
[[nodiscard]] Error damaged(const char* way);

/// A view: the bytes must outlive it.
class ElfFile {
 public:
  /// Refused: not ELF, damaged, cut off, or not a shared object for this machine.
  static Result<ElfFile> open(std::span<const std::byte> bytes);

  [[nodiscard]] const std::vector<GElf_Phdr>& segments() const { return segments_; }
  [[nodiscard]] const std::vector<GElf_Dyn>& dynamic() const { return dynamic_; }
  /// The last value with this tag.
  [[nodiscard]] std::optional<GElf_Xword> dynamic(GElf_Sxword tag) const;
  /// Names of the libraries it needs.
  [[nodiscard]] std::vector<std::string> needed() const;
  /// Of the strings that its dynamic section names by their place.
  [[nodiscard]] std::string dynamic_text(std::size_t offset) const {
    return text(dynamic_strings_, offset);
  }
  /// The symbols of a table: SHT_DYNSYM, or SHT_SYMTAB when it was not stripped.
  [[nodiscard]] std::vector<ElfSymbol> symbols(GElf_Word table) const;
  /// The section with this name and its bytes.
  struct Section {
    GElf_Shdr header;
    std::span<const std::byte> bytes;
  };
  [[nodiscard]] std::optional<Section> section(const std::string& name) const;

  /// The bytes of the file that lie at this address once it is mapped; fewer when they end before.
  [[nodiscard]] std::span<const std::byte> mapped(GElf_Addr address, GElf_Xword size) const;

 private:
  struct Close {
    void operator()(Elf* elf) const { elf_end(elf); }
  };

  Status read_segments();
  Status check_sections();
  void read_dynamic();
  [[nodiscard]] std::string text(std::size_t strings, std::size_t offset) const;

  std::span<const std::byte> bytes_;
  std::unique_ptr<Elf, Close> elf_;
  std::vector<GElf_Phdr> segments_;
  std::vector<GElf_Dyn> dynamic_;
  std::size_t dynamic_strings_ = 0;
};

}  // namespace mauve::plugin
