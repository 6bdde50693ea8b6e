// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kinds that play recordings of `mauvectl record`, one for each described type: also for
/// a type of yours, in a plugin that links mauve::playback. The file is read when the core is
/// configured; playing does no I/O.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <mauve/job.h>
#include <mauve/plugin.h>

#include "../../navigation/regular_file.h"
#include "../../types/gnss.h"
#include "csv_recording.h"

namespace drivers {

/// The place in the recording, which survives a change of the core.
struct PlaybackPosition {
  std::uint64_t next = 0;  ///< row
  std::int64_t at = 0;     ///< ns, on the clock of the recording
  std::int64_t last = 0;   ///< monotonic, of the last job; 0: none yet

  static constexpr std::string_view type_name = "playback_position/1";
  static constexpr auto fields() {
    return std::tuple{mauve::field("next", &PlaybackPosition::next),
                      mauve::field("at", &PlaybackPosition::at, "ns"),
                      mauve::field("last", &PlaybackPosition::last, "ns")};
  }
};

template <typename T>
struct PlaybackShell : mauve::Shell {
  mauve::WritePort<T> out{*this, "out"};
};

/// A value has a stamp of the monotonic clock. The time of a GNSS fix is that of its receiver.
template <typename T>
concept Stamped = requires(T value) {
  { value.time } -> std::same_as<double&>;
}
&&!std::is_same_v<T, rover::GnssFix>;

/// [rt] A value is written by the first job at or after its time. The clock of the recording begins
/// with the earliest row of the file and ends with its latest one, whatever address they are of. So
/// players of one file that start together stay in step.
template <typename T>
class Playback final : public mauve::Core<PlaybackShell<T>> {
 public:
  void update() {
    advance();
    for (std::size_t i = 0; i < kMostAtOnce; ++i) {
      if (state->next >= values_.size() && repeat && is_over()) begin_again();
      const bool all_played = state->next >= values_.size();
      finished = all_played && !repeat;
      if (all_played || (speed > 0.0 && times_[state->next] > state->at)) return;
      write(state->next++);
      if (speed == 0.0) return;
    }
  }

 private:
  /// So many values at most are written by one job; the next job goes on.
  static constexpr std::size_t kMostAtOnce = 16;
  static constexpr std::size_t kLongest = 64UL * 1024UL * 1024UL;

  mauve::State<PlaybackPosition> state{*this};
  mauve::Property<std::string> recording{
      *this, "recording", "", "path of the CSV file", {.within = "./"}};
  mauve::Property<std::string> address{*this, "address", "",
                                       "recorded address; may be empty when the file has one"};
  mauve::Property<double> speed{*this,
                                "speed",
                                1.0,
                                "of the clock of the recording; 0: one value each job",
                                {.min = 0.0, .max = 1000.0}};
  mauve::Property<bool> repeat{*this, "repeat", false, "begin again at the end"};
  mauve::Property<bool> restamp{*this, "restamp", true,
                                "move the times in the values to this run; false: as recorded"};
  mauve::Observable<std::uint64_t> played{*this, "played", 0, "values written"};
  mauve::Observable<bool> finished{*this, "finished", false, "nothing more to come"};

  void advance() {
    const mauve::Instant now = mauve::job_time();
    if (state->last == 0) {
      state->at = first_;
    } else {
      const auto passed = static_cast<double>(now - state->last);
      state->at += speed == 1.0 ? now - state->last : std::llround(passed * speed);
    }
    state->last = now;
  }

  [[nodiscard]] bool is_over() const { return speed == 0.0 || state->at >= last_; }

  /// The time that has passed beyond the end counts: no player waits for its own job.
  void begin_again() {
    state->next = 0;
    state->at = speed == 0.0 ? first_ : state->at - (last_ - first_);
  }

  void write(std::size_t row) {
    T value = values_[row];
    if constexpr (Stamped<T>) {
      // As old when it is written as it was in the recording; 0 means "now" there and here.
      if (restamp && value.time != 0.0) {
        const double age = mauve::to_seconds(times_[row]) + offset_ - value.time;
        value.time = mauve::to_seconds(mauve::job_time()) - age;
      }
    }
    this->shell().out.write(value);
    ++played;
  }

  mauve::Status on_configure() override {
    if (recording.get().empty()) return mauve::invalid(recording, "says no file");
    const auto text = navigation::read_regular_file(recording, kLongest, "recording");
    if (!text) return text.error();
    const auto& type = mauve::data_type<T>();
    auto file = read_csv(*text, type, address, recording);
    if (!file) return file.error();
    first_ = file->first;
    last_ = file->last;
    for (const CsvRow& row : file->rows) {
      values_.emplace_back();
      if (mauve::Status done = type.from_value(row.value, &values_.back()); !done) {
        return mauve::refuse(done.error().code, {},
                             recording.get() + ":" + std::to_string(row.line) + ": " +
                                 done.error().at + ": " + done.error().message,
                             "the file was recorded of another type or revision");
      }
      times_.push_back(row.time);
    }
    if constexpr (Stamped<T>) {
      for (std::size_t i = 0; i < values_.size() && offset_ == 0.0; ++i) {
        if (values_[i].time != 0.0) offset_ = values_[i].time - mauve::to_seconds(times_[i]);
      }
    }
    return mauve::ok();
  }
  void on_cleanup() override {
    values_.clear();
    times_.clear();
    offset_ = 0.0;
  }

  std::vector<T> values_;
  std::vector<std::int64_t> times_;
  std::int64_t first_ = 0;  // ns, of the file
  std::int64_t last_ = 0;
  double offset_ = 0.0;  // s, of the stamps in the values from the times of the rows
};

/// The component kind `name` of a plugin: a Playback of T, each period.
template <typename T>
void declare_playback_of(mauve::Plugin& plugin, const char* name) {
  plugin.component<PlaybackShell<T>, Playback<T>, mauve::PeriodicFsm<Playback<T>>>(name);
}

}  // namespace drivers
