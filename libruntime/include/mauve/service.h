// SPDX-License-Identifier: LGPL-3.0-or-later
/// Services: the functions that a resource offers to ports (paper 3.5). Four kinds, like ports.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include <mauve/detail/data_status.h>
#include <mauve/detail/declared_service.h>
#include <mauve/detail/method.h>
#include <mauve/detail/resource_lock.h>
#include <mauve/detail/signature.h>
#include <mauve/detail/visitor.h>
#include <mauve/job.h>

namespace mauve {

class CoreBase;
class InterfaceBase;
class ResourceBase;
struct Exchange;
class TapList;
template <typename CoreT>
class Interface;

/// The base class of services, through which ports use them. Data moves through untyped pointers;
/// connect() has compared the signatures, so the casts are safe. Calls are [any] but not from
/// inside the same resource.
class ServiceBase {
 public:
  /// Registers itself with the interface.
  ServiceBase(InterfaceBase& owner, std::string_view name, Signature signature,
              Writers writers = Writers::many);
  ServiceBase(const ServiceBase&) = delete;
  ServiceBase& operator=(const ServiceBase&) = delete;
  virtual ~ServiceBase() = default;

  [[nodiscard]] std::string_view name() const { return name_; }  ///< of the member
  /// Kind and types, compared at connect.
  [[nodiscard]] const Signature& signature() const { return signature_; }
  [[nodiscard]] Writers writers() const { return writers_; }  ///< how many ports may write
  [[nodiscard]] ResourceBase& resource() const;               ///< that it belongs to
  /// Dotted address, such as "scan.read".
  [[nodiscard]] std::string address() const;

  /// Called at connect and disconnect: a reader may get a private slot. [control]
  virtual unsigned attach() { return 0; }
  virtual void detach(unsigned /*slot*/) {}  ///< gives the slot back

  /// Copies the value into `into`; leaves it alone when there is none.
  virtual DataStatus read(void* /*into*/, Cursor& /*cursor*/) { return DataStatus::no_data; }
  /// Shows the value in place for the time of the call.
  virtual DataStatus look(Visitor /*visitor*/, Cursor& /*cursor*/) { return DataStatus::no_data; }
  /// False: not written because the lock was not to be had in time.
  virtual bool write(const void* /*data*/) { return false; }
  /// Lets the writer fill the value in place.
  virtual bool fill(Filler /*filler*/) { return false; }
  /// The taps that get each value written; null for services that compute their value.
  [[nodiscard]] virtual TapList* taps() { return nullptr; }
  /// Where its values lie, the same as long as it lives, for ports that use them without a call;
  /// null: they call.
  [[nodiscard]] virtual Exchange* exchange() { return nullptr; }
  /// Calls or fires; `result` may be null for void.
  virtual bool invoke(void* /*result*/, void* const* /*arguments*/) { return false; }

 protected:
  [[nodiscard]] InterfaceBase& owner() const { return owner_; }  ///< whose member it is
  [[nodiscard]] CoreBase& core() const;                          ///< that serves callers now
  [[nodiscard]] ResourceLock& lock() const;                      ///< of the resource

 private:
  InterfaceBase& owner_;
  std::string_view name_;
  Signature signature_;
  Writers writers_;
};

/// A value that a method of the core computes at each read, on the thread of the reader and under
/// the resource lock. The method may return std::optional<T>: empty means no data.
/// @snippet api_examples.cpp ReadService
template <typename T>
class ReadService final : public ServiceBase {
 public:
  /// `method` always has a value.
  template <typename C>
  ReadService(Interface<C>& owner, std::string_view name, std::type_identity_t<T (C::*)()> method)
      : ServiceBase(owner, name, Signature::read<T>()), always_(Method<T()>(method)) {}
  /// `method` may have no value: no_data.
  template <typename C>
  ReadService(Interface<C>& owner, std::string_view name,
              std::type_identity_t<std::optional<T> (C::*)()> method)
      : ServiceBase(owner, name, Signature::read<T>()),
        maybe_(Method<std::optional<T>()>(method)) {}
  /// Refuses to compile, with one sentence.
  template <typename... Wrong>
  requires(!detail::kServes<void(T (*)(), std::optional<T> (*)()), Wrong...>) explicit ReadService(
      Wrong&&...)
      : ServiceBase(detail::wrong_service<Wrong...>(), {}, {}) {}

  DataStatus read(void* into, Cursor& cursor) override {
    ScopedLock held(lock());
    if (!held) return held.refusal();
    cursor.stamp = job_time();
    if (always_) {
      *static_cast<T*>(into) = (*always_)(core());
      return DataStatus::new_data;
    }
    std::optional<T> value = (*maybe_)(core());
    if (!value) return DataStatus::no_data;
    *static_cast<T*>(into) = *std::move(value);
    return DataStatus::new_data;
  }
  DataStatus look(Visitor visitor, Cursor& cursor) override {
    T value{};
    const DataStatus status = read(&value, cursor);
    if (has_value(status)) visitor(&value);
    return status;
  }

