# SPDX-License-Identifier: LGPL-3.0-or-later
# How every target of this house is built: language level, warnings, sanitizers, layers, tests.
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

find_program(MAUVE_CCACHE ccache)
if(MAUVE_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${MAUVE_CCACHE}")
endif()
find_package(Threads REQUIRED)

add_library(mauve_warnings INTERFACE)
target_compile_options(mauve_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Werror)

set(MAUVE_SANITIZE "" CACHE STRING "Sanitizers for all targets: address,undefined or thread")
if(MAUVE_SANITIZE)
  add_compile_options(-fsanitize=${MAUVE_SANITIZE} -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${MAUVE_SANITIZE})
endif()

# mauve_layer(NAME SOURCES ... LINKS ...): one layer of libmauve, an object library that sees only what it links.
function(mauve_layer name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINKS" ${ARGN})
  add_library(mauve_${name} OBJECT ${ARG_SOURCES})
  target_include_directories(mauve_${name} PUBLIC
    "${PROJECT_SOURCE_DIR}/libruntime/include" "${PROJECT_SOURCE_DIR}/libruntime")
  target_link_libraries(mauve_${name} PUBLIC ${ARG_LINKS} Threads::Threads PRIVATE mauve_warnings)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(mauve_${name} PRIVATE -fno-semantic-interposition)
  endif()
endfunction()

# mauve_test(NAME SOURCES ... LINKS ... [LABELS ...]): a GoogleTest program registered test by test.
function(mauve_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;LINKS;LABELS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 60)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LINKS} GTest::gtest_main mauve_warnings)
  target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}/tests")
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/tests")
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60
    PROPERTIES TIMEOUT ${ARG_TIMEOUT} LABELS "${ARG_LABELS}")
endfunction()
