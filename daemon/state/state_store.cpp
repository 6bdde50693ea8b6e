// SPDX-License-Identifier: LGPL-3.0-or-later
#include "state/state_store.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <future>
#include <utility>

#include "arch/build/load.h"
#include "arch/text/value_json.h"
#include "base/mutex.h"
#include "base/thread_role.h"
#include "plugin/load/trust.h"
#include "state/durable.h"

namespace mauve::daemon {

namespace {

using logging::Event;

std::filesystem::path quarantine_in(const std::string& directory) {
  return std::filesystem::path(directory) / "quarantine.json";
}

std::filesystem::path audit_in(const std::string& directory) {
  return std::filesystem::path(directory) / "audit.log";
}

/// Else a crash loop would push out the other generations.
void remove_crashed_start(const LastRun& last, Generations& generations, logging::Log& log) {
  const auto start = generations.find(last.began_with());
  if (!last.crashed() || !start || start->mark != Confirmation::unconfirmed ||
      (start->command != kStart && start->command != kRecover)) {
    return;
  }
  generations.remove(start->number);
  log.write(Event::generation_removed, {{"generation", static_cast<std::int64_t>(start->number)}});
}

}  // namespace

Result<std::unique_ptr<StateStore>> StateStore::open(const std::string& directory,
                                                     logging::Log& log) {
  std::unique_ptr<StateStore> store(new StateStore(directory, log));
  if (auto made = make_directory(directory); !made) {
    return made.error();
  }
  auto held = hold_directory(directory);
  if (!held) {
    return held.error();
  }
  store->held_ = std::move(*held);
  const auto folder = std::filesystem::path(directory) / "generations";
  store->put_aside(folder);
  auto generations = Generations::open(folder);
  if (!generations) {
    return generations.error();
  }
  store->generations_ = std::move(*generations);
  store->last_run_.read(!store->generations_->list().empty());
  store->read_quarantine();
  return store;
}

/// Damage keeps nothing from starting: a file where a folder belongs gets another name.
void StateStore::put_aside(const std::filesystem::path& folder) {
  std::error_code failed;
  const auto kind = std::filesystem::symlink_status(folder, failed).type();
  if (kind == std::filesystem::file_type::not_found ||
      kind == std::filesystem::file_type::directory) {
    return;
  }
  const auto first = folder.string() + ".damaged";
  auto other = first;
  for (int i = 2; std::filesystem::exists(std::filesystem::symlink_status(other, failed)); ++i) {
    other = first + "." + std::to_string(i);
  }
  std::filesystem::rename(folder, other, failed);
  report(Event::generation_not_saved,
         refuse({Errc::invalid_value, "state_damaged"}, folder.string(),
                failed ? "is no folder, and cannot be renamed: " + failed.message()
                       : "is no folder: it is now " + other + ", and no generation is known"));
}

void StateStore::begin(const Generation& first, const Value& architecture,
                       std::uint64_t recovered) {
  static_cast<void>(stops_.write());
  remove_crashed_start(last_run_, *generations_, log_);
  if (save(first, architecture)) {
    last_run_.started(first.number);
  }
  first_ = first.number;
  recovered_ = recovered;
  disk_.start();
}

/// After an orderly end the crashes of the architecture that this run began with count anew, also
/// if components stayed stopped that run in the saved one.
void StateStore::end_row_of_crashes() {
  const auto began = generations_->text(first_);
  const auto recovered = generations_->text(recovered_);
  for (const auto& one : generations_->list()) {
    if (one.crashes == 0) {
      continue;
    }
    const auto text = generations_->text(one.number);
    if (text && ((began && *text == *began) || (recovered && *text == *recovered))) {
      static_cast<void>(generations_->set_crashes(one.number, 0));
    }
  }
}

void StateStore::end() {
  disk_.stop();
  end_row_of_crashes();
  last_run_.ended();
}

void StateStore::keep(Generation about, Value architecture, Json line,
                      std::function<void(bool saved)> then, As as, std::uint64_t before_stops) {
  std::error_code unknown;
  about.folder = std::filesystem::current_path(unknown).string();
  // Before the lines of refused changes, of which any user can make many.
  disk_.post_urgent([this, about = std::move(about), architecture = std::move(architecture), as,
                     before_stops, line = std::move(line), then = std::move(then)]() mutable {
    if (as == As::before) {
      about.mark = mark_before(about.number, before_stops);
    }
    bool saved = save(about, architecture) && save_cores() && stops_.write();
    if (saved && as == As::confirmed) {
      saved = mark_now(about.number, Confirmation::confirmed);
    }
    line["saved"] = saved;
    const auto its = line.find("generation");
    if (saved && its != line.end() && !generations_->find(its->get<std::uint64_t>())) {
      line["saved_as"] = about.number;
    }
    write_lines(protocol::to_line(line));
    if (then) {
      then(saved);
    }
  });
}

/// [disk] The mark of the generation before this one. A generation that mauved made by itself, and
/// that the health monitor has not saved yet, counts as unconfirmed. A stop of several stages makes
/// several generations, of which the last one only is saved.
Confirmation StateStore::mark_before(std::uint64_t generation, std::uint64_t before_stops) const {
  MAUVE_ON_THREAD(disk);
  if (generation < newest_ || (generation > newest_ + 1 && newest_ < before_stops)) {
    return Confirmation::unconfirmed;
  }
  const auto mark = generations_->mark_of(newest_).value_or(newest_mark_);
  return mark == Confirmation::confirmed ? mark : Confirmation::unconfirmed;
}

void StateStore::audit(const Json& line) {
  auto text = protocol::to_line(line);
  const MutexLock lock(mutex_);
  if (waiting_.size() >= kWaiting) {
    ++lost_;
    return;
  }
  waiting_.push_back(std::move(text));
  if (waiting_.size() == 1) {
    disk_.post([this] { write_waiting(); });
  }
}

/// All at once: a client that is refused a thousand times a second costs one write.
void StateStore::write_waiting() {
  std::vector<std::string> lines;
  std::uint64_t lost = 0;
  {
    const MutexLock lock(mutex_);
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

void StateStore::mark(std::uint64_t generation, Confirmation mark) {
  disk_.post_urgent([this, generation, mark] {
    // Another generation may have come before this one was saved.
    if (generation == newest_ || generations_->find(generation)) {
      mark_now(generation, mark);
    }
  });
}

/// [disk]
bool StateStore::mark_now(std::uint64_t generation, Confirmation mark) {
  MAUVE_ON_THREAD(disk);
  if (generation == newest_) {
    newest_mark_ = mark;
  }
  const auto marked = generations_->mark(generation, mark);
  if (!marked) {
    report(Event::generation_not_saved, marked.error());
  }
  return marked.has_value();
}

void StateStore::forget_crashes(std::uint64_t generation) {
  disk_.post_urgent([this, generation] {
    if (auto done = generations_->set_crashes(generation, 0); !done) {
      report(Event::generation_not_saved, done.error());
    }
  });
}

void StateStore::confirm_same(std::uint64_t generation, std::uint64_t other) {
  disk_.post_urgent([this, generation, other] {
    const auto one = generations_->text(generation);
    const auto two = generations_->text(other);
    if (one && two && *one == *two) {
      mark_now(generation, Confirmation::confirmed);
      mark_now(other, Confirmation::confirmed);
    }
  });
}

void StateStore::confirm_start(std::uint64_t generation, std::uint64_t replaced) {
  disk_.post_urgent([this, generation, replaced] {
    if (mark_now(generation, Confirmation::confirmed) && replaced != 0) {
      generations_->remove(replaced);
    }
  });
}

void StateStore::ran_long() {
  disk_.post_urgent([this] { last_run_.ran_long(); });
}

void StateStore::quarantine(Json cores) {
  disk_.post_urgent([this, cores = std::move(cores)] {
    unsaved_cores_ = cores;
    static_cast<void>(save_cores());
  });
}

/// [disk] The list of quarantined cores. A list that the disk did not take is written again with
/// the next change.
bool StateStore::save_cores() {
  MAUVE_ON_THREAD(disk);
  if (!unsaved_cores_) {
    return true;
  }
  const Json list = {{"cores", *unsaved_cores_}};
  const auto written = replace_file(quarantine_in(directory_), protocol::to_line(list) + "\n");
  if (!written) {
    report(Event::generation_not_saved, written.error());
    saved_ = false;
    return false;
  }
  unsaved_cores_.reset();
  return true;
}

void StateStore::read_quarantine() {
  const auto file = quarantine_in(directory_);
  std::error_code ignored;
  if (!std::filesystem::exists(std::filesystem::symlink_status(file, ignored))) {
    return;
  }
  const auto text = arch::read_file(file.string(), &plugin::Trust::of_this_process());
  auto list = text ? protocol::parse_json(*text) : Result<Json>(text.error());
  const bool whole = list && list->is_object() && list->contains("cores") &&
                     (*list)["cores"].is_array() &&
                     std::all_of((*list)["cores"].begin(), (*list)["cores"].end(),
                                 [](const Json& entry) { return entry.is_object(); });
  if (!whole) {
    const Reason damaged{Errc::invalid_value, "state_damaged"};
    return report(Event::quarantine_lost,
                  text ? refuse(damaged, file.string(), "is damaged") : text.error());
  }
  quarantined_ = std::move((*list)["cores"]);
}

void StateStore::flush() {
  std::promise<void> done;
  if (disk_.post([&done] { done.set_value(); })) {
    done.get_future().wait();
  }
}

bool StateStore::save(const Generation& about, const Value& architecture) {
  if (about.number > newest_) {
    newest_ = about.number;
    newest_mark_ = about.mark;
  }
  const auto done = generations_->save(about, arch::to_json_text(architecture) + "\n");
  saved_ = done.has_value();
  if (!done) {
    report(Event::generation_not_saved, done.error());
  }
  return done.has_value();
}

/// Two files of this size at most: the present one, and the one before it.
Status StateStore::rotate_audit() const {
  constexpr std::uintmax_t kLargest = 64 * 1024 * 1024;
  const auto file = audit_in(directory_);
  std::error_code failed;
  const auto size = std::filesystem::file_size(file, failed);
  if (failed || size < kLargest) {
    return ok();
  }
  std::filesystem::rename(file, file.string() + ".1", failed);
  return failed ? refuse({Errc::system, "state_not_written"}, file.string(),
                         "cannot be renamed: " + failed.message())
                : ok();
}

void StateStore::write_lines(const std::string& lines) {
  auto written = rotate_audit();
  if (written) {
    written = append_lines(audit_in(directory_), lines);
  }
  if (!written && !audit_broken_) {
    report(Event::audit_failed, written.error());
  }
  audit_broken_ = !written;
}

void StateStore::report(Event event, const Error& error) {
  log_.write(event, {{"text", to_string(error)}, {"file", error.at}});
}

}  // namespace mauve::daemon
