// SPDX-License-Identifier: LGPL-3.0-or-later
/// A sanitizer makes long computations ten times as long: tests then go through less of the same.
#pragma once

namespace support {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace support
