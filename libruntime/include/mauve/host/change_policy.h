// SPDX-License-Identifier: LGPL-3.0-or-later
/// The choices of a change: the states and values that it keeps, and when its members go on.
#pragma once

#include <cstdint>

namespace mauve {

/// The fate of the state of a core that is replaced.
enum class StatePolicy : std::uint8_t {
  keep,   ///< hand it over; refused when the new core can neither take nor convert it
  offer,  ///< the same, but a core that is `Stateless` may leave it: of reactions to a fault
  drop,   ///< the new core starts fresh
};

/// The first values of a core that replaces one of another type. They do not concern properties
/// that the edit sets, or that the core before does not have.
enum class Values : std::uint8_t {
  keep,      ///< with the values in force; refused when one has another type or unit there, or is
             ///< out of range
  fit,       ///< with the values in force that fit; the others with their defaults
  defaults,  ///< all with their defaults
};

/// When the members of a change go on.
enum class Sync : std::uint8_t {
  /// Each member goes over at its own first release at or after the instant; none waits for
  /// another.
  cut,
  /// All members wait at a boundary until the last one is there. Then a resource that leaves hands
  /// its state to the one that joins under its name, and all go on at their next releases. For
  /// changes of a contract between members.
  barrier,
};

/// The mode of one component after the change.
enum class Mode : std::uint8_t { keep, run, park };

}  // namespace mauve
