// SPDX-License-Identifier: LGPL-3.0-or-later
/// Ports for values: how a shell reaches services of resources (paper 3.3.2). Never an exception,
/// never a crash when nothing is connected.
#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>

#include <mauve/detail/declared.h>
#include <mauve/detail/exchange.h>
#include <mauve/detail/plausible.h>
#include <mauve/detail/port_base.h>
#include <mauve/job.h>
#include <mauve/service.h>

namespace mauve {

/// Reads the value of a connected service. `read()` by value up to 4 kB; larger data is read into
/// the caller's storage or looked at in place. Never throws. Use is [rt] by the thread of the
/// component, or under the lock of the resource, that owns the shell. The first eight readers of a
/// SharedData never wait; another read waits at most the shortest wait of its component.
/// @snippet api_examples.cpp ReadPort
template <typename T>
class ReadPort final : public PortBase {
 public:
  static constexpr std::size_t kMaxByValue = 4096;  ///< bytes

  /// A read returns `fallback` while there is no data. `Writers::one`: the value moves something,
  /// so one port at most may write into each service of the resource that it comes from.
  ReadPort(Shell& shell, std::string_view name, const T& fallback, Need need = Need::usual,
           Writers writers = Writers::many)
      : PortBase(shell, name, Signature::read<T>(), need, writers), default_(fallback) {}
  /// The same with T{} as fallback.
  ReadPort(Shell& shell, std::string_view name, Need need = Need::usual,
           Writers writers = Writers::many)
      : PortBase(shell, name, Signature::read<T>(), need, writers) {}
  /// Refuses to compile, with one sentence.
  template <typename... Wrong>
  requires(
      !detail::kDeclares<2, detail::Types<Shell&, std::string_view, T, Need, Writers>, Wrong...> &&
      !detail::kDeclares<3, detail::Types<Shell&, std::string_view, Need, Writers>,
                         Wrong...>) explicit ReadPort(Wrong&&...)
      : ReadPort(detail::none<Shell&>(), {}, detail::none<const T&>()) {
    static_assert(detail::kNever<Wrong...>,
                  "mauve: a read port is a member of a shell, declared as "
                  "`ReadPort<T> NAME{*this, \"NAME\"};` or with a default of its type, "
                  "`ReadPort<T> NAME{*this, \"NAME\", T{...}};`");
  }

  /// The value, or the default; status() distinguishes them. [rt], wait-free on a SharedData.
  [[nodiscard]] T read() {
    static_assert(sizeof(T) <= kMaxByValue, "mauve: over 4 kB: use read(into) or look()");
    T value = default_.value();
    static_cast<void>(read(value));
    return value;
  }
  /// `into` gets the value, or the default when there is none.
  DataStatus read(T& into) {
    if (!is_direct()) [[unlikely]]
      return read_by_call(into);
    const DataStatus status = aged(exchange().latest.seek(cursor_));
    status_ = status;
    if (status == DataStatus::no_data) [[unlikely]] {
      default_.put_into(into);
    } else {
      exchange().copy(into, cursor_);
    }
    return status;
  }
  /// Calls f(const T&) on the value; not at all when there is none. It is the value in place where
  /// the port has a slot of its own in a SharedData. Elsewhere the port copies it first, so that
  /// f never runs under the lock of the resource; an item of a RingBuffer is then removed.
  template <typename F>
  DataStatus look(F&& f) {
    if constexpr (sizeof(T) <= kMaxByValue) {
      std::optional<T> copy;  // made only where it is needed
      return look_by(f, copy);
    } else {
      return look_by(f, shown_);
    }
  }

  /// Of the last read.
  [[nodiscard]] DataStatus status() const { return status_; }
  /// Time between the job that wrote the value last read and this job.
  [[nodiscard]] Duration age() const { return Duration{job_time() - cursor_.stamp}; }

 private:
  [[gnu::noinline]] DataStatus read_by_call(T& into) {
    visit([&](ServiceBase& service) { return service.read(&into, cursor_); });
    if (!has_value(status_)) default_.put_into(into);
    return status_;
  }
  template <typename Ask>
  DataStatus visit(const Ask& ask) {
    const TracedCall call = call_begins();
    const Binding* connection = binding();
    status_ = connection == nullptr ? DataStatus::no_data : ask(connection->service());
    if (status_ == DataStatus::timed_out || status_ == DataStatus::poisoned) count_failure();
    return call.ended(status_ = aged(status_));
  }
  template <typename F, typename Copy>
  DataStatus look_by(F& f, Copy& copy) {
    bool copied = false;
    auto show = [&f](const void* data) { f(*static_cast<const T*>(data)); };
    auto take = [&copy](const void* data) {
      const T& value = *static_cast<const T*>(data);
      if constexpr (std::is_same_v<Copy, std::optional<T>>) {
        copy.emplace(value);
      } else {
        *copy = value;
      }
    };
    const DataStatus status = visit([&](ServiceBase& service) {
      copied = service.exchange() == nullptr || cursor_.slot == LatestValue::kNoSlot;
      return service.look(copied ? Visitor(take) : Visitor(show), cursor_);
    });
    if (copied && mauve::has_value(status)) f(std::as_const(*copy));
    return status;
  }
  DataStatus aged(DataStatus status) {
    if (max_age() == Duration{0} || !mauve::has_value(status)) [[likely]]
      return status;
    return age() > max_age() ? DataStatus::stale : status;
  }

