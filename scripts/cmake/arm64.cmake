# SPDX-License-Identifier: LGPL-3.0-or-later
# For CMAKE_TOOLCHAIN_FILE: Debian's cross compiler for arm64, the libraries that scripts/arm64 fetched into
# build/arm64-root, and qemu-user, which runs what is built.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
get_filename_component(CMAKE_SYSROOT "${CMAKE_CURRENT_LIST_DIR}/../../build/arm64-root" ABSOLUTE)
# With qemu's option -L a program would find the libraries too, but also build/arm64-root where it opens "/".
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64 "${CMAKE_SYSROOT}/lib/aarch64-linux-gnu/ld-linux-aarch64.so.1"
  --library-path "${CMAKE_SYSROOT}/lib/aarch64-linux-gnu:${CMAKE_SYSROOT}/usr/lib/aarch64-linux-gnu")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_LIBDIR} "${CMAKE_SYSROOT}/usr/lib/aarch64-linux-gnu/pkgconfig:${CMAKE_SYSROOT}/usr/share/pkgconfig")
set(ENV{PKG_CONFIG_SYSROOT_DIR} "${CMAKE_SYSROOT}")
