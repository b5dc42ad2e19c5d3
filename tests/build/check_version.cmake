# SPDX-License-Identifier: MIT
#
# CITATION.cff and debian/changelog name the version of project(alcap VERSION ...): cmake -D ROOT=. -D VERSION=1.2.3 -P check_version.cmake
file(STRINGS ${ROOT}/CITATION.cff line REGEX "^version: ")
if(NOT line STREQUAL "version: ${VERSION}")
  message(FATAL_ERROR "CITATION.cff says '${line}', and the project has version ${VERSION}")
endif()
file(STRINGS ${ROOT}/debian/changelog line LIMIT_COUNT 1)
string(REPLACE . \\. pattern "${VERSION}")
if(NOT line MATCHES "^alcap \\(${pattern}-")
  message(FATAL_ERROR "debian/changelog begins with '${line}', and the project has version ${VERSION}")
endif()
