// SPDX-License-Identifier: LGPL-3.0-or-later
/// The check of the bytes holds against any bytes.
#include "plugin/elf/elf.h"

#include <elf.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "plugin/elf/checksum.h"
#include "plugin/elf/elf_file.h"
#include "support/temp_dir.h"
#include "unit/plugin/zoo.h"

namespace mauve::plugin::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::byte> bytes_of(std::string_view zoo) {
  const std::string text = mauve::test::TempDir::read(zoo_file(zoo));
  const auto* begin = reinterpret_cast<const std::byte*>(text.data());
  return {begin, begin + text.size()};
}

const std::vector<std::byte>& good() {
  static const std::vector<std::byte> bytes = bytes_of("1/good.so");
  return bytes;
}

Elf64_Ehdr header_of(const std::vector<std::byte>& bytes) {
  Elf64_Ehdr header;
  std::memcpy(&header, bytes.data(), sizeof header);
  return header;
}

TEST(ElfCheck, ReadsTheManifestOfAGoodPlugin) {
  const Result<Facts> facts = inspect(good(), "good");

  ASSERT_TRUE(facts) << to_string(facts.error());
  EXPECT_STREQ(facts->manifest.name, "good");
  EXPECT_STREQ(facts->manifest.version, kVersion);
}

TEST(ElfCheck, FindsOneExportedSymbolInAPluginOfTheHouse) {
  const Result<ElfFile> file = ElfFile::open(good());
  ASSERT_TRUE(file);

  std::vector<std::string> exported;
  for (const ElfSymbol& at : file->symbols(SHT_DYNSYM)) {
    const bool local = GELF_ST_BIND(at.symbol.st_info) == STB_LOCAL;  // on arm64 of two sections
    if (at.symbol.st_shndx != SHN_UNDEF && !local) exported.push_back(at.name);
  }

  EXPECT_THAT(exported, ElementsAre("mauve_plugin"));
}

TEST(ElfCheck, LooksAtEverySymbolThatTheLinkerSees) {
  const Result<ElfFile> file = ElfFile::open(good());
  ASSERT_TRUE(file);
  const auto table = file->section(".dynsym");
  ASSERT_TRUE(table);

  const std::size_t entries = table->header.sh_size / table->header.sh_entsize;
  EXPECT_EQ(file->symbols(SHT_DYNSYM).size(), entries - 1) << "the first one has no meaning";
}

TEST(ElfCheck, RefusesWhatIsNotElf) {
  for (const std::string text : {"", "\x7f", "#!/bin/sh\nexit 0\n"}) {
    const Result<Facts> facts = inspect(std::as_bytes(std::span(text)), "good");
    ASSERT_FALSE(facts);
    EXPECT_THAT(facts.error().message, HasSubstr("is not a shared object"));
  }
}

TEST(ElfCheck, RefusesAnotherMachine) {
  std::vector<std::byte> bytes = good();
  Elf64_Ehdr header = header_of(bytes);
  header.e_machine = EM_S390;
  std::memcpy(bytes.data(), &header, sizeof header);

  EXPECT_THAT(inspect(bytes, "good").error().message, HasSubstr("another machine"));
}

TEST(ElfCheck, RefusesAProgram) {
  std::vector<std::byte> bytes = good();
  Elf64_Ehdr header = header_of(bytes);
  header.e_type = ET_EXEC;
  std::memcpy(bytes.data(), &header, sizeof header);

  EXPECT_THAT(inspect(bytes, "good").error().message, HasSubstr("is not a shared object"));
}

TEST(ElfCheck, RefusesTablesThatLeadBehindTheEnd) {
  const Elf64_Ehdr header = header_of(good());
  const auto refused = [](const Elf64_Ehdr& other) {
    std::vector<std::byte> bytes = good();
    std::memcpy(bytes.data(), &other, sizeof other);
    const Result<Facts> facts = inspect(bytes, "good");
    return !facts && facts.error().message.find("tables lie behind its end") != std::string::npos;
  };
  Elf64_Ehdr segments = header;
  segments.e_phoff = good().size() - sizeof(Elf64_Phdr);
  segments.e_phnum = 2;
  Elf64_Ehdr sections = header;
  sections.e_shoff = good().size() - sizeof(Elf64_Shdr);
  sections.e_shnum = 2;

  EXPECT_FALSE(refused(header));
  EXPECT_TRUE(refused(segments));
  EXPECT_TRUE(refused(sections));
}

