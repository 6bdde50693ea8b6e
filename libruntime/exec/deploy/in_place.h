// SPDX-License-Identifier: LGPL-3.0-or-later
/// The steps of a swap in place, see Deployer: prepare, park, exchange, resume.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include <mauve/detail/element_type.h>
#include <mauve/host/ongoing.h>
#include <mauve/host/prepared_change.h>
#include <mauve/result.h>

namespace mauve {
struct Bundle;
struct Edit;
}  // namespace mauve

namespace mauve::exec {

class System;

/// [factory] Makes the elements without configuring them.
Result<PreparedChange> prepare_in_place(System& system, const Edit& edit,
                                        std::optional<std::uint64_t> made_from);
/// [factory] The core before, which is configured again.
Result<PreparedChange> prepare_back_in_place(System& system, std::string_view component,
                                             std::shared_ptr<const Bundle> before,
                                             std::optional<ComponentType> type);
/// [control]
[[nodiscard]] std::shared_ptr<Ongoing> begin_in_place_park(System& system, PreparedChange& change);
/// [factory] Cleans the old core up and configures the new one, or the old one again. Refused while
/// an abandoned thread may be in the old core; a rollback then leaves that core as it is.
Status in_place_exchange(System& system, PreparedChange& change);
/// [control]
Result<std::shared_ptr<Ongoing>> begin_in_place_resume(System& system, PreparedChange& change,
                                                       const Status& exchanged);

}  // namespace mauve::exec
