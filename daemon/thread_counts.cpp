// SPDX-License-Identifier: LGPL-3.0-or-later
#include "thread_counts.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

namespace mauve::daemon {

namespace {

constexpr std::size_t kKernelName = 15;

std::optional<std::uint64_t> number_in(std::string_view text) {
  std::uint64_t number = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && rest != text.data() ? std::optional(number) : std::nullopt;
}

/// Field `index` of a line whose fields one blank separates.
std::string_view field(std::string_view line, std::size_t index) {
  for (; index > 0; --index) {
    const auto blank = line.find(' ');
    if (blank == std::string_view::npos) return {};
    line.remove_prefix(blank + 1);
  }
  return line.substr(0, line.find_first_of(" \n"));
}

/// The number behind "NAME:" and blanks.
std::optional<std::uint64_t> labelled(std::string_view text, std::string_view label) {
  const auto at = text.find(label);
  if (at == std::string_view::npos) return std::nullopt;
  text.remove_prefix(at + label.size());
  text.remove_prefix(std::min(text.size(), text.find_first_not_of(" \t")));
  return number_in(text);
}

std::string content_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

std::optional<ThreadCounts> read_counts(std::string_view stat, std::string_view status) {
  // The name, in parentheses, may have blanks and parentheses in it: fields are counted behind it.
  const auto name_ends = stat.rfind(')');
  if (name_ends == std::string_view::npos || name_ends + 2 > stat.size()) return std::nullopt;
  const auto fields = stat.substr(name_ends + 2);
  constexpr std::size_t kMinor = 7;  // field 10 of proc(5); the first one here is its field 3
  constexpr std::size_t kMajor = 9;
  const auto minor = number_in(field(fields, kMinor));
  const auto major = number_in(field(fields, kMajor));
  const auto waits = labelled(status, "\nvoluntary_ctxt_switches:");
  const auto preemptions = labelled(status, "\nnonvoluntary_ctxt_switches:");
  if (!minor || !major || !waits || !preemptions) return std::nullopt;
  return ThreadCounts{*minor, *major, *waits, *preemptions};
}

std::map<std::string, ThreadCounts> thread_counts() {
  std::map<std::string, ThreadCounts> all;
  std::set<std::string> twice;
  std::error_code ended;  // threads come and go meanwhile
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task", ended)) {
    std::string name = content_of(entry.path() / "comm");
    if (!name.empty() && name.back() == '\n') name.pop_back();
    const auto counts =
        read_counts(content_of(entry.path() / "stat"), content_of(entry.path() / "status"));
    if (counts && !all.emplace(name, *counts).second) twice.insert(name);
  }
  for (const auto& name : twice) all.erase(name);
  return all;
}

const ThreadCounts* find_counts(const std::map<std::string, ThreadCounts>& all,
                                const std::string& component) {
  const auto found = all.find(component.substr(0, kKernelName));
  return found == all.end() ? nullptr : &found->second;
}

}  // namespace mauve::daemon
