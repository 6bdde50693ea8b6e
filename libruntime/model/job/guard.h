// SPDX-License-Identifier: LGPL-3.0-or-later
/// The guarded calls of user constructors and hooks, which may throw anything, crash, or never
/// return.
#pragma once

#include <exception>
#include <string>
#include <utility>

#include "model/job/abandonable_thread.h"
#include "rt/thread/run_guarded.h"

#include <mauve/result.h>

namespace mauve {

/// The text of an exception of user code, which may have none. [any]
inline const char* text_of(const std::exception& error) noexcept {
  const char* const text = error.what();
  return text != nullptr ? text : "an exception without a text";
}

namespace detail {

/// The body and the result of a hook.
template <typename Body>
struct HookRun {
  const std::string& at;
  const char* hook;
  Body& body;
  Status done = ok();

  static void run(void* self) {
    auto& hook = *static_cast<HookRun*>(self);
    hook.done = hook.caught();
  }
  Status caught() {
    try {
      return body();
    } catch (const std::exception& error) {
      return refuse({Errc::hook_threw, "hook_exception"}, at,
                    std::string(hook) + " threw: " + text_of(error));
    } catch (...) {
      return refuse({Errc::hook_threw, "hook_exception"}, at,
                    std::string(hook) + " threw something that is no std::exception");
    }
  }
};

/// The refusal of a hook that did not end by itself.
[[nodiscard]] Error crashed(const std::string& at, const char* hook, const rt::Fault& fault);

}  // namespace detail

/// Runs `body` (returning Status). An exception becomes an Error that names the hook. So does a
/// crash in the hook's own code, or a call that would end the process. A return to a thread that
/// was abandoned in it is an Error too: its caller must not touch the model. `watched`: see
/// rt::run_guarded().
template <typename Body>
Status call_hook(const std::string& at, const char* hook, Body&& body,
                 const rt::Watched& watched = rt::kUnwatched) {
  InHook in_hook(at, hook);
  detail::HookRun<Body> run{at, hook, body};
  const rt::Fault fault = rt::run_guarded(&detail::HookRun<Body>::run, &run, watched);
  Status done = fault.happened() ? Status(detail::crashed(at, hook, fault)) : std::move(run.done);
  if (in_hook.back()) return done;
  return refuse({Errc::timed_out, "hook_did_not_return"}, at,
                std::string(hook) + " returned after mauved had abandoned its thread");
}

}  // namespace mauve