TEST(ElfCheck, RefusesAFileCutOffAnywhere) {
  const std::size_t step = good().size() / 199 + 1;
  for (std::size_t size = 0; size < good().size(); size += step) {
    const std::vector<std::byte> cut(good().begin(),
                                     good().begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(inspect(cut, "good")) << "with " << size << " of " << good().size() << " bytes";
  }
}

/// Puts random bytes where the tables of an ELF file are, for a while. No changed file is loaded.
class Mutation {
 public:
  explicit Mutation(std::vector<std::byte> bytes) : bytes_(std::move(bytes)) {}

  /// A changed file; the change of before is undone.
  const std::vector<std::byte>& next() {
    for (; !undo_.empty(); undo_.pop_back()) bytes_[undo_.back().first] = undo_.back().second;
    const Elf64_Ehdr header = header_of(bytes_);
    const std::size_t tables[][2] = {
        {0, sizeof header},
        {header.e_phoff, std::size_t{header.e_phnum} * sizeof(Elf64_Phdr)},
        {header.e_shoff, std::size_t{header.e_shnum} * sizeof(Elf64_Shdr)},
        {0, 4096},
        {0, bytes_.size()}};
    for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
      const auto& [begin, size] = tables[below(std::size(tables))];
      change(begin + below(size), static_cast<std::byte>(below(256)));
    }
    return bytes_;
  }

 private:
  std::size_t below(std::size_t limit) { return random_() % limit; }
  void change(std::size_t at, std::byte to) {
    undo_.emplace_back(at, bytes_[at]);
    bytes_[at] = to;
  }

  std::mt19937_64 random_{20240229};
  std::vector<std::byte> bytes_;
  std::vector<std::pair<std::size_t, std::byte>> undo_;
};

/// Every second file is stamped, so that the checks behind the checksum see it too.
TEST(ElfCheck, NeverCrashesOnChangedBytes) {
  Mutation mutation(good());
  int refused = 0;
  constexpr int kRounds = 600;
  for (int i = 0; i < kRounds; ++i) {
    std::vector<std::byte> bytes = mutation.next();
    if (i % 2 == 0) static_cast<void>(stamp(bytes));
    if (!inspect(bytes, "good")) ++refused;
  }
  EXPECT_GT(refused, kRounds / 10);
}

/// The bytes that are mapped, but for the names of the section headers and the checksum.
std::vector<std::size_t> mapped_bytes() {
  const Result<ElfFile> file = ElfFile::open(good());
  std::vector<std::size_t> mapped;
  for (const GElf_Phdr& segment : file->segments()) {
    if (segment.p_type != PT_LOAD) continue;
    for (std::size_t at = 0; at < segment.p_filesz; ++at) mapped.push_back(segment.p_offset + at);
  }
  const std::size_t own = *find_manifest(*file) + offsetof(PluginManifest, checksum);
  std::erase_if(mapped, [own](std::size_t at) {
    return (at >= offsetof(Elf64_Ehdr, e_shoff) && at < offsetof(Elf64_Ehdr, e_flags)) ||
           (at >= offsetof(Elf64_Ehdr, e_shnum) && at < sizeof(Elf64_Ehdr)) ||
           (at >= own && at < own + sizeof(PluginManifest::checksum));
  });
  return mapped;
}

TEST(ElfCheck, RefusesAnyChangedBitOfWhatIsMapped) {
  std::vector<std::byte> bytes = good();
  const std::vector<std::size_t> mapped = mapped_bytes();
  std::mt19937_64 random(7);
  for (int i = 0; i < 2000; ++i) {
    const std::size_t at = mapped[random() % mapped.size()];
    const auto bit = std::byte{1} << (random() % 8);
    bytes[at] ^= bit;
    EXPECT_FALSE(inspect(bytes, "good")) << "bit " << static_cast<int>(bit) << " of byte " << at;
    bytes[at] ^= bit;
  }
  EXPECT_TRUE(inspect(bytes, "good")) << "as it was";
}

/// Why these bytes are refused, although their checksum fits; "no" when they are not.
std::string refusal_of(std::vector<std::byte> bytes) {
  EXPECT_TRUE(stamp(bytes));
  const Result<Facts> facts = inspect(bytes, "good");
  return facts ? "no" : facts.error().message;
}

/// The same of a good plugin with this number at a place of a section.
template <typename Number>
std::string refusal_with(const char* section, std::size_t at, Number number) {
  std::vector<std::byte> bytes = good();
  const auto table = ElfFile::open(bytes)->section(section);
  std::memcpy(bytes.data() + (table->bytes.data() - bytes.data()) + at, &number, sizeof number);
  return refusal_of(std::move(bytes));
}

