// SPDX-License-Identifier: LGPL-3.0-or-later
/// Version of the runtime and of the binary contract between runtime and plugins.
#pragma once

#if __cplusplus < 202002L
#error "mauve needs C++20: compile with -std=c++20, or use mauve_add_plugin() of CMake"
#endif

/// The interface of the runtime, for authors of components and for programs that embed it.
namespace mauve {

inline constexpr int kVersionMajor = 0;           ///< of semantic versioning
inline constexpr int kVersionMinor = 1;           ///< of semantic versioning
inline constexpr int kVersionPatch = 0;           ///< of semantic versioning
inline constexpr const char* kVersion = "0.1.0";  ///< as text

/// Raised with every change of a class of these headers, also of mauve/detail/, that a compiled
/// plugin can see.
inline constexpr int kAbi = 11;

}  // namespace mauve
