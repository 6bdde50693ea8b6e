// SPDX-License-Identifier: LGPL-3.0-or-later
#include "render/words.h"

#include <pwd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>

#include "base/number_list.h"
#include "protocol/in_words.h"
#include "render/table.h"

namespace mauve::ctl {
namespace {

constexpr std::array<std::string_view, 29> kFirst{
    "address", "name",     "plugin",  "kind",      "type",     "data", "core",   "state",
    "status",  "fsm",      "value",   "age_ns",    "default",  "min",  "max",    "range",
    "unit",    "text",     "version", "fsm_state", "priority", "cpus", "period", "releases",
    "missed",  "overruns", "service", "wait_ns",   "next"};

std::size_t place_of(const std::string& key) {
  const auto found = std::find(kFirst.begin(), kFirst.end(), key);
  return static_cast<std::size_t>(found - kFirst.begin());
}

std::string one_decimal(double value, const char* unit) {
  std::array<char, 48> text{};
  const char* format = value >= 100 ? "%.0f %s" : "%.1f %s";
  std::snprintf(text.data(), text.size(), format, value, unit);
  return text.data();
}

}  // namespace

std::string word(const Json& object, std::string_view key) {
  if (!object.is_object()) return {};
  const auto found = object.find(key);
  return found == object.end() ? std::string{} : compact(*found);
}

const Json& member(const Json& object, std::string_view key) {
  static const Json kNothing;
  if (!object.is_object()) return kNothing;
  const auto found = object.find(key);
  return found == object.end() ? kNothing : *found;
}

const Json& list_in(const Json& object, const char* key) {
  static const Json kNone = Json::array();
  if (!object.is_object()) return kNone;
  const auto found = object.find(key);
  return found != object.end() && found->is_array() ? *found : kNone;
}

std::string text_in(const Json& object, std::string_view key) {
  const Json& text = member(object, key);
  return text.is_string() ? text.get<std::string>() : std::string{};
}

void join(std::string& all, std::string_view next, std::string_view between) {
  if (!all.empty()) all += between;
  all += next;
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    lines.push_back(text.substr(0, text.find('\n')));
    text.remove_prefix(std::min(text.size(), lines.back().size() + 1));
  }
  return lines;
}

std::string compact(const Json& value) { return harmless(protocol::in_words(value)); }

std::string_view first_words(std::string_view text, std::size_t width) {
  if (columns(text) <= width) return text;
  std::size_t end = std::string_view::npos;
  for (std::size_t at = text.find(' ', 1); at != std::string_view::npos;
       at = text.find(' ', at + 1)) {
    if (end != std::string_view::npos && columns(text.substr(0, at)) > width) break;
    end = at;
  }
  return text.substr(0, end);
}

std::string wrapped(std::string_view text, std::size_t width, std::size_t indent) {
  if (width <= indent + 20) return std::string(text);
  std::string result;
  for (std::size_t room = width; columns(text) > room; room = width - indent) {
    const std::string_view line = first_words(text, room);
    if (line.size() == text.size()) break;
    result.append(line).append("\n").append(indent, ' ');
    text.remove_prefix(line.size() + 1);
  }
  return result.append(text);
}

std::string cut(std::string_view text, std::size_t width) {
  if (width == 0 || columns(text) <= width) return std::string(text);
  std::size_t kept = 0;
  for (std::size_t seen = 0; kept < text.size(); ++kept) {
    if (starts_letter(text[kept]) && ++seen == width) break;
  }
  return std::string(text.substr(0, kept)) + "…";
}

std::string nanoseconds_in_words(double nanoseconds) {
  if (nanoseconds < 0) return "-" + nanoseconds_in_words(-nanoseconds);
  if (nanoseconds < 1e3) return std::to_string(static_cast<long>(nanoseconds)) + " ns";
  if (nanoseconds < 1e6) return one_decimal(nanoseconds / 1e3, "us");
  if (nanoseconds < 1e9) return one_decimal(nanoseconds / 1e6, "ms");
  return one_decimal(nanoseconds / 1e9, "s");
}

