// SPDX-License-Identifier: LGPL-3.0-or-later
#include "state/generations.h"

#include "base/thread_role.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <system_error>
#include <utility>

#include "arch/build/load.h"
#include "arch/text/json.h"
#include "base/mutex.h"
#include "plugin/load/trust.h"
#include "protocol/framing.h"
#include "state/durable.h"

namespace mauve::daemon {

namespace {

using protocol::Json;

constexpr std::array<std::string_view, 3> kMarks = {"unconfirmed", "confirmed", "rolled_back"};
constexpr std::string_view kBegin = "// mauve generation ";
constexpr std::size_t kDigits = 6;
/// No run comes near it: a file with a larger number is none of ours.
constexpr std::uint64_t kMostNumber = 1'000'000'000'000;
/// A damaged file keeps its number from being used again. A larger number than this is no number
/// of a generation: those after it would soon be too large to be read.
constexpr std::uint64_t kMostOfDamaged = 1'000'000'000;

/// FNV-1a: notices damage, no more is asked of it.
std::uint64_t checksum(std::string_view text, std::uint64_t sum = 0xcbf29ce484222325U) {
  for (const char letter : text) {
    sum = (sum ^ static_cast<unsigned char>(letter)) * 0x100000001b3U;
  }
  return sum;
}

/// The checksum covers the text and the header, except the checksum itself.
std::uint64_t checksum_of(Json about, std::string_view text) {
  about.erase("checksum");
  return checksum(text, checksum(protocol::to_line(about)));
}

std::string content_of(const Generation& about, const std::string& text) {
  Json head = {{"generation", about.number},   {"boot", about.boot},
               {"time", about.time},           {"uid", about.uid},
               {"command", about.command},     {"reason", about.reason},
               {"mark", to_string(about.mark)}};
  if (!about.changes.empty()) {
    head["changes"] = about.changes;
  }
  if (!about.folder.empty()) {
    head["folder"] = about.folder;
  }
  if (about.crashes > 0) {
    head["crashes"] = about.crashes;
  }
  if (!about.builds.empty()) {
    head["builds"] = about.builds;
  }
  // As a reader will see it: texts that are no UTF-8 have been mended by then.
  if (auto seen = protocol::parse_json(protocol::to_line(head))) {
    head = *std::move(seen);
  }
  head["checksum"] = checksum_of(head, text);
  return std::string(kBegin) + protocol::to_line(head) + "\n" + text;
}

std::optional<Confirmation> mark_named(const std::string& name) {
  const auto* found = std::find(kMarks.begin(), kMarks.end(), name);
  if (found == kMarks.end()) {
    return std::nullopt;
  }
  return static_cast<Confirmation>(found - kMarks.begin());
}

struct Read {
  Generation about;
  std::string text;
};

Read read_of(const Json& head, std::string_view text) {
  Read read;
  read.about.number = head["generation"].get<std::uint64_t>();
  read.about.boot = head["boot"].get<std::string>();
  read.about.time = head["time"].get<std::string>();
  read.about.uid = head["uid"].get<std::uint32_t>();
  read.about.command = head["command"].get<std::string>();
  read.about.reason = head["reason"].get<std::string>();
  read.about.mark = mark_named(head["mark"].get<std::string>()).value_or(Confirmation::unconfirmed);
  if (const auto changes = head.find("changes"); changes != head.end() && changes->is_string()) {
    read.about.changes = changes->get<std::string>();
  }
  if (const auto folder = head.find("folder"); folder != head.end() && folder->is_string()) {
    read.about.folder = folder->get<std::string>();
  }
  if (const auto crashes = head.find("crashes");
      crashes != head.end() && crashes->is_number_unsigned()) {
    read.about.crashes = crashes->get<unsigned>();
  }
  if (const auto builds = head.find("builds"); builds != head.end() && builds->is_object()) {
    for (const auto& [plugin, build] : builds->items()) {
      if (build.is_string()) {
        read.about.builds.emplace(plugin, build.get<std::string>());
      }
    }
  }
  read.text = text;
  return read;
}

bool is_whole(const Json& head, std::string_view text) {
  if (!head.is_object()) {
    return false;
  }
  const auto has = [&](const char* key, bool (Json::*is)() const noexcept) {
    return head.contains(key) && (head[key].*is)();
  };
  const bool numbers = has("generation", &Json::is_number_unsigned) &&
                       has("uid", &Json::is_number_unsigned) &&
                       has("checksum", &Json::is_number_unsigned);
  bool texts = true;
  for (const auto* key : {"boot", "time", "command", "reason", "mark"}) {
    texts = texts && has(key, &Json::is_string);
  }
  return numbers && texts && head["checksum"] == checksum_of(head, text);
}

Result<Read> read_generation(const std::filesystem::path& file, std::uint64_t number) {
  const auto content = arch::read_file(file.string(), &plugin::Trust::of_this_process());
  if (!content) {
    return content.error();
  }
  const std::string_view all = *content;
  const auto end = all.find('\n');
  if (all.starts_with(kBegin) && end != std::string_view::npos) {
    const auto head = protocol::parse_json(all.substr(kBegin.size(), end - kBegin.size()));
    const auto text = all.substr(end + 1);
    if (head && is_whole(*head, text) && (*head)["generation"] == number) {
      return read_of(*head, text);
    }
  }
  return refuse({Errc::invalid_value, "state_damaged"}, file.string(),
                "is damaged: its checksum does not fit");
}

/// The number in the name of a file: "000042.json".
std::optional<std::uint64_t> number_of(const std::filesystem::path& file) {
  const std::string name = file.stem().string();
  std::uint64_t number = 0;
  const auto* end = name.data() + name.size();
  const auto read = std::from_chars(name.data(), end, number);
  const bool fits = file.extension() == ".json" && read.ec == std::errc{} && read.ptr == end &&
                    number <= kMostNumber;
  return fits ? std::optional(number) : std::nullopt;
}

/// The description of a generation that is saved once more.
Generation joined(const Generation& saved, const Generation& about) {
  Generation whole = saved.command.empty() ? about : saved;
  whole.builds = about.builds;
  whole.crashes = saved.crashes;
  if (saved.mark != Confirmation::unconfirmed) {
    whole.mark = saved.mark;
  }
  return whole;
}

}  // namespace

std::string_view to_string(Confirmation mark) { return kMarks.at(static_cast<std::size_t>(mark)); }

Result<std::unique_ptr<Generations>> Generations::open(const std::filesystem::path& directory) {
  if (auto made = make_directory(directory); !made) {
    return made.error();
  }
  std::unique_ptr<Generations> generations(new Generations(directory));
  generations->look();
  return generations;
}

void Generations::look() {
  const MutexLock lock(mutex_);
  std::error_code failed;
  for (std::filesystem::directory_iterator it(directory_, failed), end; !failed && it != end;
       it.increment(failed)) {
    const auto number = number_of(it->path());
    if (it->path().extension() == ".new") {
      std::error_code ignored;
      std::filesystem::remove(it->path(), ignored);  // of a save that was cut off
    }
    if (!number || it->path() != file(*number)) {
      continue;
    }
    Generation about;
    about.number = *number;
    about.damaged = true;
    if (auto read = read_generation(it->path(), *number)) {
      about = std::move(read->about);
    }
    const bool counts = !about.damaged || *number <= kMostOfDamaged;
    known_[*number] = std::move(about);
    if (counts) newest_ = std::max(newest_, *number);
  }
}

Status Generations::save(const Generation& about, const std::string& text) {
  MAUVE_ON_THREAD(disk);
  Generation whole = about;
  bool same_author = true;
  {
    const MutexLock lock(mutex_);
    const auto found = known_.find(about.number);
    if (found != known_.end() && !found->second.damaged) {
      whole = joined(found->second, about);
      same_author = whole.command == found->second.command;
    }
  }
  if (same_author && last_number_ == whole.number && last_text_ == text &&
      last_builds_ == whole.builds) {
    return ok();
  }
  if (auto written = write(whole, text); !written) {
    return written;
  }
  last_number_ = whole.number;
  last_text_ = text;
  last_builds_ = whole.builds;
  prune();
  return ok();
}

Status Generations::write(const Generation& about, const std::string& text) {
  const auto content = content_of(about, text);
  if (content.size() > arch::JsonLimits{}.bytes) {
    return refuse({Errc::limit, "architecture_too_long"}, file(about.number).string(),
                  "the architecture is too long to save");
  }
  if (auto replaced = replace_file(file(about.number), content); !replaced) {
    return replaced;
  }
  const MutexLock lock(mutex_);
  known_[about.number] = about;
  newest_ = std::max(newest_, about.number);
  return ok();
}

Status Generations::mark(std::uint64_t number, Confirmation mark) {
  MAUVE_ON_THREAD(disk);
  auto read = read_generation(file(number), number);
  if (!read) {
    return read.error();
  }
  if (read->about.mark == mark) {
    return ok();
  }
  read->about.mark = mark;
  return write(read->about, read->text);
}

Status Generations::set_crashes(std::uint64_t number, unsigned crashes) {
  auto read = read_generation(file(number), number);
  if (!read) {
    return read.error();
  }
  if (read->about.crashes == crashes) {
    return ok();
  }
  read->about.crashes = crashes;
  return write(read->about, read->text);
}

void Generations::remove(std::uint64_t number) {
  {
    const MutexLock lock(mutex_);
    known_.erase(number);
  }
  std::error_code ignored;
  std::filesystem::remove(file(number), ignored);
}

void Generations::prune() {
  std::vector<std::uint64_t> old;
  {
    const MutexLock lock(mutex_);
    const auto keep = newest_confirmed();
    for (auto it = known_.begin(); it != known_.end() && known_.size() > kKept;) {
      if (it->first == keep) {
        ++it;
        continue;
      }
      old.push_back(it->first);
      it = known_.erase(it);
    }
  }
  for (const auto number : old) {
    std::error_code ignored;
    std::filesystem::remove(file(number), ignored);
  }
}

std::uint64_t Generations::newest_confirmed() const {
  for (auto it = known_.rbegin(); it != known_.rend(); ++it) {
    if (it->second.mark == Confirmation::confirmed && !it->second.damaged) {
      return it->first;
    }
  }
  return 0;
}

std::vector<Generation> Generations::list() const {
  std::vector<Generation> all;
  const MutexLock lock(mutex_);
  for (auto it = known_.rbegin(); it != known_.rend(); ++it) {
    all.push_back(it->second);
  }
  return all;
}

std::optional<Generation> Generations::find(std::uint64_t number) const {
  const MutexLock lock(mutex_);
  const auto found = known_.find(number);
  const bool whole = found != known_.end() && !found->second.damaged;
  return whole ? std::optional(found->second) : std::nullopt;
}

std::optional<Confirmation> Generations::mark_of(std::uint64_t number) const {
  const auto found = find(number);
  return found ? std::optional(found->mark) : std::nullopt;
}

std::uint64_t Generations::newest() const {
  const MutexLock lock(mutex_);
  return newest_;
}

Result<std::string> Generations::text(std::uint64_t number) const {
  {
    const MutexLock lock(mutex_);
    if (!known_.contains(number)) {
      return refuse({Errc::unknown_name, "unknown_generation"},
                    "generation " + std::to_string(number), "is not kept (any more)",
                    "mauvectl history lists those that are");
    }
  }
  auto read = read_generation(file(number), number);
  if (!read) {
    return read.error();
  }
  return std::move(read->text);
}

std::filesystem::path Generations::file(std::uint64_t number) const {
  const auto digits = std::to_string(number);
  const std::string zeros(digits.size() < kDigits ? kDigits - digits.size() : 0, '0');
  return directory_ / (zeros + digits + ".json");
}

}  // namespace mauve::daemon