 private:
  std::optional<Method<T()>> always_;
  std::optional<Method<std::optional<T>()>> maybe_;
};

/// A method of the core that takes each value written, on the thread of the writer and under the
/// resource lock. One that moves something: `{*this, "drive", &Motor::drive, mauve::Writers::one}`.
/// @snippet api_examples.cpp WriteService
template <typename T>
class WriteService final : public ServiceBase {
 public:
  /// `method` gets each value that is written.
  template <typename C>
  WriteService(Interface<C>& owner, std::string_view name,
               std::type_identity_t<void (C::*)(const T&)> method, Writers writers = Writers::many)
      : ServiceBase(owner, name, Signature::write<T>(), writers), method_(method) {}
  /// Refuses to compile, with one sentence.
  template <typename... Wrong>
  requires(!detail::kServes<void(void (*)(const T&)), Wrong...>) explicit WriteService(Wrong&&...)
      : ServiceBase(detail::wrong_service<Wrong...>(), {}, {}),
        method_(detail::none<Method<void(const T&)>>()) {}

  bool write(const void* data) override {
    ScopedLock held(lock());
    if (!held) return false;
    method_(core(), *static_cast<const T*>(data));
    return true;
  }
  bool fill(Filler filler) override {
    T value{};
    filler(&value);
    return write(&value);
  }

 private:
  Method<void(const T&)> method_;
};

/// Of a signature `R(P...)`, see its specialization.
template <typename Signature>
class CallService {
  static_assert(detail::kNever<Signature>,
                "mauve: a call service has a signature such as `CallService<double(int)>`");

 public:
  /// Accepts any arguments, so that the sentence above is the only error.
  template <typename... A>
  explicit CallService(A&&...) {}
};

/// A method of the core with arguments and an answer, on the thread of the caller and under the
/// resource lock.
/// @snippet api_examples.cpp CallService
template <typename R, typename... P>
class CallService<R(P...)> final : public ServiceBase {
 public:
  /// `method` answers each call.
  template <typename C>
  CallService(Interface<C>& owner, std::string_view name,
              std::type_identity_t<R (C::*)(P...)> method, Writers writers = Writers::many)
      : ServiceBase(owner, name, Signature::call<R, P...>(), writers), method_(method) {}
  /// Refuses to compile, with one sentence.
  template <typename... Wrong>
  requires(!detail::kServes<void(R (*)(P...)), Wrong...>) explicit CallService(Wrong&&...)
      : ServiceBase(detail::wrong_service<Wrong...>(), {}, {}),
        method_(detail::none<Method<R(P...)>>()) {}

  bool invoke(void* result, void* const* arguments) override {
    return invoke(result, arguments, std::index_sequence_for<P...>{});
  }

 private:
  template <std::size_t... I>
  bool invoke([[maybe_unused]] void* result, [[maybe_unused]] void* const* arguments,
              std::index_sequence<I...>) {
    ScopedLock held(lock());
    if (!held) return false;
    if constexpr (std::is_void_v<R>) {
      method_(core(), *static_cast<std::remove_cvref_t<P>*>(arguments[I])...);
    } else {
      *static_cast<R*>(result) =
          method_(core(), *static_cast<std::remove_cvref_t<P>*>(arguments[I])...);
    }
    return true;
  }

  Method<R(P...)> method_;
};

/// A method of the core without an answer, on the thread of the caller and under the resource lock.
/// @snippet api_examples.cpp EventService
template <typename... P>
class EventService final : public ServiceBase {
 public:
  /// `method` runs at each event.
  template <typename C>
  EventService(Interface<C>& owner, std::string_view name,
               std::type_identity_t<void (C::*)(P...)> method)
      : ServiceBase(owner, name, Signature::event<P...>()), method_(method) {}
  /// Refuses to compile, with one sentence.
  template <typename... Wrong>
  requires(!detail::kServes<void(void (*)(P...)), Wrong...>) explicit EventService(Wrong&&...)
      : ServiceBase(detail::wrong_service<Wrong...>(), {}, {}),
        method_(detail::none<Method<void(P...)>>()) {}

  bool invoke(void* /*result*/, void* const* arguments) override {
    return invoke(arguments, std::index_sequence_for<P...>{});
  }

 private:
  template <std::size_t... I>
  bool invoke([[maybe_unused]] void* const* arguments, std::index_sequence<I...>) {
    ScopedLock held(lock());
    if (!held) return false;
    method_(core(), *static_cast<std::remove_cvref_t<P>*>(arguments[I])...);
    return true;
  }

  Method<void(P...)> method_;
};

}  // namespace mauve
