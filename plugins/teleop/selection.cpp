// SPDX-License-Identifier: LGPL-3.0-or-later
#include "selection.h"

#include <cmath>
#include <cstdlib>

namespace teleop {
namespace {

/// A job that began before the one that wrote may read after it: then the word is from its future,
/// but not from a far one.
bool speaks(const Said& source, mauve::Duration timeout, mauve::Instant now) {
  return source.ever && std::abs(now - source.at) <= timeout.count();
}

}  // namespace

bool hear(Said& source, const rover::Velocity& velocity, mauve::Instant now) {
  if (!std::isfinite(velocity.linear) || !std::isfinite(velocity.angular)) return false;
  source = {velocity, now, true};
  return true;
}

Source choose(const Sources& sources, const Timeouts& timeouts, mauve::Instant now) {
  if (speaks(sources.teleop, timeouts.teleop, now)) return Source::teleop;
  if (speaks(sources.command, timeouts.command, now)) return Source::command;
  return Source::none;
}

std::optional<rover::Velocity> said_by(Source source, const Sources& sources) {
  switch (source) {
    case Source::teleop:
      return sources.teleop.velocity;
    case Source::command:
      return sources.command.velocity;
    case Source::none:
      break;
  }
  return std::nullopt;
}

}  // namespace teleop
