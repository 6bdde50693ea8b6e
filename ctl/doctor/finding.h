// SPDX-License-Identifier: LGPL-3.0-or-later
/// The result of a check of `mauvectl doctor`.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace mauve::ctl::doctor {

enum class Grade : std::uint8_t { ok, warn, fail };

/// "OK", "WARN", "FAIL".
[[nodiscard]] std::string_view to_string(Grade grade);

struct Finding {
  Grade grade = Grade::ok;
  std::string found;   ///< one sentence
  std::string remedy;  ///< a command, or a line and its file; empty where nothing is to be done
};

inline Finding good(std::string found) { return {Grade::ok, std::move(found), {}}; }
inline Finding doubt(std::string found, std::string remedy) {
  return {Grade::warn, std::move(found), std::move(remedy)};
}
inline Finding bad(std::string found, std::string remedy) {
  return {Grade::fail, std::move(found), std::move(remedy)};
}
/// For facts that only a running mauved knows.
inline Finding no_daemon() { return good("no daemon"); }

}  // namespace mauve::ctl::doctor