  detail::PortDefault<T, (sizeof(T) > kMaxByValue)> default_;
  /// The copy for look(), of a type that is too large for the stack.
  std::unique_ptr<T> shown_ = sizeof(T) > kMaxByValue ? std::make_unique<T>() : nullptr;
  DataStatus status_ = DataStatus::no_data;
};

/// The value to write when the component stops or faults, or the port is disconnected.
template <typename T>
struct Safe {
  T value;  ///< written in place of the values of the core
};
template <typename T>
Safe(T) -> Safe<T>;  ///< from its value

/// Writes values to a connected service. A value without a connection is counted and dropped. So is
/// a value that is not plausible: a core on probation is then rolled back, and of any other the log
/// says it. Never throws. Use is [rt] by the thread of the component. The first writer of a
/// SharedData never waits.
/// @snippet api_examples.cpp WritePort
template <typename T>
class WritePort final : public PortBase {
 public:
  /// Without a safe value: the last value stays when the component stops.
  WritePort(Shell& shell, std::string_view name, Need need = Need::usual)
      : PortBase(shell, name, Signature::write<T>(), need) {}
  /// With a safe value.
  WritePort(Shell& shell, std::string_view name, Safe<T> safe, Need need = Need::usual)
      : PortBase(shell, name, Signature::write<T>(), need), safe_(std::move(safe.value)) {}
  /// With a safe value, and a check of each value before it goes out.
  WritePort(Shell& shell, std::string_view name, Safe<T> safe, Plausible<T> plausible,
            Need need = Need::usual)
      : PortBase(shell, name, Signature::write<T>(), need),
        safe_(std::move(safe.value)),
        plausible_(std::move(plausible)) {
    always_call();
  }
  /// Refuses to compile, with one sentence.
  template <typename... Wrong>
  requires(
      !detail::kDeclares<2, detail::Types<Shell&, std::string_view, Need>, Wrong...> &&
      !detail::kDeclares<3, detail::Types<Shell&, std::string_view, Safe<T>, Need>, Wrong...> &&
      !detail::kDeclares<4, detail::Types<Shell&, std::string_view, Safe<T>, Plausible<T>, Need>,
                         Wrong...>) explicit WritePort(Wrong&&...)
      : WritePort(detail::none<Shell&>(), {}) {
    static_assert(detail::kNever<Wrong...>,
                  "mauve: a write port is a member of a shell, declared as "
                  "`WritePort<T> NAME{*this, \"NAME\"};` or with a safe value of its type, "
                  "`WritePort<T> NAME{*this, \"NAME\", mauve::Safe{T{...}}};`");
  }

  /// False: the value was not delivered.
  bool write(const T& value) {
    const Instant stamp = this_job().start;
    if (!is_direct() || stamp == 0) [[unlikely]]
      return write_otherwise(value);
    Exchange& into = exchange();
    if (!into.write_as_expected(&value, into.bytes_of<T>(), stamp)) [[unlikely]]
      return write_otherwise(value);
    return into.taps.empty() || notify_taps(&value);
  }
  /// Calls f(T&) on the storage of the exchange, which holds an older value, then publishes the
  /// result without the check of Plausible.
  template <typename F>
  bool fill(F&& f) {
    const TracedCall call = call_begins();
    const Binding* connection = binding();
    auto into = [&f](void* data) { f(*static_cast<T*>(data)); };
    return call.ended(counted(connection != nullptr && connection->service().fill(Filler(into))));
  }

  /// Runtime only: see PortBase.
  void write_safe(const Binding& connection, bool by_owner) const override {
    if (!safe_) return;
    by_owner ? connection.write(&*safe_) : connection.service().write(&*safe_);
  }
  /// It was declared with Safe.
  [[nodiscard]] bool has_safe_value() const override { return safe_.has_value(); }

 private:
  [[gnu::noinline]] bool write_otherwise(const T& value) {
    const Instant stamp = this_job().start;
    if (!is_direct() || stamp == 0) return write_by_call(value);
    Exchange& into = exchange();
    if (!into.write_alone(&value, into.bytes_of<T>(), stamp)) return write_by_call(value);
    return into.taps.empty() || notify_taps(&value);
  }
  bool write_by_call(const T& value) {
    const TracedCall call = call_begins();
    const Binding* connection = binding();
    const bool may = connection != nullptr && lets_out(value);
    return call.ended(counted(may && connection->write(&value)));
  }
  bool counted(bool done) {
    if (!done) count_failure();
    return done;
  }
  bool lets_out(const T& value) {
    if (!plausible_) return true;
    const bool accepted = (*plausible_)(value, last_ ? *last_ : value);
    Job& job = this_job();
    if (job.has_no_ports()) return false;  // abandoned in there
    if (!accepted) {
      count_implausible();
      if (job.implausible == nullptr) job.implausible = this;
      return false;
    }
    last_ = value;
    return true;
  }

  std::optional<T> safe_;
  std::optional<Plausible<T>> plausible_;
  std::optional<T> last_;
};

}  // namespace mauve
