// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/host/prepared_change.h>

#include "exec/system/prepared.h"

namespace mauve {

PreparedChange::PreparedChange(std::unique_ptr<Content> content, Retired elements)
    : elements_(std::move(elements)), content_(std::move(content)) {}
PreparedChange::PreparedChange(PreparedChange&&) noexcept = default;
PreparedChange::~PreparedChange() = default;

}  // namespace mauve
