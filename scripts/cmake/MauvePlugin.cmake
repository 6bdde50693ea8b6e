# SPDX-License-Identifier: LGPL-3.0-or-later
# mauve_add_plugin(NAME SOURCES file... [LINKS library...] [VERSION 1.2.3] [TARGET target]
#                  [OUTPUT_DIRECTORY dir])
#
# Builds NAME.so as mauved wants its plugins: one exported symbol, everything resolved at link time,
# nothing that would pin the code in memory after dlclose, no search path of its own, and a checksum
# in its manifest by which mauved notices damage (mauve-stamp, after linking). The target is called NAME unless TARGET says otherwise. Works in this tree and after find_package(mauve).
# A member that registers itself under another name than its own, gain{*this, "gian"}, fails the build with its file and
# line (member_names.py, which needs Python 3). A comment before the string says that another name is meant.
# A project that sets no build type gets RelWithDebInfo: without one the compiler would not optimise.
set(MAUVE_PLUGIN_VERSION_SCRIPT "${CMAKE_CURRENT_LIST_DIR}/mauve_plugin.map")
set(MAUVE_MEMBER_NAMES "${CMAKE_CURRENT_LIST_DIR}/member_names.py")
include(CheckCXXCompilerFlag)
find_package(Python3 QUIET COMPONENTS Interpreter)
if(NOT Python3_Interpreter_FOUND)
  message(WARNING "mauve_add_plugin: there is no Python 3, so the names of members are not checked; install python3")
endif()

function(mauve_add_plugin name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "VERSION;TARGET;OUTPUT_DIRECTORY" "SOURCES;LINKS")
  string(LENGTH "${name}" length)
  if(NOT name MATCHES "^[a-z][a-z0-9_]*$" OR length GREATER 64)
    message(FATAL_ERROR "mauve_add_plugin: the name '${name}' must match [a-z][a-z0-9_]{0,63}")
  endif()
  if(ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "mauve_add_plugin(${name}): unknown arguments '${ARG_UNPARSED_ARGUMENTS}'")
  endif()
  if(NOT ARG_SOURCES)
    message(FATAL_ERROR "mauve_add_plugin(${name}): SOURCES is missing")
  endif()
  if(NOT ARG_TARGET)
    set(ARG_TARGET ${name})
  endif()
  if(NOT ARG_VERSION)
    set(ARG_VERSION "${PROJECT_VERSION}")
    if(NOT ARG_VERSION)
      set(ARG_VERSION "0.0.0")
    endif()
  endif()
  if(NOT ARG_OUTPUT_DIRECTORY)
    set(ARG_OUTPUT_DIRECTORY "${MAUVE_PLUGIN_OUTPUT_DIRECTORY}")
    if(NOT ARG_OUTPUT_DIRECTORY)
      set(ARG_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}")
    endif()
  endif()

  get_property(multi_config GLOBAL PROPERTY GENERATOR_IS_MULTI_CONFIG)
  if(NOT CMAKE_BUILD_TYPE AND NOT multi_config)
    message(STATUS "mauve_add_plugin(${name}): no build type is set, so it is RelWithDebInfo "
      "(-DCMAKE_BUILD_TYPE=Debug for a debugger)")
    set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "Debug, Release, RelWithDebInfo or MinSizeRel" FORCE)
  endif()
  add_library(${ARG_TARGET} MODULE ${ARG_SOURCES})
  set_target_properties(${ARG_TARGET} PROPERTIES
    PREFIX "" SUFFIX ".so" OUTPUT_NAME "${name}"
    LIBRARY_OUTPUT_DIRECTORY "${ARG_OUTPUT_DIRECTORY}"
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
    SKIP_BUILD_RPATH ON INSTALL_RPATH "" INSTALL_RPATH_USE_LINK_PATH OFF
    LINK_DEPENDS "${MAUVE_PLUGIN_VERSION_SCRIPT}")
  target_compile_features(${ARG_TARGET} PRIVATE cxx_std_20)
  target_compile_definitions(${ARG_TARGET} PRIVATE
    MAUVE_PLUGIN_NAME="${name}" MAUVE_PLUGIN_VERSION="${ARG_VERSION}")
  # A fault (SIGFPE, SIGSEGV) in a core may be turned into an exception: unwinding must work there.
  target_compile_options(${ARG_TARGET} PRIVATE -fnon-call-exceptions)
  # A frame that is larger than what is left of its stack must not jump over the guard page.
  check_cxx_compiler_flag(-fstack-clash-protection MAUVE_HAS_STACK_CLASH_PROTECTION)
  if(MAUVE_HAS_STACK_CLASH_PROTECTION)
    target_compile_options(${ARG_TARGET} PRIVATE -fstack-clash-protection)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # A unique symbol (any static of a template or inline function) would forbid unloading.
    target_compile_options(${ARG_TARGET} PRIVATE -fno-gnu-unique)
  endif()
  target_link_options(${ARG_TARGET} PRIVATE
    "LINKER:--version-script=${MAUVE_PLUGIN_VERSION_SCRIPT}" LINKER:-z,now LINKER:-z,noexecstack
    LINKER:--build-id=sha1)
  if(NOT (MAUVE_SANITIZE AND CMAKE_CXX_COMPILER_ID MATCHES "Clang"))
    # clang keeps the sanitizer runtime in the program, so there its symbols stay open in a plugin.
    target_link_options(${ARG_TARGET} PRIVATE LINKER:-z,defs)
  endif()
  target_link_libraries(${ARG_TARGET} PRIVATE mauve::runtime ${ARG_LINKS})
  if(Python3_Interpreter_FOUND)
    set(folders "$<TARGET_PROPERTY:${ARG_TARGET},INCLUDE_DIRECTORIES>")
    add_custom_command(TARGET ${ARG_TARGET} PRE_LINK
      COMMAND "${Python3_EXECUTABLE}" "${MAUVE_MEMBER_NAMES}" "${CMAKE_SOURCE_DIR}" "-I$<JOIN:${folders},;-I>"
        "$<TARGET_PROPERTY:${ARG_TARGET},SOURCES>"
      WORKING_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}" COMMAND_EXPAND_LISTS VERBATIM)
  endif()
  add_custom_command(TARGET ${ARG_TARGET} POST_BUILD
    COMMAND mauve::stamp "$<TARGET_FILE:${ARG_TARGET}>" VERBATIM)
  # Types and contracts of other plugins, spelled alike here and after installation: "types/pose.h".
  target_include_directories(${ARG_TARGET} PRIVATE "${MAUVE_PLUGIN_INCLUDE_DIR}")
  if(TARGET mauve_warnings)
    target_link_libraries(${ARG_TARGET} PRIVATE mauve_warnings)
    set_property(GLOBAL APPEND PROPERTY MAUVE_PLUGIN_TARGETS ${ARG_TARGET})
  endif()
endfunction()
