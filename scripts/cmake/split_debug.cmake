# SPDX-License-Identifier: LGPL-3.0-or-later
# Part of `cmake --install`: moves the debug information of every installed program, library and plugin
# into a folder .debug beside it, where gdb and perf look for it. A program is then mapped in a tenth of
# its size. `cmake --install --strip` leaves nothing to move. Needs MAUVE_OBJCOPY and MAUVE_OBJDUMP.
foreach(installed IN LISTS CMAKE_INSTALL_MANIFEST_FILES)
  set(file "$ENV{DESTDIR}${installed}")
  if(NOT EXISTS "${file}" OR IS_SYMLINK "${file}" OR IS_DIRECTORY "${file}")
    continue()
  endif()
  file(READ "${file}" magic LIMIT 4 HEX)
  if(NOT magic STREQUAL "7f454c46")
    continue()
  endif()
  execute_process(COMMAND "${MAUVE_OBJDUMP}" -h "${file}" OUTPUT_VARIABLE sections COMMAND_ERROR_IS_FATAL ANY)
  if(NOT sections MATCHES "\\.debug_info")
    continue()
  endif()
  get_filename_component(folder "${file}" DIRECTORY)
  get_filename_component(name "${file}" NAME)
  file(MAKE_DIRECTORY "${folder}/.debug")
  foreach(step "--only-keep-debug;${file};${folder}/.debug/${name}.debug" "--strip-debug;${file}"
          "--add-gnu-debuglink=${folder}/.debug/${name}.debug;${file}")
    execute_process(COMMAND "${MAUVE_OBJCOPY}" ${step} COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
  get_filename_component(folder "${installed}" DIRECTORY)
  list(APPEND CMAKE_INSTALL_MANIFEST_FILES "${folder}/.debug/${name}.debug")  # so that it can be uninstalled
endforeach()
