// SPDX-License-Identifier: LGPL-3.0-or-later
/// The members that all ports share.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include <mauve/detail/binding.h>
#include <mauve/detail/data_status.h>
#include <mauve/detail/job.h>
#include <mauve/detail/signature.h>
#include <mauve/result.h>
#include <mauve/trace.h>

namespace mauve {

struct Exchange;
class ServiceBase;
class Shell;

/// How important a connection is. `mauved --check`, a start, `status` and the answer of a change
/// name a port without one, if it is a read port or has a safe value, unless it is optional.
enum class Need : std::uint8_t {
  usual,     ///< a read port, or one with a safe value, is named when it is left open
  optional,  ///< may be left open
  required,  ///< a port of any kind is named when it is left open
};

/// How many values of a port were not plausible, so that the port did not let them out.
struct ImplausibleCount {
  std::uint64_t ever = 0;     ///< since the port exists
  std::uint64_t of_core = 0;  ///< of these: since its component runs the code of its present core
};

/// The result of PortBase::connect(). When the caller does not examine an error, the next
/// configure() of the shell reports it, as it reports a refused value of a property.
class Connected {
 public:
  /// Of a port of this shell.
  Connected(Shell& shell, Status done) : shell_(shell), done_(std::move(done)) {}
  Connected(const Connected&) = delete;
  Connected& operator=(const Connected&) = delete;
  ~Connected();

  explicit operator bool() const { return examine().has_value(); }        ///< success
  [[nodiscard]] bool has_value() const { return examine().has_value(); }  ///< success
  operator Status() const { return examine(); }                           ///< for a return
  [[nodiscard]] const Error& error() const { return examine().error(); }  ///< only after a refusal

 private:
  const Status& examine() const {
    examined_ = true;
    return done_;
  }

  Shell& shell_;
  Status done_;
  mutable bool examined_ = false;
};

/// The base class of ports, through which the runtime uses them. Use is [rt] by the component's own
/// thread.
class PortBase {
 public:
  /// Registers itself with the shell.
  PortBase(Shell& shell, std::string_view name, Signature signature, Need need = Need::usual,
           Writers writers = Writers::many);
  PortBase(const PortBase&) = delete;
  PortBase& operator=(const PortBase&) = delete;
  virtual ~PortBase() = default;

  [[nodiscard]] std::string_view name() const { return name_; }  ///< of the member
  /// kind and type, compared at connect
  [[nodiscard]] const Signature& signature() const { return signature_; }
  [[nodiscard]] std::size_t index() const { return index_; }  ///< in the order of declaration
  /// Dotted address, such as "control.ports.scan".
  [[nodiscard]] std::string address() const;

  /// Connects in code, before deployment: `shell().scan.connect(scan.interface().read)`. The caller
  /// may ignore the result: configure() of the shell then reports the error.
  Connected connect(ServiceBase& service, Duration max_age = Duration{0});
  [[nodiscard]] bool connected() const;              ///< to a service
  [[nodiscard]] Need need() const { return need_; }  ///< as declared
  /// Of a read port: how many ports may write the value that it reads.
  [[nodiscard]] Writers writers() const { return writers_; }

  /// Writes the declared safe value, if any: at stop, fault and disconnect. `by_owner`: on the
  /// thread of its component, or of its replacement. [any]
  virtual void write_safe(const Binding& /*connection*/, bool /*by_owner*/) const {}
  /// It was declared with Safe.
  [[nodiscard]] virtual bool has_safe_value() const { return false; }
  /// Accesses without effect: no connection, a resource that was busy for longer than the bound or
  /// is poisoned, a value that is not plausible. [any]
  [[nodiscard]] std::uint64_t failures() const { return failures_.load(std::memory_order_relaxed); }
  /// Of the failures: values that were not plausible. [any]
  [[nodiscard]] ImplausibleCount implausible() const {
    const std::uint64_t before = implausible_before_.load(std::memory_order_acquire);
    const std::uint64_t ever = implausible_.load(std::memory_order_relaxed);
    return {ever, ever - before};
  }
  /// Runtime only: another core writes from now on. [rt]
  void begin_another_core() {
    implausible_before_.store(implausible_.load(std::memory_order_relaxed),
                              std::memory_order_release);
  }
  /// Runtime only: the name of the port in a trace, "control.scan". Off the real-time threads.
  void name_in_trace(std::string_view name) { trace_name_ = trace_name_id(name); }

 protected:
  /// The connection in force, or null. Resets the cursor when the connection has changed. [rt]
  [[nodiscard]] const Binding* binding();
  /// Whether exchange() can read or write the value without a call. It can at a port that is
  /// connected as at the last use, to a SharedData in which this port has a slot of its own, with
  /// nothing to trace. [rt]
  [[nodiscard, gnu::always_inline]] bool is_direct() const {
    // An abandoned thread must not touch the port: its replacement owns it.
    if (this_job().has_no_ports()) [[unlikely]]
      return false;
    return !detail::traces(TraceMode::detail) && version_ == direct_version_;
  }
  [[nodiscard]] Exchange& exchange() const { return *exchange_; }  ///< only when is_direct()
  /// Taps that were attached while a value was written directly get it; true. [rt]
  bool notify_taps(const void* value);
  /// Each use takes more than exchange(): is_direct() is always false.
  void always_call() { calls_ = true; }
  /// How old a value may be; zero: no limit.
  [[nodiscard]] Duration max_age() const { return max_age_; }
  void count_failure() { failures_.fetch_add(1, std::memory_order_relaxed); }  ///< see failures()
  void count_implausible() { implausible_.fetch_add(1, std::memory_order_relaxed); }  ///< too
  /// The trace record of one use.
  [[nodiscard]] TracedCall call_begins() const { return TracedCall(trace_name_); }
  Cursor cursor_;  ///< its place in the values of the service

 private:
  const std::uint64_t& version_;      // of the connections of the shell
  std::uint64_t direct_version_ = 0;  // at the last use; 0: do not use exchange()
  Exchange* exchange_ = nullptr;      // of the connection then
  Duration max_age_{0};               // too
  std::uint64_t seen_ = 0;            // id of the connection that the cursor belongs to
  bool calls_ = false;
  Need need_;
  Writers writers_;
  std::size_t index_;
  std::atomic<std::uint64_t> failures_{0};
  std::atomic<std::uint64_t> implausible_{0};
  std::atomic<std::uint64_t> implausible_before_{0};  // of cores before the present one
  std::uint32_t trace_name_ = 0;
  Shell& shell_;
  std::string_view name_;
  Signature signature_;
};

namespace detail {

/// A value of T, for a read without data.
template <typename T, bool kIsLarge>
class PortDefault {
 public:
  PortDefault() = default;
  explicit PortDefault(const T& value) : value_(value) {}

  [[nodiscard]] const T& value() const { return value_; }
  void put_into(T& into) const { into = value_; }

 private:
  T value_{};
};

/// Of a type that is too large for the stack. T{} takes no memory, and is made in its place.
template <typename T>
class PortDefault<T, true> {
 public:
  PortDefault() = default;
  explicit PortDefault(const T& value) : value_(std::make_unique<const T>(value)) {}

  void put_into(T& into) const {
    if (value_ != nullptr) {
      into = *value_;
    } else {
      std::construct_at(&into);
    }
  }

 private:
  std::unique_ptr<const T> value_;  // null: T{}
};

}  // namespace detail
}  // namespace mauve
