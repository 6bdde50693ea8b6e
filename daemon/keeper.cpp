// SPDX-License-Identifier: LGPL-3.0-or-later
#include "keeper.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <future>
#include <utility>

#include "arch/load.h"
#include "arch/value_json.h"
#include "durable.h"

namespace mauve::daemon {

namespace {

using logging::Event;

std::filesystem::path marker_in(const std::string& directory) {
  return std::filesystem::path(directory) / "running";
}

std::filesystem::path quarantine_in(const std::string& directory) {
  return std::filesystem::path(directory) / "quarantine.json";
}

std::filesystem::path audit_in(const std::string& directory) {
  return std::filesystem::path(directory) / "audit.log";
}

}  // namespace

Result<std::unique_ptr<Keeper>> Keeper::open(const std::string& directory, logging::Log& log) {
  std::unique_ptr<Keeper> keeper(new Keeper(directory, log));
  if (auto made = make_directory(directory); !made) {
    return made.error();
  }
  auto held = hold_directory(directory);
  if (!held) {
    return held.error();
  }
  keeper->held_ = std::move(*held);
  auto generations = Generations::open(std::filesystem::path(directory) / "generations");
  if (!generations) {
    return generations.error();
  }
  keeper->generations_ = std::move(*generations);
  std::error_code ignored;
  keeper->crashed_ = std::filesystem::exists(marker_in(directory), ignored);
  keeper->read_quarantine();
  return keeper;
}

void Keeper::begin(const Generation& first, const Value& architecture) {
  save(first, architecture);
  if (auto put = put_marker(marker_in(directory_)); !put) {
    report(Event::generation_not_saved, put.error());
  }
  disk_.start();
}

void Keeper::end() {
  disk_.stop();
  if (auto removed = remove_marker(marker_in(directory_)); !removed) {
    report(Event::generation_not_saved, removed.error());
  }
}

void Keeper::keep(Generation about, Value architecture, Json line,
                  std::function<void(bool saved)> then) {
  save_then(std::move(about), std::move(architecture), false, std::move(line), std::move(then));
}

void Keeper::confirm(Generation about, Value architecture, Json line,
                     std::function<void(bool saved)> then) {
  save_then(std::move(about), std::move(architecture), true, std::move(line), std::move(then));
}

void Keeper::save_then(Generation about, Value architecture, bool confirm, Json line,
                       std::function<void(bool saved)> then) {
  std::error_code unknown;
  about.folder = std::filesystem::current_path(unknown).string();
  // Before the lines of refused changes, of which anybody can make many.
  disk_.post_urgent([this, about = std::move(about), architecture = std::move(architecture),
                     confirm, line = std::move(line), then = std::move(then)]() mutable {
    bool saved = save(about, architecture);
    if (saved && confirm) {
      saved = mark_now(about.number, Mark::confirmed);
    }
    line["saved"] = saved;
    write_lines(protocol::to_line(line));
    if (then) {
      then(saved);
    }
  });
}

void Keeper::audit(const Json& line) {
  auto text = protocol::to_line(line);
  const std::lock_guard lock(mutex_);
  if (waiting_.size() >= kWaiting) {
    ++lost_;
    return;
  }
  waiting_.push_back(std::move(text));
  if (waiting_.size() == 1) {
    disk_.post([this] { write_waiting(); });
  }
}

/// All at once: who is refused a thousand times a second keeps the disk busy once.
void Keeper::write_waiting() {
  std::vector<std::string> lines;
  std::uint64_t lost = 0;
  {
    const std::lock_guard lock(mutex_);
    lines.swap(waiting_);
    std::swap(lost, lost_);
  }
  std::string text;
  for (const auto& line : lines) {
    text += (text.empty() ? "" : "\n") + line;
  }
  if (lost > 0) {
    const auto now = logging::utc(std::chrono::system_clock::now());
    text += "\n" + protocol::to_line({{"time", now}, {"lost", lost}});
    log_.write(Event::events_lost,
               {{"count", static_cast<std::int64_t>(lost)}, {"source", "the audit log"}});
  }
  write_lines(text);
}

void Keeper::mark(std::uint64_t generation, Mark mark) {
  disk_.post_urgent([this, generation, mark] { mark_now(generation, mark); });
}

/// [disk]
bool Keeper::mark_now(std::uint64_t generation, Mark mark) {
  const auto marked = generations_->mark(generation, mark);
  if (!marked) {
    report(Event::generation_not_saved, marked.error());
  }
  return marked.has_value();
}

void Keeper::confirm_like(std::uint64_t generation, std::uint64_t earlier) {
  disk_.post_urgent([this, generation, earlier] {
    if (auto marked = generations_->confirm_like(generation, earlier); !marked) {
      report(Event::generation_not_saved, marked.error());
    }
  });
}

void Keeper::quarantine(Json cores) {
  disk_.post_urgent([this, cores = std::move(cores)] {
    const Json list = {{"cores", cores}};
    if (auto written = replace_file(quarantine_in(directory_), protocol::to_line(list) + "\n");
        !written) {
      report(Event::generation_not_saved, written.error());
    }
  });
}

void Keeper::read_quarantine() {
  const auto file = quarantine_in(directory_);
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) {
    return;
  }
  const auto text = arch::read_file(file.string());
  auto list = text ? protocol::parse_json(*text) : Result<Json>(text.error());
  const bool whole = list && list->is_object() && list->contains("cores") &&
                     (*list)["cores"].is_array() &&
                     std::all_of((*list)["cores"].begin(), (*list)["cores"].end(),
                                 [](const Json& entry) { return entry.is_object(); });
  if (!whole) {
    return report(Event::quarantine_lost,
                  text ? refuse(Errc::invalid_value, file.string(), "is damaged") : text.error());
  }
  quarantined_ = std::move((*list)["cores"]);
}

void Keeper::flush() {
  std::promise<void> done;
  if (disk_.post([&done] { done.set_value(); })) {
    done.get_future().wait();
  }
}

bool Keeper::save(const Generation& about, const Value& architecture) {
  const auto done = generations_->save(about, arch::to_json_text(architecture) + "\n");
  saved_ = done.has_value();
  if (!done) {
    report(Event::generation_not_saved, done.error());
  }
  return done.has_value();
}

/// Two files of this size at most: the present one, and the one before it.
Status Keeper::rotate_audit() const {
  constexpr std::uintmax_t kLargest = 64 * 1024 * 1024;
  const auto file = audit_in(directory_);
  std::error_code failed;
  const auto size = std::filesystem::file_size(file, failed);
  if (failed || size < kLargest) {
    return ok();
  }
  std::filesystem::rename(file, file.string() + ".1", failed);
  return failed ? refuse(Errc::system, file.string(), "cannot be renamed: " + failed.message())
                : ok();
}

void Keeper::write_lines(const std::string& lines) {
  auto written = rotate_audit();
  if (written) {
    written = append_lines(audit_in(directory_), lines);
  }
  if (!written && !audit_broken_) {
    report(Event::audit_failed, written.error());
  }
  audit_broken_ = !written;
}

void Keeper::report(Event event, const Error& error) {
  log_.write(event, {{"text", to_string(error)}, {"file", error.at}});
}

}  // namespace mauve::daemon