/// As after mauve-stamp on a damaged file: the checksum fits, and the linker would write anywhere.
TEST(ElfCheck, RefusesARelocationOutsideOfTheDataOfThePlugin) {
  std::vector<std::byte> bytes = good();
  const auto table = ElfFile::open(bytes)->section(".rela.dyn");
  ASSERT_TRUE(table && table->bytes.size() >= sizeof(Elf64_Rela));
  auto* const first = bytes.data() + (table->bytes.data() - bytes.data());
  Elf64_Rela one;
  for (const Elf64_Addr wrong : {Elf64_Addr{0}, Elf64_Addr{1} << 40U, ~Elf64_Addr{0}}) {
    std::memcpy(&one, first, sizeof one);
    one.r_offset = wrong;
    std::memcpy(first, &one, sizeof one);
    ASSERT_TRUE(stamp(bytes));

    const auto facts = inspect(bytes, "good");

    ASSERT_FALSE(facts) << wrong;
    EXPECT_THAT(facts.error().message, HasSubstr("a relocation writes outside of its data"));
  }
}

/// The first segment of this type, which may be changed.
Elf64_Phdr* segment_of(std::vector<std::byte>& bytes, Elf64_Word type) {
  const Elf64_Ehdr header = header_of(bytes);
  auto* segments = reinterpret_cast<Elf64_Phdr*>(bytes.data() + header.e_phoff);
  return std::find_if(segments, segments + header.e_phnum,
                      [&](const Elf64_Phdr& at) { return at.p_type == type; });
}

/// Else the dynamic linker would map, or protect, memory of others.
TEST(ElfCheck, RefusesSegmentsThatLieOnMemoryOfOthers) {
  const auto refused = [](Elf64_Word type, auto change) {
    std::vector<std::byte> bytes = good();
    change(*segment_of(bytes, type));
    return refusal_of(std::move(bytes));
  };
  const char* const overlap = "its segments overlap or cannot be placed";
  const char* const outside = "a segment lies outside of those that are loaded";

  EXPECT_THAT(refused(PT_LOAD, [](auto& at) { at.p_memsz += 1U << 20U; }), HasSubstr(overlap));
  EXPECT_THAT(refused(PT_LOAD, [](auto& at) { at.p_memsz = 1; }), HasSubstr(overlap));
  EXPECT_THAT(refused(PT_LOAD, [](auto& at) { at.p_align = 3; }), HasSubstr(overlap));
  EXPECT_THAT(refused(PT_GNU_RELRO, [](auto& at) { at.p_memsz += 1U << 24U; }), HasSubstr(outside));
  EXPECT_THAT(refused(PT_GNU_RELRO, [](auto& at) { at.p_vaddr += 1U << 24U; }), HasSubstr(outside));
}

/// The memory around a plugin differs from process to process: a trial may succeed by luck.
TEST(ElfCheck, RefusesFunctionsAndPointersThatLieOutside) {
  const auto refused = [](GElf_Addr from, Elf64_Sxword to) {
    std::vector<std::byte> bytes = good();
    const auto table = ElfFile::open(bytes)->section(".rela.dyn");
    auto* const begin = bytes.data() + (table->bytes.data() - bytes.data());
    for (std::size_t at = 0; at < table->bytes.size(); at += sizeof(Elf64_Rela)) {
      Elf64_Rela one;
      std::memcpy(&one, begin + at, sizeof one);
      if (from != 0 && one.r_offset != from) continue;
      one.r_addend = to;
      std::memcpy(begin + at, &one, sizeof one);
      break;
    }
    return refusal_of(std::move(bytes));
  };
  const auto list = ElfFile::open(good())->section(".init_array")->header.sh_addr;
  const auto data = ElfFile::open(good())->section(".data")->header.sh_addr;
  const char* const calls = "its functions for start and end lie outside of its code";

  EXPECT_THAT(refused(list, static_cast<Elf64_Sxword>(data)), HasSubstr(calls));
  EXPECT_THAT(refused(list, Elf64_Sxword{1} << 40), HasSubstr("a relocation leads outside"));
  EXPECT_THAT(refused(0, -1), HasSubstr("a relocation leads outside"));
}

/// The dynamic linker asserts that it is, and ends the process.
TEST(ElfCheck, RefusesVersionsOfALibraryThatIsNotNeeded) {
  EXPECT_THAT(refusal_with<std::uint32_t>(".gnu.version_r", offsetof(Elf64_Verneed, vn_file), 1),
              HasSubstr("a version of its symbols is of no library that it needs"));
}

