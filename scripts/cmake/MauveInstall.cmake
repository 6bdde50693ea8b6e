# SPDX-License-Identifier: LGPL-3.0-or-later
# The files of `cmake --install`. Only targets and files that exist are installed. The component of each rule is
# the Debian package that gets it (MauvePackage.cmake): runtime, dev, plugins, ros1, doc.
include(CMakePackageConfigHelpers)
set(mauve_sources "${PROJECT_SOURCE_DIR}")
set(MAUVE_PLUGIN_SUBDIR "${CMAKE_INSTALL_LIBDIR}/mauve/plugins")
set(mauve_cmake_dir "${CMAKE_INSTALL_LIBDIR}/cmake/mauve")
# Units belong to the prefix: /usr/lib/systemd for a package, /usr/local/lib/systemd by hand.
set(MAUVE_SYSTEMD_DIR "lib" CACHE STRING "Holds systemd/system, sysusers.d and tmpfiles.d")

# Programs and libmauve. The programs of the build tree have the RUNPATH of the installed ones: CMake
# lengthens one that it is to replace by a colon, and the empty part behind it is the working directory.
# Packages have none (CMAKE_SKIP_INSTALL_RPATH): their build tree keeps that of CMake, which `--install` removes.
set(mauve_runpath "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}" "$ORIGIN/../lib")
list(REMOVE_DUPLICATES mauve_runpath)
foreach(program mauved mauvectl mauve_stamp mauve_guardian)
  if(TARGET ${program} AND NOT CMAKE_SKIP_INSTALL_RPATH)
    set_target_properties(${program} PROPERTIES
      INSTALL_RPATH "${mauve_runpath}" BUILD_WITH_INSTALL_RPATH ON)
  endif()
endforeach()
if(TARGET mauved)
  install(TARGETS mauved mauve_guardian RUNTIME DESTINATION "${CMAKE_INSTALL_SBINDIR}" COMPONENT runtime)
endif()
if(TARGET mauvectl)
  install(TARGETS mauvectl RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT runtime)
endif()
install(TARGETS mauve_runtime mauve_serial mauve_playback mauve_stamp EXPORT mauveTargets
  ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT dev
  LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT runtime NAMELINK_COMPONENT dev
  RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT dev)

# Plugins of plugins/, and the headers of their types and contracts.
get_property(mauve_plugins GLOBAL PROPERTY MAUVE_PLUGIN_TARGETS)
foreach(plugin ${mauve_plugins})
  get_target_property(folder ${plugin} SOURCE_DIR)
  if(folder MATCHES "^${mauve_sources}/plugins(/|$)")
    set(component plugins)
    if(plugin STREQUAL ros)
      set(component ros1)  # its libraries are wanted on robots with ROS 1 only
    elseif(plugin STREQUAL demo)
      set(component runtime)  # etc/minimal.json, which the service starts with, has a component of it
    endif()
    install(TARGETS ${plugin} LIBRARY DESTINATION "${MAUVE_PLUGIN_SUBDIR}" COMPONENT ${component})
  endif()
