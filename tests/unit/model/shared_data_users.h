// SPDX-License-Identifier: LGPL-3.0-or-later
/// Readers and writers of a SharedData for tests.
#pragma once

#include <atomic>
#include <thread>

#include <mauve/detail/job.h>
#include <mauve/host/architecture.h>

namespace mauve {

/// The value that a new reader gets now.
inline double value_of(SharedDataBase& data) {
  double value = -1;
  Cursor cursor;
  cursor.slot = data.read_service().attach();
  static_cast<void>(data.read_service().read(&value, cursor));
  data.read_service().detach(cursor.slot);
  return value;
}

/// A writer that hangs while it holds the resource, until it is let go.
class HangingWriter {
 public:
  explicit HangingWriter(SharedDataBase& data) : thread_([this, &data] { hang(data); }) {
    while (!inside_) std::this_thread::yield();
  }
  ~HangingWriter() { let_go(); }
  HangingWriter(const HangingWriter&) = delete;
  HangingWriter& operator=(const HangingWriter&) = delete;

  void let_go() {
    leave_ = true;
    if (thread_.joinable()) thread_.join();
  }

 private:
  void hang(SharedDataBase& data) {
    auto filler = [this](void* value) {
      inside_ = true;
      while (!leave_) std::this_thread::yield();
      *static_cast<double*>(value) = 9.0;
    };
    static_cast<void>(data.write_service().fill(Filler(filler)));
  }

  std::atomic<bool> inside_{false};
  std::atomic<bool> leave_{false};
  std::thread thread_;
};

struct WriterShell : Shell {
  WritePort<double> out{*this, "out", Safe{0.5}};
};
/// A component's port that is connected to it, as used in a job of this thread.
class Writer {
 public:
  static constexpr double kSafe = 0.5;

  explicit Writer(SharedDataBase& data) {
    connected_ = shell_.out.connect(data.write_service()).has_value();
    table_ = std::move(shell_.initial_bindings());
    shell_.use(&table_);
  }
  /// False also when it is not connected.
  bool write(double value) {
    this_job().start = 1;
    const bool done = connected_ && shell_.out.write(value);
    this_job().start = 0;
    return done;
  }
  void write_safe(bool by_owner) { shell_.out.write_safe(*table_[0], by_owner); }

 private:
  WriterShell shell_;
  Bindings table_;
  bool connected_ = false;
};

}  // namespace mauve
