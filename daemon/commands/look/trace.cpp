// SPDX-License-Identifier: LGPL-3.0-or-later
/// trace.*: the actions of every thread with their times, while it is on; and the flight
/// recordings.
#include <chrono>
#include <memory>
#include <optional>
#include <utility>

#include "commands/answer.h"

#include "base/thread_role.h"
#include "commands/recovery/abandoned.h"
#include "protocol/trace.h"
#include "trace/file.h"
#include "trace/recorder.h"

namespace mauve::daemon {

namespace {

using Snapshot = std::pair<std::string, RecordingPtr>;

/// [control] A new snapshot of the trace when `name` is empty, else the snapshot of this name.
Result<Snapshot> snapshot_of(Running& running, const std::string& name, bool now) {
  MAUVE_ON_THREAD(control);
  if (name.empty()) {
    return running.recorder->snapshot(now);
  }
  auto recording = running.recorder->find_snapshot(name);
  if (recording == nullptr) {
    return refuse({Errc::unknown_name, "unknown_recording"}, name,
                  "there is no flight recording of this name (a snapshot of this name is gone when "
                  "others were read meanwhile)",
                  "mauvectl trace list; without a name the trace of now is read");
  }
  return Snapshot(name, std::move(recording));
}

/// On [factory], since it waits for the disk.
void read_flight(Running& running, const CallPtr& call, const std::string& name, std::size_t from,
                 std::size_t count) {
  const auto* flights = running.recorder->flights();
  const auto file = flights == nullptr ? refuse({Errc::unknown_name, "unknown_recording"},
                                                name.substr(0, 64), "nothing is recorded")
                                       : flights->find(name);
  if (!file) {
    return answer(running, *call, file.error());
  }
  auto page = std::make_shared<std::optional<Result<Json>>>();
  running.control.in_factory(
      [page, file = *file, from, count] { *page = page_of(file, from, count); },
      [&running, call, page, name] {
        if (**page) {
          (***page)["recording"] = name;
        }
        answer(running, *call, std::move(**page));
      },
      [&running, call](const std::string& hook) {
        answer(running, *call, thread_abandoned(running, hook, "trace.read"));
      },
      asker_of(*call));
}

}  // namespace

Result<Json> start_trace(Running& running, const Call& call) {
  const std::chrono::seconds kept(number_or(call.params, "seconds", Recorder::kKept.count()));
  if (auto begun = running.recorder->begin(flag(call.params, "detail"), kept); !begun) {
    return begun.error();
  }
  return running.recorder->status();
}

Result<Json> stop_trace(Running& running, const Call& /*call*/) {
  if (auto ended = running.recorder->end(); !ended) {
    return ended.error();
  }
  return running.recorder->status();
}

Result<Json> trace_status(Running& running, const Call& /*call*/) {
  return running.recorder->status();
}

Result<Json> list_recordings(Running& running, const Call& /*call*/) {
  Json items = Json::array();
  if (const auto* flights = running.recorder->flights()) {
    for (const auto& one : flights->list()) {
      items.push_back(
          {{"name", one.name}, {"why", one.why}, {"when", one.time}, {"records", one.records}});
    }
  }
  return Json{{"items", std::move(items)}};
}

void read_trace(Running& running, const CallPtr& call, Ticket /*none*/) {
  const auto name = text_or(call->params, "recording");
  const auto from = number_or(call->params, "from", 0);
  const auto count = number_or(call->params, "count", protocol::kMostRecords);
  if (name.starts_with("flight-")) {
    return read_flight(running, call, name, from, count);
  }
  if (auto room = check_long_answers(running, *call); !room) {
    return answer(running, *call, room.error());
  }
  auto snapshot = snapshot_of(running, name, flag(call->params, "now"));
  if (!snapshot) {
    return answer(running, *call, snapshot.error());
  }
  running.control.write_out(
      [&running, call, snapshot = *std::move(snapshot), from, count] {
        const auto& [its_name, recording] = snapshot;
        Json page = page_of(*recording, from, count);
        page["recording"] = its_name;
        page["header"] = header_of(*recording, running.boot);
        answer(running, *call, std::move(page));
      },
      asker_of(*call));
}

}  // namespace mauve::daemon
