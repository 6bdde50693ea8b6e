// SPDX-License-Identifier: LGPL-3.0-or-later
/// The ways to move a value of one size from one component to another, ours and raw ones, and how
/// long each takes at full rate.
#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <functional>
#include <new>
#include <vector>

#include "bench/support/checked.h"
#include "bench/support/machine.h"
#include "bench/support/raw.h"

#include <mauve/detail/job.h>
#include <mauve/host/architecture.h>

namespace bench {

template <std::size_t Size>
struct Block {
  std::array<std::byte, Size> bytes{};
};

template <typename T>
struct alignas(128) ReaderShell : mauve::Shell {
  mauve::ReadPort<T> in{*this, "in"};
};
template <typename T>
struct alignas(128) WriterShell : mauve::Shell {
  mauve::WritePort<T> out{*this, "out"};
};
template <typename ShellT>
struct Idle : mauve::Core<ShellT> {
  mauve::Stateless stateless{*this};
  void update() {}
};
template <typename ShellT>
using IdleComponent = mauve::Component<ShellT, Idle<ShellT>, mauve::PeriodicFsm<Idle<ShellT>>>;
/// Two components: what is used on two CPUs lies apart.
template <typename T>
struct Wired : mauve::Architecture {
  mauve::SharedData<T> data{*this, "data", T{}};
  IdleComponent<ReaderShell<T>> reader{*this, "reader"};
  IdleComponent<WriterShell<T>> writer{*this, "writer"};
  mauve::Status on_configure() override {
    if (auto done = reader.shell().in.connect(data.read_service()); !done) return done;
    return writer.shell().out.connect(data.write_service());
  }
};

/// Keeps the compiler from leaving copies out.
inline void touch(void* data) { asm volatile("" : : "r"(data) : "memory"); }

/// A job of this thread, so that values are stamped as in one.
class InJob {
 public:
  InJob() { mauve::this_job().start = now(); }
  ~InJob() { mauve::this_job().start = 0; }
};

using Operation = std::function<void(int times)>;

/// The ways to move a value of one size; each operation does it many times.
template <std::size_t Size>
struct Contenders {
  using T = Block<Size>;

  Contenders() { must(wired.configure()); }
  template <typename Body>
  Operation repeat(Body body) {
    return [body](int times) {
      const InJob job;
      for (int i = 0; i < times; ++i) body();
    };
  }
  Operation write() {
    auto& port = wired.writer.shell().out;
    return repeat([this, &port] { touch(&from), port.write(from); });
  }
  Operation read() {
    auto& port = wired.reader.shell().in;
    return repeat([this, &port] { port.read(into), touch(&into); });
  }
  Operation copy() {
    return repeat([&] {
      touch(&from);
      std::memcpy(&other, &from, size);
      touch(&other);
    });
  }
  Operation locked_write() {
    return repeat([&] { touch(&from), locked.write(&from); });
  }
  Operation locked_read() {
    return repeat([&] { locked.read(&into), touch(&into); });
  }
  Operation triple_write() {
    return repeat([&] { touch(&from), triple.write(&from); });
  }
  Operation triple_read() {
    return repeat([&] { triple.read(&into), touch(&into); });
  }

  volatile std::size_t size = Size;  // as the runtime, the copy does not know it
  Wired<T> wired;
  RawPiMutex locked{Size};
  RawTripleBuffer triple{Size};
  alignas(64) T from{};
  alignas(64) T into{};
  alignas(64) T other{};
};

/// A value at another place of its page in each round. A copy is slower where its source and its
/// destination lie nearly a multiple of 4 kB apart, so one place alone says little.
template <typename T>
class Placed {
 public:
  explicit Placed(int round) : value_(new (memory_ + kStep * (7 * round % kPlaces)) T) {}
  ~Placed() { value_->~T(); }
  Placed(const Placed&) = delete;
  Placed& operator=(const Placed&) = delete;
  [[nodiscard]] T& value() { return *value_; }

 private:
  static constexpr int kStep = 128;
  static constexpr int kPlaces = 4096 / kStep;

  alignas(4096) std::byte memory_[sizeof(T) + 4096];
  T* value_;
};

/// Nanoseconds for each operation alone on a CPU: medians of batches in turn. One during which
/// another machine used the same core is made again.
[[nodiscard]] std::vector<double> alone(const std::vector<Operation>& operations, int times,
                                        int batches);

/// Nanoseconds for each of two operations that run at the same time on two CPUs. They are medians
/// of batches, since one operation is alone while the host delays the other.
[[nodiscard]] std::array<double, 2> together(const Operation& first, const Operation& second,
                                             int times);

}  // namespace bench
