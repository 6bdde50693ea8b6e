# SPDX-License-Identifier: LGPL-3.0-or-later
# Debian packages: one for each component of MauveInstall.cmake. scripts/package builds them; packaging/README.md
# says what is in each.
set(folder "${PROJECT_SOURCE_DIR}/packaging")
set(MAUVE_DEBIAN_REVISION 1 CACHE STRING "Version of the packages behind that of mauve: 0.1.0-1")
set(MAUVE_MAINTAINER "mauve maintainers <maintainers@mauve.example>" CACHE STRING "Who answers for the packages")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME mauve)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_PACKAGE_CONTACT "${MAUVE_MAINTAINER}")
set(CPACK_PACKAGE_DIRECTORY "${PROJECT_BINARY_DIR}/packages")
set(CPACK_COMPONENTS_ALL runtime dev plugins ros1 doc)
if(NOT TARGET ros)
  list(REMOVE_ITEM CPACK_COMPONENTS_ALL ros1)
endif()
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
# The unit files and mauve.pc name the prefix, and one file is below /etc.
set(CPACK_SET_DESTDIR ON)
set(CPACK_INSTALL_PREFIX "${CMAKE_INSTALL_PREFIX}")
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_STRIP_FILES ON)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE "${MAUVE_DEBIAN_REVISION}")
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${CMAKE_LIBRARY_OUTPUT_DIRECTORY}")  # libmauve of this build
if(CMAKE_CROSSCOMPILING)
  # dpkg-shlibdeps finds the libraries of the other machine here, and their packages in $DPKG_ADMINDIR (scripts/arm64).
  string(REPLACE aarch64 arm64 CPACK_DEBIAN_PACKAGE_ARCHITECTURE "${CMAKE_SYSTEM_PROCESSOR}")
  list(APPEND CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${CMAKE_SYSROOT}/lib/${CMAKE_LIBRARY_ARCHITECTURE}"
    "${CMAKE_SYSROOT}/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}")
endif()
# A plugin works with the libmauve that it was built with, so packages of two versions never mix.
set(same_version "mauve (= ${PROJECT_VERSION}-${MAUVE_DEBIAN_REVISION})")

# mauve_package(COMPONENT SECTION DEPENDS SUMMARY DESCRIPTION)
function(mauve_package component section depends summary description)
  string(TOUPPER "${component}" upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION "${section}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${depends}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${summary}\n${description}" PARENT_SCOPE)
endfunction()
set(what "mauve loads components as plugins, runs each on a real-time thread, and changes
the running system: algorithms, parameters, wiring and code.")
mauve_package(runtime misc "systemd | systemd-standalone-sysusers | systemd-sysusers"
  "real-time components that are changed while they run"
  "${what}\n.\nThis package has the daemon mauved, its guardian, the client mauvectl,\nand the service.")
mauve_package(dev libdevel "${same_version}, python3"
  "real-time components that are changed while they run - development"
  "${what}\n.\nThis package has the headers, the CMake package, and whole example projects\nfor authors of plugins.")
mauve_package(plugins misc "${same_version}"
  "real-time components that are changed while they run - plugins"
  "${what}\n.\nThis package has the drivers, filters, planners and controllers of a mobile\nrobot, and example architectures with simulated devices.")
mauve_package(ros1 misc "${same_version}"
  "real-time components that are changed while they run - ROS 1"
  "${what}\n.\nThis package has the plugin that publishes to topics of ROS 1 and subscribes\nto them.")
mauve_package(doc doc ""
  "real-time components that are changed while they run - documentation"
  "${what}\n.\nThis package has tutorials, how-to pages, concepts and the programming\ninterface as a site that needs no network.")

set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME mauve)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_RECOMMENDS mauve-plugins)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SUGGESTS "mauve-dev, mauve-doc")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA
  "${folder}/postinst" "${folder}/prerm" "${folder}/postrm" "${folder}/conffiles" "${folder}/triggers")
set(CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS "cmake, g++, libgtest-dev, mauve-doc")
set(CPACK_DEBIAN_DOC_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_DOC_PACKAGE_SHLIBDEPS OFF)

# The site of scripts/site; `cmake --install` leaves it out.
install(DIRECTORY "${PROJECT_SOURCE_DIR}/build/site/" DESTINATION "${CMAKE_INSTALL_DOCDIR}/html"
  COMPONENT doc EXCLUDE_FROM_ALL)

set(CPACK_PRE_BUILD_SCRIPTS "${folder}/stage.cmake")
set(CPACK_MAUVE_SOURCE_DIR "${PROJECT_SOURCE_DIR}")
set(CPACK_VERBATIM_VARIABLES ON)
include(CPack)
