// SPDX-License-Identifier: LGPL-3.0-or-later
#include "keeper.h"

#include <filesystem>
#include <future>
#include <utility>

#include "arch/value_json.h"
#include "durable.h"

namespace mauve::daemon {

namespace {

using logging::Event;

std::filesystem::path marker_in(const std::string& directory) {
  return std::filesystem::path(directory) / "running";
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
  // Before the lines of refused changes, of which anybody can make many.
  disk_.post_urgent([this, about = std::move(about), architecture = std::move(architecture),
                     line = std::move(line), then = std::move(then)]() mutable {
    const bool saved = save(about, architecture);
    line["saved"] = saved;
    write_line(line);
    if (then) {
      then(saved);
    }
  });
}

void Keeper::audit(Json line) {
  if (waiting_ >= kWaiting) {
    ++lost_;
    return;
  }
  ++waiting_;
  disk_.post([this, line = std::move(line)] {
    --waiting_;
    write_line(line);
    if (const auto lost = lost_.exchange(0); lost > 0) {
      write_line({{"time", line.value("time", "")}, {"lost", lost}});
      log_.write(Event::events_lost,
                 {{"count", static_cast<std::int64_t>(lost)}, {"source", "the audit log"}});
    }
  });
}

void Keeper::mark(std::uint64_t generation, Mark mark) {
  disk_.post_urgent([this, generation, mark] {
    if (auto marked = generations_->mark(generation, mark); !marked) {
      report(Event::generation_not_saved, marked.error());
    }
  });
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

void Keeper::write_line(const Json& line) {
  const auto written = append_line(audit_in(directory_), protocol::to_line(line));
  if (!written && !audit_broken_) {
    report(Event::audit_failed, written.error());
  }
  audit_broken_ = !written;
}

void Keeper::report(Event event, const Error& error) {
  log_.write(event, {{"text", to_string(error)}, {"file", error.at}});
}

}  // namespace mauve::daemon
