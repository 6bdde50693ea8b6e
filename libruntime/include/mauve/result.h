// SPDX-License-Identifier: LGPL-3.0-or-later
/// Status and Result<T>: how everything outside the real-time path answers.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include <mauve/host/version.h>

namespace mauve {

/// Why something was refused. Printed with to_string(), the same word in logs and on the wire.
enum class Errc {
  invalid_value,   ///< the value itself is wrong: wrong type, out of range, not parsable
  unknown_name,    ///< nothing has this name or address
  duplicate,       ///< something has this name already, or is connected already
  type_mismatch,   ///< kind or type of port, service, contract or data does not fit
  wrong_state,     ///< not possible in the present state (configured, running, stopped)
  hook_failed,     ///< a user hook returned an error
  hook_threw,      ///< a user constructor or hook threw
  cycle,           ///< resources or states would wait for each other for ever
  abi_mismatch,    ///< a plugin was built for another runtime
  plugin_refused,  ///< a plugin file is missing, unsafe, damaged or incomplete
  not_permitted,   ///< the caller, or the process, lacks a privilege
  partly,          ///< in force on some components only
  conflict,        ///< another change was quicker, or holds it; a rule tries again soon
  timed_out,       ///< not finished in the time allowed; a rule tries again soon
  limit,           ///< a size, count or depth limit
  unsupported,     ///< a known thing that this version does not do
  system,          ///< the operating system refused
};

/// "invalid_value", "unknown_name", ...
[[nodiscard]] std::string_view to_string(Errc code);

/// Why mauve refuses something: the kind, and the name of the entry that `mauvectl explain` prints.
/// scripts/messages.py compares both with daemon/protocol/refusals.def.
struct Reason {
  Errc code;       ///< decides the exit code, and how soon a rule tries again
  const char* id;  ///< of the entry in docs/messages.md
};

/// One refusal: its kind, its place (a dotted address, or file:line:column), its reason, and the
/// next step.
struct Error {
  Errc code = Errc::invalid_value;  ///< its kind
  std::string at;       ///< address of the thing refused; may be filled by an outer layer
  std::string message;  ///< one sentence, lower case, no full stop
  std::string hint;     ///< one suggestion, may be empty
  std::string id = {};  ///< name of the entry that explains it, may be empty
};

/// "control.core.gain: must be positive (hint)". For logs and exceptions; clients format the parts.
[[nodiscard]] std::string to_string(const Error& error);

/// Either a T or an Error. Same member names as std::expected, which C++20 does not have. Makes
/// text on the heap: not for real-time code. [any but rt]
/// @snippet api_examples.cpp Result
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::in_place_index<0>, std::move(value)) {}      ///< success
  Result(Error error) : content_(std::in_place_index<1>, std::move(error)) {}  ///< a refusal

  [[nodiscard]] bool has_value() const { return content_.index() == 0; }     ///< success
  explicit operator bool() const { return has_value(); }                     ///< success
  [[nodiscard]] T& value() & { return std::get<0>(content_); }               ///< only after success
  [[nodiscard]] const T& value() const& { return std::get<0>(content_); }    ///< only after success
  [[nodiscard]] T&& value() && { return std::get<0>(std::move(content_)); }  ///< only after success
  T& operator*() & { return value(); }                                       ///< as value()
  const T& operator*() const& { return value(); }                            ///< as value()
  T&& operator*() && { return std::move(*this).value(); }                    ///< as value()
  T* operator->() { return &value(); }                                       ///< as value()
  const T* operator->() const { return &value(); }                           ///< as value()
  [[nodiscard]] Error& error() { return std::get<1>(content_); }  ///< only after a refusal
  /// Only after a refusal.
  [[nodiscard]] const Error& error() const { return std::get<1>(content_); }

 private:
  std::variant<T, Error> content_;
};

/// Success, or an Error.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;                                ///< success
  Result(Error error) : error_(std::move(error)) {}  ///< a refusal

  [[nodiscard]] bool has_value() const { return !error_.has_value(); }  ///< success
  explicit operator bool() const { return has_value(); }                ///< success
  [[nodiscard]] Error& error() { return *error_; }                      ///< only after a refusal
  [[nodiscard]] const Error& error() const { return *error_; }          ///< only after a refusal

 private:
  std::optional<Error> error_;
};

using Status = Result<void>;  ///< the answer of each hook

/// Success.
[[nodiscard]] inline Status ok() { return {}; }

/// A refusal with its parts in reading order.
[[nodiscard]] inline Error refuse(Errc code, std::string at, std::string message,
                                  std::string hint = {}) {
  return {code, std::move(at), std::move(message), std::move(hint)};
}

/// The reason of an error, for another error with more detail. Valid as long as the error.
[[nodiscard]] inline Reason reason_of(const Error& error) { return {error.code, error.id.c_str()}; }

/// A refusal that `mauvectl explain` knows: refuse({Errc::duplicate, "id"}, at, message, hint).
[[nodiscard]] inline Error refuse(Reason reason, std::string at, std::string message,
                                  std::string hint = {}) {
  return {reason.code, std::move(at), std::move(message), std::move(hint), reason.id};
}

}  // namespace mauve
