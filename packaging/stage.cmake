# SPDX-License-Identifier: LGPL-3.0-or-later
# Run by cpack when the files of all packages are in their folders: what Debian wants beyond `cmake --install`.
# Manual pages and changelogs are compressed, each package has its copyright, zsh finds the completion, and the folder of
# mauve-doc leads to the site.
set(ENV{SOURCE_DATE_EPOCH} "$ENV{SOURCE_DATE_EPOCH}")
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)

function(compress)
  execute_process(COMMAND gzip --best --no-name --force ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

set(version "${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}")
foreach(component ${CPACK_COMPONENTS_ALL})
  set(package "mauve-${component}")
  if(component STREQUAL runtime)
    set(package mauve)
  endif()
  set(share "${CPACK_TEMPORARY_DIRECTORY}/${component}${CPACK_INSTALL_PREFIX}/share")
  set(doc "${share}/doc/${package}")
  file(COPY "${CPACK_MAUVE_SOURCE_DIR}/packaging/copyright" DESTINATION "${doc}")
  file(COPY_FILE "${CPACK_MAUVE_SOURCE_DIR}/CHANGELOG.md" "${doc}/changelog")
  file(WRITE "${doc}/changelog.Debian" "mauve (${version}) unstable; urgency=medium\n
  * Packages of mauve ${CPACK_PACKAGE_VERSION}; its changes are in changelog.gz.\n
 -- ${CPACK_PACKAGE_CONTACT}  ${date}\n")
  compress("${doc}/changelog" "${doc}/changelog.Debian")
  file(GLOB pages "${share}/man/*/*.[1-9]")
  if(pages)
    compress(${pages})
  endif()
  if(package STREQUAL mauve-doc)
    file(CREATE_LINK ../mauve/html "${doc}/html" SYMBOLIC)
  endif()
  if(EXISTS "${share}/zsh/site-functions")
    file(RENAME "${share}/zsh/site-functions" "${share}/zsh/vendor-completions")
  endif()
endforeach()
