# SPDX-License-Identifier: LGPL-3.0-or-later
# The house rules as build targets.
find_package(Python3 REQUIRED COMPONENTS Interpreter)

# A forbidden include fails every build, not a review.
add_custom_target(layers ALL
  COMMAND Python3::Interpreter "${PROJECT_SOURCE_DIR}/scripts/layers.py" "${PROJECT_SOURCE_DIR}"
  COMMENT "Checking that includes follow the arrows" VERBATIM)

# header_check: headers compile alone. Read by the clang stage of scripts/test, not built by default. Those that
# authors of components include each time; all others (six minutes more) with scripts/test --long.
option(MAUVE_CHECK_ALL_HEADERS "header_check holds the headers of the inside too" OFF)
set(mauve_header_places libruntime/include/*.h serial/*.h plugins/types/*.h)
if(MAUVE_CHECK_ALL_HEADERS)
  set(mauve_header_places libruntime/*.h serial/*.h daemon/*.h ctl/*.h man/*.h plugins/*.h)
endif()
file(GLOB_RECURSE mauve_headers CONFIGURE_DEPENDS RELATIVE "${PROJECT_SOURCE_DIR}" ${mauve_header_places})
if(NOT TARGET ros)
  list(REMOVE_ITEM mauve_headers plugins/ros/conversions.h)  # needs ROS 1
endif()
set(mauve_header_units)
foreach(header ${mauve_headers})
  set(unit "${PROJECT_BINARY_DIR}/header_check/${header}.cpp")
  file(CONFIGURE OUTPUT "${unit}" CONTENT "#include \"${PROJECT_SOURCE_DIR}/${header}\"\n")
  list(APPEND mauve_header_units "${unit}")
endforeach()
if(mauve_header_units)
  find_package(Eigen3 QUIET NO_MODULE)
  add_library(header_check OBJECT EXCLUDE_FROM_ALL ${mauve_header_units})
  set_target_properties(header_check PROPERTIES UNITY_BUILD OFF)
  target_link_libraries(header_check PRIVATE mauve::internal mauve::serial mauve_warnings
    nlohmann_json::nlohmann_json $<TARGET_NAME_IF_EXISTS:Eigen3::Eigen>
    $<TARGET_NAME_IF_EXISTS:mauve_ros_headers>)
  target_include_directories(header_check PRIVATE daemon ctl plugins)
  target_compile_definitions(header_check PRIVATE
    MAUVE_PLUGIN_NAME="header_check" MAUVE_PLUGIN_VERSION="0.0.0")
endif()
