// SPDX-License-Identifier: LGPL-3.0-or-later
/// Standard streams of a program that a caller closed, or whose output finds no room.
#pragma once

namespace mauve {

/// Opens /dev/null, or else a socket without a peer, in place of each closed standard stream,
/// before any other file is opened. Else the next socket or file would get its number and receive
/// the output. Writes to a closed output fail as before. [any]
void occupy_standard_streams();

}  // namespace mauve
