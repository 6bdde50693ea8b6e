// SPDX-License-Identifier: LGPL-3.0-or-later
#include "plugin/load/system_libraries.h"

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>

#include "rt/calls/original.h"
#include "rt/thread/run_guarded.h"

namespace mauve::plugin {

bool is_of_the_system(std::string_view named) {
  std::error_code failed;
  const auto real = std::filesystem::weakly_canonical(named, failed);
  const std::string path = failed ? std::string(named) : real.string();
  constexpr std::array<std::string_view, 4> kFolders{"/lib/", "/lib64/", "/usr/lib/",
                                                     "/usr/lib64/"};
  return std::ranges::any_of(kFolders, [&](auto folder) { return path.starts_with(folder); });
}

}  // namespace mauve::plugin

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which have their own
namespace {

constexpr const char* kNotRenewed =
    "whose library no reload renews: link its sources into the plugin";

constinit mauve::rt::Original<void*(const char*, int)> in_library_dlopen{"dlopen"};
constinit mauve::rt::Original<void*(Lmid_t, const char*, int)> in_library_dlmopen{"dlmopen"};

[[gnu::constructor]] void find_dlopen() {
  static_cast<void>(in_library_dlopen.find());
  static_cast<void>(in_library_dlmopen.find());
}

using Path = std::array<char, PATH_MAX>;

/// The file of this name in the folders of the system. There is none: where it would be.
void look_up(const char* name, Path& path) {
  Dl_info c_library{};
  dladdr(reinterpret_cast<void*>(in_library_dlopen.find()), &c_library);
  const std::string_view its = c_library.dli_fname == nullptr ? "" : c_library.dli_fname;
  const auto folder = its.substr(0, its.rfind('/') + 1);
  const std::array<std::string_view, 5> folders{folder, "/lib/", "/lib64/", "/usr/lib/",
                                                "/usr/lib64/"};
  for (const auto& place : folders) {
    std::snprintf(path.data(), path.size(), "%.*s%s", static_cast<int>(place.size()), place.data(),
                  name);
    if (access(path.data(), R_OK) == 0) return;
  }
}

}  // namespace

extern "C" {

/// In a job or hook a name is looked up in the folders of the system only, and a path must lead
/// there, unless the library is loaded already. Its symbols are no symbols for other libraries.
void* dlopen(const char* file, int mode) noexcept {
  auto* const open = in_library_dlopen.find();
  if (!mauve::rt::in_body() || file == nullptr) return open(file, mode);
  mode &= ~RTLD_GLOBAL;
  if (void* const loaded = open(file, mode | RTLD_NOLOAD)) return loaded;
  Path path{};
  if (std::strchr(file, '/') == nullptr) {
    look_up(file, path);
    file = path.data();
  } else if (realpath(file, path.data()) != nullptr &&
             !mauve::plugin::is_of_the_system(path.data())) {
    mauve::rt::refuse_in_body("dlopen", kNotRenewed);
  }
  return open(file, mode);
}

void* dlmopen(Lmid_t space, const char* file, int mode) noexcept {
  mauve::rt::refuse_in_body("dlmopen", "whose libraries are beside those of mauved: use dlopen()");
  return in_library_dlmopen.find()(space, file, mode);
}

}  // extern "C"
#endif
