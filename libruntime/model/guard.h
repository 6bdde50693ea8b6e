// SPDX-License-Identifier: LGPL-3.0-or-later
/// The door behind which user constructors and hooks may throw what they like, or never return.
#pragma once

#include <exception>
#include <string>

#include "model/leavable.h"

#include <mauve/result.h>

namespace mauve {

/// The text of an exception of user code, which may have none. [any]
inline const char* text_of(const std::exception& error) noexcept {
  const char* const text = error.what();
  return text != nullptr ? text : "an exception without a text";
}

namespace detail {

template <typename Body>
Status caught(const std::string& at, const char* hook, Body&& body) {
  try {
    return body();
  } catch (const std::exception& error) {
    return refuse(Errc::hook_threw, at, std::string(hook) + " threw: " + text_of(error));
  } catch (...) {
    return refuse(Errc::hook_threw, at,
                  std::string(hook) + " threw something that is no std::exception");
  }
}

}  // namespace detail

/// Runs `body` (returning Status); whatever it throws becomes an Error that names the hook. So does
/// a return to a thread that was left behind in it: whoever gets that must not touch the model.
template <typename Body>
Status call_hook(const std::string& at, const char* hook, Body&& body) {
  InHook in_hook(at, hook);
  Status done = detail::caught(at, hook, body);
  if (in_hook.back()) return done;
  return refuse(Errc::timed_out, at, std::string(hook) + " returned when it had been given up");
}

}  // namespace mauve
