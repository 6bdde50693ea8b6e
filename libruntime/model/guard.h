// SPDX-License-Identifier: LGPL-3.0-or-later
/// The door behind which user constructors and hooks may throw what they like.
#pragma once

#include <exception>
#include <string>

#include <mauve/result.h>

namespace mauve {

/// Runs `body` (returning Status); whatever it throws becomes an Error that names the hook.
template <typename Body>
Status call_hook(const std::string& at, const char* hook, Body&& body) {
  try {
    return body();
  } catch (const std::exception& error) {
    return refuse(Errc::hook_threw, at, std::string(hook) + " threw: " + error.what());
  } catch (...) {
    return refuse(Errc::hook_threw, at,
                  std::string(hook) + " threw something that is no std::exception");
  }
}

}  // namespace mauve