std::string recovery_in_words(const Json& recovery) {
  const std::string by = word(recovery, "by");
  if (by == "rollback") return "the change on probation is being rolled back";
  if (by == "fallback") return "its fallback core takes over as soon as it stands by";
  if (by != "restart") return {};
  const double in = number(recovery, "in_ns");
  return "it restarts with a fresh core " +
         (in > 0 ? "in " + nanoseconds_in_words(in) : "as soon as that stands by") + ", " +
         counted(whole_number(recovery, "restarts_left"), "restart") + " left";
}

std::string seconds_in_words(double seconds) {
  struct Unit {
    long seconds;
    const char* name;
  };
  constexpr std::array<Unit, 4> kUnits{{{86400, "d"}, {3600, "h"}, {60, "min"}, {1, "s"}}};
  auto rest = static_cast<long>(seconds);
  std::string result;
  for (std::size_t i = 0; i < kUnits.size(); ++i) {
    const bool last = i + 1 == kUnits.size();
    if (rest < kUnits[i].seconds && !last) continue;
    result = std::to_string(rest / kUnits[i].seconds) + " " + kUnits[i].name;
    rest %= kUnits[i].seconds;
    if (last || rest < kUnits[i + 1].seconds) return result;
    return result + " " + std::to_string(rest / kUnits[i + 1].seconds) + " " + kUnits[i + 1].name;
  }
  return result;
}

std::string counted(std::uint64_t count, std::string_view noun) {
  return std::to_string(count) + " " + std::string(noun) + (count == 1 ? "" : "s");
}

std::optional<std::uint64_t> count_of(std::string_view text) {
  std::uint64_t count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return count;
}

std::vector<std::string> keys_in_order(const Json& value) {
  std::vector<std::string> keys;
  const auto collect = [&](const Json& object) {
    for (const auto& [key, member] : object.items()) keys.push_back(key);
  };
  if (value.is_object()) collect(value);
  if (value.is_array()) {
    for (const Json& item : value) {
      if (item.is_object()) collect(item);
    }
  }
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  std::stable_sort(keys.begin(), keys.end(), [](const std::string& a, const std::string& b) {
    return place_of(a) < place_of(b);
  });
  return keys;
}

double number(const Json& object, std::string_view key) {
  if (!object.is_object()) return 0;
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? found->get<double>() : 0;
}

std::uint64_t whole_number(const Json& object, std::string_view key) {
  const double value = number(object, key);
  return value > 0 && value < 1.8e19 ? static_cast<std::uint64_t>(value) : 0;
}

std::string user_in_words(const Json& one) {
  const std::string number = word(one, "uid");
  std::array<char, 4096> buffer{};
  passwd entry{};
  passwd* found = nullptr;
  if (member(one, "uid").is_number_unsigned()) {
    getpwuid_r(member(one, "uid").get<uid_t>(), &entry, buffer.data(), buffer.size(), &found);
  }
  return found == nullptr ? number : harmless(entry.pw_name);
}

std::string time_in_words(std::string time) {
  if (const auto dot = time.find('.'); dot != std::string::npos) time.erase(dot, 7);
  if (const auto day = time.find('T'); day != std::string::npos) time[day] = ' ';
  return time;
}

std::string changes_in_words(const Json& one) {
  std::string names;
  for (const Json& name : list_in(one, "components")) join(names, compact(name));
  if (!names.empty()) names = " (" + names + ")";
  std::vector<std::uint64_t> all;
  for (const Json& number : list_in(one, "generations")) {
    if (number.is_number_integer()) all.push_back(number.get<std::uint64_t>());
  }
  return (all.empty() ? "a change" : generations_in_words(all)) + names;
}

std::string kernel_in_words(const Json& kernel) {
  if (!kernel.is_object()) return {};
  const auto faults = whole_number(kernel, "minor_faults") + whole_number(kernel, "major_faults");
  return "the kernel counts, since the thread began: " + counted(faults, "page fault") + " (" +
         word(kernel, "major_faults") + " from disk), " +
         counted(whole_number(kernel, "waits"), "wait") + ", preempted " +
         counted(whole_number(kernel, "preemptions"), "time");
}

std::string mark_of_transition(const Json& transitions, std::size_t index) {
  const Json& one = transitions[index];
  if (member(one, "guarded") != true) return transitions.size() > 1 ? "[else]" : "";
  const Json& name = member(one, "guard");
  return "[" + (name.is_string() ? compact(name) : std::to_string(index + 1)) + "]";
}

}  // namespace mauve::ctl