TEST(ElfCheck, RefusesVersionsOfSymbolsThatLeadOutside) {
  const auto refused = refusal_with<std::uint16_t>;
  const char* const outside = "the versions of its symbols lead outside";

  EXPECT_THAT(refused(".gnu.version", 2, 0x7ff0), HasSubstr(outside));
  EXPECT_THAT(refused(".gnu.version_r", offsetof(Elf64_Verneed, vn_aux) + 2, 0x7fff),
              HasSubstr(outside));
  EXPECT_THAT(refused(".gnu.version_r", offsetof(Elf64_Verneed, vn_next), 0), HasSubstr(outside))
      << "the list ends before its count does";
}

/// The dynamic linker follows these tables without a look at their ends.
TEST(ElfCheck, RefusesTablesOfSymbolsThatLeadOutside) {
  const auto refused = refusal_with<std::uint32_t>;
  const auto hashes = ElfFile::open(good())->section(".gnu.hash")->bytes;
  std::uint32_t last = 0;
  std::memcpy(&last, &hashes[hashes.size() - sizeof last], sizeof last);
  const char* const leads = "its table of symbols leads behind its end";

  EXPECT_EQ(refused(".gnu.hash", hashes.size() - sizeof last, last), "no");
  EXPECT_THAT(refused(".gnu.hash", hashes.size() - sizeof last, last & ~1U), HasSubstr(leads))
      << "a chain without an end";
  EXPECT_THAT(refused(".gnu.hash", 0, 0), HasSubstr(leads)) << "no bucket";
  EXPECT_THAT(refused(".gnu.hash", 0, 1U << 30U), HasSubstr(leads)) << "more buckets than bytes";
  EXPECT_THAT(refused(".gnu.hash", 4, 0xffffffU), HasSubstr(leads)) << "a first symbol too far";
  EXPECT_THAT(refused(".gnu.hash", 8, 3), HasSubstr(leads)) << "no power of two";
  EXPECT_THAT(refused(".dynsym", sizeof(Elf64_Sym), 1U << 30U),
              HasSubstr("the name of a symbol lies outside"));
}

/// strip(1) takes sections away and moves their headers; what is mapped stays.
TEST(ElfCheck, AcceptsAPluginThatWasStripped) {
  const mauve::test::TempDir folder;
  const auto stripped = folder / "good.so";
  std::filesystem::copy_file(zoo_file("1/good.so"), stripped);
  const std::string command = MAUVE_STRIP " --strip-unneeded " + stripped.string();
  ASSERT_EQ(std::system(command.c_str()), 0);
  const std::string text = mauve::test::TempDir::read(stripped);
  ASSERT_LT(text.size(), good().size());

  const Result<Facts> facts = inspect(std::as_bytes(std::span(text)), "good");

  EXPECT_TRUE(facts) << to_string(facts.error());
}

/// The header of this section, which no segment maps.
Elf64_Shdr* section_header(std::vector<std::byte>& bytes, const char* name) {
  const Elf64_Ehdr header = header_of(bytes);
  auto* sections = reinterpret_cast<Elf64_Shdr*>(bytes.data() + header.e_shoff);
  const auto* names =
      reinterpret_cast<const char*>(bytes.data()) + sections[header.e_shstrndx].sh_offset;
  return std::find_if(sections, sections + header.e_shnum, [&](const Elf64_Shdr& section) {
    return std::strcmp(names + section.sh_name, name) == 0;
  });
}

TEST(ElfCheck, AcceptsAPluginWhoseBuildIdIsCutOffOrMissing) {
  std::vector<std::byte> bytes = good();
  Elf64_Shdr* const note = section_header(bytes, ".note.gnu.build-id");
  EXPECT_EQ(inspect(bytes, "good")->build_id.size(), 40u) << "of sha1";
  for (const std::size_t size : {std::size_t{0}, sizeof(Elf64_Nhdr) - 1, sizeof(Elf64_Nhdr) + 3}) {
    note->sh_size = size;

    const Result<Facts> facts = inspect(bytes, "good");

    ASSERT_TRUE(facts) << to_string(facts.error());
    EXPECT_EQ(facts->build_id, "") << size << " bytes";
  }
  note->sh_name = 0;

  const Result<Facts> facts = inspect(bytes, "good");

  ASSERT_TRUE(facts) << to_string(facts.error());
  EXPECT_EQ(facts->build_id, "");
}

TEST(ElfCheck, SpeaksInPrintableWordsAboutBadNames) {
  PluginManifest manifest = detail::make_manifest("good", "1");
  manifest.name[1] = '\n';
  manifest.name[2] = '\xff';
  manifest.name[3] = '~';

  const Status checked = check_manifest(manifest, "good");

  ASSERT_FALSE(checked);
  EXPECT_THAT(checked.error().message, HasSubstr("\"g??~\""));
}

}  // namespace
}  // namespace mauve::plugin::test
