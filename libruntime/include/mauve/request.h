// SPDX-License-Identifier: LGPL-3.0-or-later
/// Requests from core code: a component asks for a change that the architecture file names.
#pragma once

#include <string_view>

#include <mauve/host/version.h>

namespace mauve {

/// `mauve::request("drop_gnss");` in a job: asks for the transaction of this name. It is carried
/// out later and elsewhere, if the file permits it ("may_request" of the component); an event in
/// the log has its outcome. Wait-free and bounded; the text is copied. False, and nothing is asked:
/// outside a job of a component, with an empty name or one longer than 64 characters, or when too
/// many requests are unread. Of one component ten at once, then one a second are carried out; the
/// rest is counted and reported in the log. [rt]
bool request(std::string_view transaction);

}  // namespace mauve
