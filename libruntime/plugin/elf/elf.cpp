// SPDX-License-Identifier: LGPL-3.0-or-later
#include "plugin/elf/elf.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <utility>

#include "mauve/plugin.h"
#include "plugin/elf/checksum.h"
#include "plugin/elf/elf_file.h"
#include "plugin/elf/elf_lookup.h"
#include "plugin/elf/elf_relocations.h"
#include "plugin/elf/elf_segments.h"

namespace mauve::plugin {

namespace {

constexpr const char* kHouseBuild = "build it with mauve_add_plugin()";

// The compiler's own frame_dummy; sanitizers add one for each source file.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || \
    defined(MAUVE_SANITIZE_ADDRESS_UNDEFINED) || defined(MAUVE_SANITIZE_THREAD)
constexpr std::size_t kInitialisers = ~std::size_t{0};
#else
constexpr std::size_t kInitialisers = 1;
#endif

/// The bytes may be anything, but messages are text.
std::string printable(std::string_view bytes) {
  std::string text(bytes);
  for (char& c : text) {
    if (c < ' ' || c > '~') c = '?';
  }
  return text;
}

template <std::size_t N>
std::string text_of(const char (&field)[N]) {
  return printable({field, strnlen(field, N)});
}

bool is_exported(const GElf_Sym& symbol) {
  const auto visibility = GELF_ST_VISIBILITY(symbol.st_other);
  return symbol.st_shndx != SHN_UNDEF && GELF_ST_BIND(symbol.st_info) != STB_LOCAL &&
         (visibility == STV_DEFAULT || visibility == STV_PROTECTED);
}

Status check_damage(const ElfFile& file, std::span<const std::byte> bytes, std::size_t manifest,
                    std::uint64_t checksum) {
  if (checksum == 0) {
    return refuse({Errc::plugin_refused, "plugin_without_checksum"}, {},
                  "has no checksum, so damage of the file would not be noticed",
                  "mauve_add_plugin() writes one after linking; by hand: mauve-stamp FILE");
  }
  if (checksum_of(file, bytes, manifest) != checksum) {
    return refuse({Errc::plugin_refused, "plugin_damaged"}, {},
                  "is damaged: its checksum does not fit",
                  "build or copy it again; after a tool that changed it: mauve-stamp FILE");
  }
  return ok();
}

Status check_exports(const std::vector<ElfSymbol>& symbols) {
  for (const ElfSymbol& at : symbols) {
    if (!is_exported(at.symbol) || at.name == kEntry) continue;
    const bool unique = GELF_ST_BIND(at.symbol.st_info) == STB_GNU_UNIQUE;
    return refuse({Errc::plugin_refused, "plugin_exports"}, {},
                  "exports " + printable(at.name) +
                      (unique ? ", a unique symbol that could never be unloaded"
                              : ", but mauve_plugin must be its only exported symbol"),
                  kHouseBuild);
  }
  return ok();
}

Error thread_local_variables(const ElfFile& file) {
  std::string names;
  for (const ElfSymbol& at : file.symbols(SHT_SYMTAB)) {
    const bool variable = GELF_ST_TYPE(at.symbol.st_info) == STT_TLS && at.symbol.st_size > 0;
    if (!variable) continue;  // assembler and linker set marks of no size
    names += (names.empty() ? ": " : ", ") + printable(readable_symbol(at.name));
  }
  const bool of_test_kit = names.find("mauve::detail::") != std::string::npos;
  return refuse(
      {Errc::plugin_refused, "plugin_thread_local"}, {},
      "has thread-local variables, whose first use allocates on a real-time thread" + names,
      of_test_kit
          ? "the plugin includes <mauve/test_kit.h>, which is for tests: take the include out"
          : "make them members of the core; a header or library that brings one cannot be used");
}

Status check_segments(const ElfFile& file) {
  bool stack_declared = false;
  for (const GElf_Phdr& segment : file.segments()) {
    const bool executable = (segment.p_flags & PF_X) != 0;
    if (segment.p_type == PT_TLS) return thread_local_variables(file);
    if (segment.p_type == PT_GNU_STACK && !executable) stack_declared = true;
    if (segment.p_type == PT_LOAD && executable && (segment.p_flags & PF_W) != 0) {
      return refuse({Errc::plugin_refused, "plugin_unsafe_memory"}, {},
                    "has a segment that is writable and executable", kHouseBuild);
    }
  }
  if (!stack_declared)
    return refuse({Errc::plugin_refused, "plugin_unsafe_memory"}, {},
                  "asks for an executable stack", kHouseBuild);
  return ok();
}

Status check_needed(const ElfFile& file) {
  const std::string runtime = "libmauve.so." + std::to_string(kVersionMajor);
  for (const std::string& name : file.needed()) {
    if (name.starts_with("libmauve.so") && name != runtime) {
      return refuse({Errc::abi_mismatch, "plugin_other_version"}, {},
                    "needs " + printable(name) + ", but this runtime is " + runtime,
                    std::string("rebuild it with mauve ") + kVersion);
    }
    const bool system = name.starts_with("lib") || name.starts_with("ld-");
    if (!system || name.find('/') != std::string::npos) {
      return refuse({Errc::plugin_refused, "plugin_needs_library"}, {},
                    "needs " + printable(name) + ", which is not a system library",
                    "plugins share headers, not code: link the sources into each");
    }
  }
  return ok();
}

bool has_symbol(const ElfFile& file, GElf_Word table, std::string_view name) {
  return std::ranges::any_of(file.symbols(table),
                             [name](const ElfSymbol& at) { return at.name == name; });
}

/// Of a plugin that was not stripped: the sources with initialisers, each by its first symbol.
std::string initialised_by(const ElfFile& file) {
  constexpr std::string_view kPrefix = "_GLOBAL__sub_I_";
  std::string where;
  for (const ElfSymbol& at : file.symbols(SHT_SYMTAB)) {
    if (!at.name.starts_with(kPrefix)) continue;
    const std::string first = at.name.substr(kPrefix.size());
    where += (where.empty() ? "" : ", ") + printable(readable_symbol(first));
  }
  return where;
}

/// On arm64 the atomics of libgcc ask the C library at the start which instructions the CPU has. A
/// plugin that calls __getauxval() itself may have an initialiser of its own in place of that one.
std::size_t of_atomics([[maybe_unused]] const ElfFile& file) {
#if defined(__aarch64__)
  return has_symbol(file, SHT_DYNSYM, "__getauxval") ? 1 : 0;
#else
  return 0;
#endif
}

Status check_initialisers(const ElfFile& file) {
  const std::size_t all = file.dynamic(DT_INIT_ARRAYSZ).value_or(0) / sizeof(GElf_Addr);
  const std::size_t count = all - std::min(all, of_atomics(file));
  if (count <= kInitialisers) return ok();
  if (has_symbol(file, SHT_SYMTAB, "set_fast_math")) {
    return refuse(
        {Errc::plugin_refused, "plugin_fast_math"}, {},
        "is linked with -ffast-math (or -Ofast), whose start-up code crtfastmath would change the "
        "floating-point mode of mauved",
        "compile with the single options that you need, such as -fno-math-errno, or link without "
        "-ffast-math");
  }
  const std::string where = initialised_by(file);
  const std::string in = where.empty() ? "" : " (in the source of " + where + ")";
  if (has_symbol(file, SHT_DYNSYM, "_ZNSt8ios_base4InitC1Ev")) {
    return refuse(
        {Errc::plugin_refused, "plugin_static_initialiser"}, {},
        "includes <iostream>, which brings a static initialiser, std::ios_base::Init, that "
        "would run unguarded" +
            in,
        "include <ostream> or <iomanip> instead, and write with mauve::log");
  }
  return refuse({Errc::plugin_refused, "plugin_static_initialiser"}, {},
                "has static initialisers, which would run unguarded" +
                    (where.empty() ? ": " + std::to_string(count - kInitialisers)
                                   : ": in the source of " + where),
                "make the variables of that source constexpr, or static inside a function");
}

/// Checks read the section, and the dynamic linker the segment.
bool is_one_dynamic(const ElfFile& file) {
  const auto section = file.section(".dynamic");
  return section && std::ranges::count_if(file.segments(), [&](const GElf_Phdr& at) {
                      return at.p_type == PT_DYNAMIC && at.p_offset == section->header.sh_offset &&
                             at.p_vaddr == section->header.sh_addr;
                    }) == 1;
}

Status check_dynamic(const ElfFile& file) {
  if (file.dynamic().empty() || !is_one_dynamic(file)) {
    return refuse({Errc::plugin_refused, "plugin_damaged"}, {},
                  "is damaged: it has no dynamic section that is its dynamic segment", kHouseBuild);
  }
  if (file.dynamic(DT_TEXTREL) || (file.dynamic(DT_FLAGS).value_or(0) & DF_TEXTREL) != 0) {
    return refuse({Errc::plugin_refused, "plugin_unsafe_memory"}, {},
                  "has text relocations: its code would be writable", "compile it with -fPIC");
  }
  if (file.dynamic(DT_RPATH) || file.dynamic(DT_RUNPATH)) {
    return refuse({Errc::plugin_refused, "plugin_search_path"}, {},
                  "has a search path for libraries of its own (RPATH or RUNPATH)", kHouseBuild);
  }
  if (Status good = check_needed(file); !good) return good;
  return check_initialisers(file);
}

std::string build_id(const ElfFile& file) {
  const auto section = file.section(".note.gnu.build-id");
  Elf64_Nhdr note;
  if (!section || section->bytes.size() < sizeof note) return {};
  std::memcpy(&note, section->bytes.data(), sizeof note);
  const std::size_t begin = sizeof note + ((std::size_t{note.n_namesz} + 3) & ~std::size_t{3});
  const std::size_t size = section->bytes.size();
  if (begin > size || note.n_descsz > size - begin) return {};
  std::string text;
  for (const std::byte byte : section->bytes.subspan(begin, note.n_descsz)) {
    constexpr const char* kDigits = "0123456789abcdef";
    text += kDigits[std::to_integer<unsigned>(byte) >> 4];
    text += kDigits[std::to_integer<unsigned>(byte) & 15];
  }
  return text;
}

/// "was built with _GLIBCXX_DEBUG, this runtime without"
std::string differing_options(std::uint64_t theirs, std::uint64_t ours) {
  constexpr std::pair<std::uint64_t, const char*> kOptions[] = {
      {build_option::kNewStrings, "_GLIBCXX_USE_CXX11_ABI=1"},
      {build_option::kDebugContainers, "_GLIBCXX_DEBUG"},
      {build_option::kAddressSanitizer, "-fsanitize=address"},
      {build_option::kThreadSanitizer, "-fsanitize=thread"}};
  std::string with;
  std::string without;
  for (const auto& [option, name] : kOptions) {
    if (((theirs ^ ours) & option) == 0) continue;
    std::string& list = (theirs & option) != 0 ? with : without;
    list += (list.empty() ? "" : " and ") + std::string(name);
  }
  if (with.empty() && without.empty()) return "was built with options this runtime does not know";
  std::string text;
  if (!with.empty()) text = "was built with " + with + ", this runtime without";
  if (without.empty()) return text;
  return (text.empty() ? "" : text + "; it ") + "was built without " + without +
         ", this runtime with";
}

}  // namespace

Status check_manifest(const PluginManifest& manifest, std::string_view name) {
  const PluginManifest ours = detail::make_manifest("", kVersion);
  const std::string rebuild = std::string("rebuild it with mauve ") + kVersion;
  if (!std::equal(std::begin(ours.magic), std::end(ours.magic), std::begin(manifest.magic))) {
    return refuse({Errc::plugin_refused, "not_a_plugin"}, {},
                  "is not a mauve plugin: its manifest has no magic number", kHouseBuild);
  }
  if (manifest.size != ours.size || manifest.abi != ours.abi) {
    return refuse({Errc::abi_mismatch, "plugin_other_abi"}, {},
                  "has ABI " + std::to_string(manifest.abi) + ", this runtime has " +
                      std::to_string(ours.abi),
                  rebuild);
  }
  if (manifest.options != ours.options) {
    return refuse({Errc::abi_mismatch, "plugin_other_options"}, {},
                  differing_options(manifest.options, ours.options),
                  "build it with the options of this runtime, so that both see the same classes");
  }
  if (manifest.fingerprint != ours.fingerprint) {
    const std::string theirs = text_of(manifest.compiler);
    const std::string own = text_of(ours.compiler);
    return refuse({Errc::abi_mismatch, "plugin_other_headers"}, {},
                  "was built with other headers of mauve or of the standard library than this "
                  "runtime: its classes have other sizes (" +
                      (theirs == own ? "both by compiler " + own
                                     : "compiler " + theirs + ", this runtime " + own) +
                      ")",
                  rebuild);
  }
  if (text_of(manifest.name) != name) {
    return refuse({Errc::plugin_refused, "plugin_renamed"}, {},
                  "says that its name is \"" + text_of(manifest.name) + "\"",
                  "file and plugin have the same name: " + text_of(manifest.name) + ".so");
  }
  return ok();
}

Result<Facts> inspect(std::span<const std::byte> bytes, std::string_view name) {
  const Result<ElfFile> file = ElfFile::open(bytes);
  if (!file) return file.error();
  const Result<std::size_t> at = find_manifest(*file);
  if (!at) return at.error();
  PluginManifest manifest;
  std::memcpy(&manifest, bytes.data() + *at, sizeof manifest);
  Status good = check_manifest(manifest, name);
  if (good) good = check_damage(*file, bytes, *at, manifest.checksum);
  if (!good) return good.error();
  good = check_exports(file->symbols(SHT_DYNSYM));
  if (good) good = check_segments(*file);
  if (good) good = check_dynamic(*file);
  if (good) good = check_places(*file);
  if (good) good = check_lookup(*file);
  if (good) good = check_relocations(*file);
  if (!good) return good.error();

  Facts facts{manifest, build_id(*file), {}, file->needed()};
  if ((file->dynamic(DT_FLAGS_1).value_or(0) & DF_1_NODELETE) != 0) {
    facts.warnings.emplace_back("linked with -z nodelete: a reload cannot unmap it");
  }
  return facts;
}

}  // namespace mauve::plugin
