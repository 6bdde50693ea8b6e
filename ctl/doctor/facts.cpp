// SPDX-License-Identifier: LGPL-3.0-or-later
#include "doctor/facts.h"

#include <grp.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <sstream>

#include "render/words.h"
#include "rt/process/process.h"

namespace mauve::ctl::doctor {
namespace {

constexpr std::int64_t kMostCpus = 1023;

bool is_cpu_folder(const std::string& name) {
  return name.size() > 3 && name.starts_with("cpu") &&
         name.find_first_not_of("0123456789", 3) == std::string::npos;
}

}  // namespace

std::optional<std::string> Facts::text(std::string_view file) const {
  return rt::file_text(root / file);
}

std::vector<std::string> Facts::names(std::string_view folder) const {
  std::vector<std::string> result;
  std::error_code failed;
  for (std::filesystem::directory_iterator one(root / folder, failed), end; !failed && one != end;
       one.increment(failed)) {
    result.push_back(one->path().filename().string());
  }
  std::sort(result.begin(), result.end());
  return result;
}

std::vector<std::string> Facts::cpu_folders() const {
  std::vector<std::string> result = names("sys/devices/system/cpu");
  std::erase_if(result, [](const std::string& name) { return !is_cpu_folder(name); });
  std::sort(result.begin(), result.end(), [](const std::string& a, const std::string& b) {
    return whole(std::string_view(a).substr(3)) < whole(std::string_view(b).substr(3));
  });
  return result;
}

std::string Facts::kernel() const { return text("proc/sys/kernel/osrelease").value_or(""); }

std::optional<std::string> Facts::kernel_option(std::string_view name) const {
  auto config = text("boot/config-" + kernel());
  if (!config) config = text("lib/modules/" + kernel() + "/config");
  if (!config) return std::nullopt;
  std::istringstream lines(*config);
  const std::string begin = std::string(name) + "=";
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(begin)) return line.substr(begin.size());
  }
  return "";
}

std::optional<std::string> Facts::boot_option(std::string_view name) const {
  std::istringstream words(text("proc/cmdline").value_or(""));
  std::optional<std::string> value;
  for (std::string word; words >> word;) {
    if (word == name) value = "";
    if (word.starts_with(std::string(name) + "=")) value = word.substr(name.size() + 1);
  }
  return value;
}

std::vector<Json> Facts::components() const {
  std::vector<Json> rows;
  for (const Json& row : list_in(status, "components")) {
    if (number(row, "priority") > 0) rows.push_back(row);
  }
  return rows;
}

std::string Facts::asked_realtime() const {
  return daemon.is_object() ? word(daemon, "realtime") : "";
}

std::string group_of_caller() {
  std::vector<gid_t> mine(static_cast<std::size_t>(std::max(getgroups(0, nullptr), 0)));
  mine.resize(
      static_cast<std::size_t>(std::max(getgroups(static_cast<int>(mine.size()), mine.data()), 0)));
  mine.push_back(getgid());
  for (const char* name : {"mauve", "mauve-admin"}) {
    const ::group* found = getgrnam(name);
    if (found != nullptr && std::ranges::find(mine, found->gr_gid) != mine.end()) return name;
  }
  return "mauve";
}

std::int64_t whole(std::string_view text) {
  std::int64_t value = -1;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

std::vector<int> cpus_in(std::string_view list) {
  std::vector<int> cpus;
  while (!list.empty()) {
    const std::string_view range = list.substr(0, list.find(','));
    list.remove_prefix(std::min(list.size(), range.size() + 1));
    const auto dash = range.find('-');
    const std::int64_t first = std::max<std::int64_t>(whole(range.substr(0, dash)), -1);
    const std::int64_t last =
        dash == std::string_view::npos ? first : whole(range.substr(dash + 1));
    for (auto cpu = first; cpu >= 0 && cpu <= std::min(last, kMostCpus); ++cpu) {
      cpus.push_back(static_cast<int>(cpu));
    }
  }
  return cpus;
}

std::string cpu_list(const std::vector<int>& cpus) {
  std::string text;
  for (std::size_t i = 0; i < cpus.size();) {
    std::size_t last = i;
    while (last + 1 < cpus.size() && cpus[last + 1] == cpus[last] + 1) ++last;
    text += (text.empty() ? "" : ",") + std::to_string(cpus[i]);
    if (last > i) text += "-" + std::to_string(cpus[last]);
    i = last + 1;
  }
  return text;
}

}  // namespace mauve::ctl::doctor
