# SPDX-License-Identifier: LGPL-3.0-or-later
# Run with cmake -P: installs BUILD into an emptied PREFIX.
file(REMOVE_RECURSE "${PREFIX}")
unset(ENV{DESTDIR})
execute_process(COMMAND "${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${PREFIX}"
  COMMAND_ERROR_IS_FATAL ANY)
