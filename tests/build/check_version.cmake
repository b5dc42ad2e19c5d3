# SPDX-License-Identifier: MIT
#
# CITATION.cff names the version of project(alcap VERSION ...): cmake -D ROOT=. -D VERSION=1.2.3 -P check_version.cmake
file(STRINGS ${ROOT}/CITATION.cff line REGEX "^version: ")
if(NOT line STREQUAL "version: ${VERSION}")
  message(FATAL_ERROR "CITATION.cff says '${line}', and the project has version ${VERSION}")
endif()