endforeach()
foreach(pattern types/*.h guidance/control.h guidance/guidance.h guidance/obstacles.h drivers/*/*driver*.h
    drivers/recording/csv_recording.h drivers/recording/playback.h navigation/regular_file.h)
  file(GLOB headers CONFIGURE_DEPENDS RELATIVE "${mauve_sources}/plugins"
    "${mauve_sources}/plugins/${pattern}")
  foreach(header ${headers})
    get_filename_component(folder "${header}" DIRECTORY)
    install(FILES "${mauve_sources}/plugins/${header}"
      DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/mauve-plugins/${folder}" COMPONENT dev)
  endforeach()
endforeach()

# Debug information beside what was installed so far. Packages have none of it.
if(CMAKE_OBJCOPY AND CMAKE_OBJDUMP)
  install(CODE "
    set(MAUVE_OBJCOPY \"${CMAKE_OBJCOPY}\")
    set(MAUVE_OBJDUMP \"${CMAKE_OBJDUMP}\")
    include(\"${CMAKE_CURRENT_LIST_DIR}/split_debug.cmake\")")
endif()

# The SDK.
install(DIRECTORY "${mauve_sources}/libruntime/include/mauve" "${mauve_sources}/serial/include/mauve"
  DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT dev FILES_MATCHING PATTERN "*.h")
install(EXPORT mauveTargets NAMESPACE mauve:: DESTINATION "${mauve_cmake_dir}" COMPONENT dev)
configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/mauveConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/package/mauveConfig.cmake" INSTALL_DESTINATION "${mauve_cmake_dir}"
  PATH_VARS CMAKE_INSTALL_INCLUDEDIR MAUVE_PLUGIN_SUBDIR)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/package/mauveConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/package/mauveConfig.cmake"
  "${PROJECT_BINARY_DIR}/package/mauveConfigVersion.cmake"
  "${CMAKE_CURRENT_LIST_DIR}/MauvePlugin.cmake" "${CMAKE_CURRENT_LIST_DIR}/mauve_plugin.map"
  "${CMAKE_CURRENT_LIST_DIR}/member_names.py"
  DESTINATION "${mauve_cmake_dir}" COMPONENT dev)
# The prefix is known only at install time (cmake --install --prefix), so mauve.pc is written then. pkg-config leaves the
# folders of the system out of its answer only where they are written as such; another prefix may be moved as a whole.
install(CODE "
  set(mauve_pc_libdir \"${CMAKE_INSTALL_LIBDIR}\")
  set(mauve_pc_includedir \"${CMAKE_INSTALL_INCLUDEDIR}\")
  set(mauve_pc_prefix \"\${CMAKE_INSTALL_PREFIX}\")
  if(NOT CMAKE_INSTALL_PREFIX STREQUAL \"/usr\")
    file(RELATIVE_PATH up \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_LIBDIR}/pkgconfig\" \"\${CMAKE_INSTALL_PREFIX}\")
    set(mauve_pc_prefix \"\\\${pcfiledir}/\${up}\")
  endif()
  set(PROJECT_DESCRIPTION \"${PROJECT_DESCRIPTION}\")
  set(PROJECT_VERSION \"${PROJECT_VERSION}\")
  configure_file(\"${CMAKE_CURRENT_LIST_DIR}/mauve.pc.in\" \"${PROJECT_BINARY_DIR}/package/mauve.pc\" @ONLY)"
  COMPONENT dev)
install(FILES "${PROJECT_BINARY_DIR}/package/mauve.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT dev)

# Example architectures and the schema. The service's own file is never overwritten.
file(GLOB mauve_examples CONFIGURE_DEPENDS "${mauve_sources}/etc/*.json")
set(mauve_plain ${mauve_examples})
list(FILTER mauve_plain INCLUDE REGEX "/(minimal|architecture.schema)[.]json$")  # without a plugin of package plugins
list(REMOVE_ITEM mauve_examples ${mauve_plain})
install(FILES ${mauve_plain} DESTINATION "${CMAKE_INSTALL_DATADIR}/mauve" COMPONENT runtime)
install(FILES ${mauve_examples} DESTINATION "${CMAKE_INSTALL_DATADIR}/mauve" COMPONENT plugins)
foreach(folder maps samples)
  if(EXISTS "${mauve_sources}/etc/${folder}")
    install(DIRECTORY "${mauve_sources}/etc/${folder}" DESTINATION "${CMAKE_INSTALL_DATADIR}/mauve" COMPONENT plugins
      USE_SOURCE_PERMISSIONS)
  endif()
endforeach()
if(EXISTS "${mauve_sources}/etc/minimal.json")
  install(CODE "
    set(folder \"\${CMAKE_INSTALL_PREFIX}/etc/mauve\")
    if(CMAKE_INSTALL_PREFIX MATCHES \"^/usr(/local)?$\")
      set(folder /etc/mauve)
    endif()
    set(file \"\$ENV{DESTDIR}\${folder}/architecture.json\")
    if(EXISTS \"\${file}\")
      message(STATUS \"Kept: \${file}\")
    else()
      message(STATUS \"Installing: \${file}\")
      configure_file(\"${mauve_sources}/etc/minimal.json\" \"\${file}\" COPYONLY)
    endif()" COMPONENT runtime)
endif()

# Whole projects, to be read, copied, and written under another name by `mauvectl new`.
install(DIRECTORY "${mauve_sources}/examples" DESTINATION "${CMAKE_INSTALL_DATADIR}/mauve" COMPONENT dev
  PATTERN build EXCLUDE)

# The services. The prefix is known only at install time; the units in the sources say /usr. In a unit, a program whose
# path has a space stands in quotes, and "%" is written twice.
foreach(name mauved mauve-guardian)
  set(unit "${PROJECT_BINARY_DIR}/package/${name}.service")
  install(CODE "
    file(READ \"${mauve_sources}/systemd/${name}.service\" unit)
    set(folder \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_SBINDIR}\")
    set(quote)
    if(folder MATCHES \"[ \\t]\")
      set(quote \"\\\"\")
    endif()
    string(REPLACE \"%\" \"%%\" folder \"\${folder}\")
    string(REGEX REPLACE \"=/usr/sbin/([a-z-]+)\" \"=\${quote}\${folder}/\\\\1\${quote}\" unit \"\${unit}\")
    file(WRITE \"${unit}\" \"\${unit}\")" COMPONENT runtime)
  install(FILES "${unit}" DESTINATION "${MAUVE_SYSTEMD_DIR}/systemd/system" COMPONENT runtime)
endforeach()
foreach(pair "socket:systemd/system" "sysusers:sysusers.d" "tmpfiles:tmpfiles.d")
  string(REGEX MATCH "^([^:]+):(.+)$" pair "${pair}")
  set(kind "${CMAKE_MATCH_1}")
  set(folder "${MAUVE_SYSTEMD_DIR}/${CMAKE_MATCH_2}")
  set(file "${mauve_sources}/systemd/mauved.${kind}")
  if(EXISTS "${file}.in")
    configure_file("${file}.in" "${PROJECT_BINARY_DIR}/package/mauved.${kind}" @ONLY)
    set(file "${PROJECT_BINARY_DIR}/package/mauved.${kind}")
  endif()
  if(EXISTS "${file}")
    set(name "mauved.${kind}")
    if(kind MATCHES "sysusers|tmpfiles")
      set(name "mauve.conf")
    endif()
    install(FILES "${file}" DESTINATION "${folder}" COMPONENT runtime RENAME "${name}")
  endif()
endforeach()

file(GLOB mauve_drop_ins CONFIGURE_DEPENDS "${mauve_sources}/systemd/*.conf")
if(mauve_drop_ins)
  # To be copied to /etc/systemd/system/mauved.service.d/ by those who need them.
  install(FILES ${mauve_drop_ins} DESTINATION "${CMAKE_INSTALL_DOCDIR}/systemd" COMPONENT runtime)
endif()

# Completion, licence.
set(scripts "${mauve_sources}/ctl/completion")
install(FILES "${scripts}/mauvectl.bash"
  DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions" COMPONENT runtime RENAME mauvectl)
install(FILES "${scripts}/mauvectl.zsh"
  DESTINATION "${CMAKE_INSTALL_DATADIR}/zsh/site-functions" COMPONENT runtime RENAME _mauvectl)
install(FILES "${scripts}/mauvectl.fish"
  DESTINATION "${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d" COMPONENT runtime)
install(FILES "${mauve_sources}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}")
