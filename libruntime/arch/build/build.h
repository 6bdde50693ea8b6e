// SPDX-License-Identifier: LGPL-3.0-or-later
/// From a Spec to an Architecture: everything made, set and connected, nothing configured.
#pragma once

#include <cstdint>
#include <memory>

#include "arch/parse/spec.h"

namespace mauve {
class Architecture;
}  // namespace mauve
namespace mauve::plugin {
class Catalog;
}  // namespace mauve::plugin

namespace mauve::arch {

/// Names in rules and transactions that the architecture does not have.
enum class LostNames : std::uint8_t {
  refused,  ///< of a file that a user wrote
  kept,     ///< of a system that ran
};

/// Makes all elements, sets properties and task attributes and connects ports. One pass reports
/// all errors to `problems`: unknown plugins, types, cores, state machines, data, properties, ports
/// and services, each with the nearest name. It reports rules that check_rules() refuses, values of
/// the wrong type or out of range, and contracts that do not fit. It reports names in an element
/// that are illegal or used twice, state machines that cannot run, kinds and types of ports that
/// differ, and cycles of resources. It also reports CPUs that this machine does not have: the
/// deployer refuses them, so a file for another machine may be good there.
///
/// A rule or transaction of a system that ran may name what a later change took away. With
/// LostNames::kept that is no error, and notes_on() tells it: such a rule has no effect.
///
/// Null when `problems` is not empty afterwards; else `supervision`, when it is given, gets the
/// rules. Runs constructors of plugins, and of hooks only those of state machines, which build
/// their transitions there. [control]
[[nodiscard]] std::unique_ptr<Architecture> build(const Spec& spec, const plugin::Catalog& catalog,
                                                  Problems& problems,
                                                  rules::Supervision* supervision = nullptr,
                                                  LostNames lost = LostNames::refused);

}  // namespace mauve::arch
