# SPDX-License-Identifier: LGPL-3.0-or-later
# How every target of this house is built: language level, warnings, sanitizers, layers, tests.
include(GNUInstallDirs)
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "" FORCE)
endif()
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bin")
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/lib")
set(MAUVE_PLUGIN_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/lib/mauve/plugins")
set(MAUVE_PLUGIN_INCLUDE_DIR "${CMAKE_CURRENT_SOURCE_DIR}/plugins")
# Where an installed daemon finds plugins and its files; programs get these as compile definitions.
set(MAUVE_INSTALL_PLUGINDIR "${CMAKE_INSTALL_FULL_LIBDIR}/mauve/plugins")

find_program(MAUVE_CCACHE ccache)
if(MAUVE_CCACHE)
  # Without these, ccache keeps nothing that is compiled with precompiled headers.
  set(CMAKE_CXX_COMPILER_LAUNCHER
    "${CMAKE_COMMAND};-E;env;CCACHE_SLOPPINESS=pch_defines,time_macros;${MAUVE_CCACHE}")
endif()
find_package(Threads REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(yaml-cpp REQUIRED)

add_library(mauve_warnings INTERFACE)
target_compile_options(mauve_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Werror
  $<$<CXX_COMPILER_ID:Clang>:-Wthread-safety>)  # base/mutex.h

# Functions that belong to one thread check it, see base/thread_role.h.
add_compile_definitions($<$<CONFIG:Debug>:MAUVE_CHECK_THREADS>)
set(MAUVE_SANITIZE "" CACHE STRING "Sanitizers for all targets: address,undefined or thread")
if(MAUVE_SANITIZE)
  add_compile_definitions(MAUVE_CHECK_THREADS)
  add_compile_options(-fsanitize=${MAUVE_SANITIZE} -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${MAUVE_SANITIZE})
  if(MAUVE_SANITIZE MATCHES "thread" AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # g++ warns at every atomic fence that the sanitizer cannot follow it; the code keeps its fences.
    add_compile_options(-Wno-tsan)
  endif()
  if(MAUVE_SANITIZE MATCHES "undefined")
    add_compile_options(-fno-sanitize-recover=undefined)
  endif()
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang" AND MAUVE_SANITIZE MATCHES "address")
    add_compile_definitions(__SANITIZE_ADDRESS__=1)  # which g++ and later clangs say by themselves
  endif()
  string(REPLACE "," "_" sanitizer_names "${MAUVE_SANITIZE}")
  string(TOUPPER "MAUVE_SANITIZE_${sanitizer_names}" sanitizer_macro)
  add_compile_definitions(${sanitizer_macro}=1)
endif()

# mauve_layer(NAME LINKS ...): one layer of libmauve, an object library that sees only what it links.
# Its sources are listed by libruntime/NAME/CMakeLists.txt with target_sources().
function(mauve_layer name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS" ${ARGN})
  add_library(mauve_${name} OBJECT ${ARG_SOURCES})
  target_include_directories(mauve_${name} PUBLIC
    "${PROJECT_SOURCE_DIR}/libruntime/include" "${PROJECT_SOURCE_DIR}/libruntime")
  target_link_libraries(mauve_${name} PUBLIC ${ARG_LINKS} Threads::Threads PRIVATE mauve_warnings)
  target_compile_definitions(mauve_${name} PRIVATE MAUVE_VERSION="${PROJECT_VERSION}")
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(mauve_${name} PRIVATE -fno-semantic-interposition)
  endif()
endfunction()

# mauve_library_of_plugins(NAME SOURCE...): the static library mauve::NAME, which authors link to their plugins. A
# plugin takes its code with it when it is unloaded, so it is compiled as a plugin is.
function(mauve_library_of_plugins name)
  add_library(mauve_${name} STATIC ${ARGN})
  add_library(mauve::${name} ALIAS mauve_${name})
  set_target_properties(mauve_${name} PROPERTIES
    EXPORT_NAME ${name} CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  target_link_libraries(mauve_${name} PUBLIC mauve_runtime PRIVATE "$<BUILD_INTERFACE:mauve_warnings>")
  target_compile_options(mauve_${name} PRIVATE -fnon-call-exceptions
    $<$<CXX_COMPILER_ID:GNU>:-fno-gnu-unique>)
endfunction()

# mauve_test_headers(NAME): where sources are joined, the tests share the precompiled headers of most of them.
function(mauve_test_headers name)
  if(NOT MAUVE_JOIN)
    return()  # each source proves that it includes the headers that it uses
  endif()
  if(NOT TARGET precompiled_headers)
    add_library(json_once STATIC "${PROJECT_SOURCE_DIR}/tests/support/json_once.cpp")
    target_compile_options(json_once PRIVATE -O0)
    target_link_libraries(json_once PRIVATE nlohmann_json::nlohmann_json)
    file(CONFIGURE OUTPUT "${CMAKE_BINARY_DIR}/precompiled_headers.cpp" CONTENT "int main() {}\n")
    add_executable(precompiled_headers "${CMAKE_BINARY_DIR}/precompiled_headers.cpp")
    target_compile_options(precompiled_headers PRIVATE -O0)
    target_link_libraries(precompiled_headers PRIVATE
      json_once GTest::gmock nlohmann_json::nlohmann_json mauve_warnings)
    target_precompile_headers(precompiled_headers PRIVATE
      <gmock/gmock.h> <gtest/gtest.h> "${PROJECT_SOURCE_DIR}/tests/support/json_once.h"
      <algorithm> <chrono> <filesystem> <fstream> <functional> <memory> <sstream> <string> <thread> <vector>)
  endif()
  target_precompile_headers(${name} REUSE_FROM precompiled_headers)
  target_link_libraries(${name} PRIVATE json_once)
endfunction()

# mauve_test(NAME SOURCES ... LINKS ... [LABELS ...] [TIMEOUT s] [ENVIRONMENT A=b ...] [DEPENDS target ...]
#            [SERIAL]): a GoogleTest program, registered test by test. SERIAL: alone on the machine.
# Labels with a meaning: rt (needs real-time rights and true timing), tsan (part of the thread sanitizer
# subset), campaign (long), release_only (measures what a sanitizer would change).
add_custom_target(tsan_tests)
function(mauve_test name)
  cmake_parse_arguments(ARG "SERIAL" "TIMEOUT" "SOURCES;LINKS;LABELS;ENVIRONMENT;DEPENDS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  if(rt IN_LIST ARG_LABELS OR campaign IN_LIST ARG_LABELS)
    set(ARG_SERIAL TRUE)  # true timing needs the machine for itself
  endif()
  if(MAUVE_SANITIZE)
    math(EXPR ARG_TIMEOUT "${ARG_TIMEOUT} * 4")
  endif()
  add_executable(${name} ${ARG_SOURCES})
  if(NOT ARG_SERIAL)
    target_compile_options(${name} PRIVATE -O0)  # half the build time of the tests; they are not timed
    mauve_test_headers(${name})
  endif()
  target_link_libraries(${name} PRIVATE ${ARG_LINKS} GTest::gtest_main GTest::gmock mauve_warnings)
  target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}/tests")
  if(MAUVE_SANITIZE AND ARG_LABELS MATCHES "rt|campaign|release_only")
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL TRUE)  # a sanitizer build does not run them
    return()
  endif()
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/tests")
  if(ARG_DEPENDS)
    add_dependencies(${name} ${ARG_DEPENDS})
  endif()
  if("tsan" IN_LIST ARG_LABELS)
    add_dependencies(tsan_tests ${name})
  endif()
  set(prefix)
  if(campaign IN_LIST ARG_LABELS)
    set(prefix TEST_PREFIX "${name}.")  # its short form has tests of the same names
  endif()
  gtest_discover_tests(${name} ${prefix} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 300 TEST_LIST ${name}_TESTS
    WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}" PROPERTIES TIMEOUT ${ARG_TIMEOUT})
  # Properties that are lists do not survive gtest_discover_tests; they are set on what it found.
  set(properties "${CMAKE_CURRENT_BINARY_DIR}/${name}_properties.cmake")
  file(CONFIGURE OUTPUT "${properties}" @ONLY CONTENT [=[
if(DEFINED @name@_TESTS)
  set_tests_properties(${@name@_TESTS} PROPERTIES
    LABELS "@ARG_LABELS@" ENVIRONMENT "@ARG_ENVIRONMENT@" RUN_SERIAL "@ARG_SERIAL@")
endif()
]=])
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES "${properties}")
endfunction()

# mauve_bench(NAME SOURCES ... LINKS ...): a program in build/PRESET/bench/, built and run by scripts/bench.
function(mauve_bench name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS;DEPENDS" ${ARGN})
  add_executable(bench_${name} EXCLUDE_FROM_ALL ${ARG_SOURCES})
  target_link_libraries(bench_${name} PRIVATE ${ARG_LINKS} mauve_warnings)
  target_include_directories(bench_${name} PRIVATE "${PROJECT_SOURCE_DIR}/tests")
  set_target_properties(bench_${name} PROPERTIES
    OUTPUT_NAME "${name}" RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bench")
  if(ARG_DEPENDS)
    add_dependencies(bench_${name} ${ARG_DEPENDS})
  endif()
endfunction()

# mauve_add_subdirectories(DIR ...): those that are there. A folder joins the build with its CMakeLists.txt.
macro(mauve_add_subdirectories)
  foreach(mauve_folder ${ARGN})
    if(EXISTS "${CMAKE_CURRENT_SOURCE_DIR}/${mauve_folder}/CMakeLists.txt")
      add_subdirectory(${mauve_folder})
    endif()
  endforeach()
endmacro()
