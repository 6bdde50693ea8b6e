// SPDX-License-Identifier: LGPL-3.0-or-later
#include "base/thread_role.h"

#include <sys/prctl.h>

#include <locale.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace mauve {
namespace {

constexpr std::array<std::string_view, 15> kNames{"none",   "answer", "control", "disk",  "factory",
                                                  "health", "io",     "judge",   "log",   "rt",
                                                  "reaper", "rules",  "stop",    "trace", "watch"};

ThreadRole& role_here() {
  [[gnu::tls_model("initial-exec")]] static thread_local ThreadRole role = ThreadRole::none;
  return role;
}

}  // namespace

std::string_view to_string(ThreadRole role) { return kNames.at(static_cast<std::size_t>(role)); }

void begin_thread(ThreadRole role) {
  const std::string name = "mauve-" + std::string(to_string(role));
  prctl(PR_SET_NAME, name.c_str());
  take_thread_role(role);
}

void take_thread_role(ThreadRole role) {
  role_here() = role;
  keep_c_locale();
}

void keep_c_locale() {
  static const locale_t c = newlocale(LC_ALL_MASK, "C", nullptr);  // lives as long as the process
  uselocale(c);
}

ThreadRole thread_role() { return role_here(); }

void check_thread_role(ThreadRole role, const char* function) {
  const ThreadRole here = role_here();
  if (here == role || here == ThreadRole::none) return;
  std::fprintf(stderr,
               "mauve: %s() belongs to thread [%s], but thread [%s] called it: this is a defect of "
               "mauve, so it ends here\n",
               function, to_string(role).data(), to_string(here).data());
  std::abort();
}

}  // namespace mauve
