# SPDX-License-Identifier: MIT
#
# What alcap is built from, and the Debian package that brings each part. Only Eigen is seen by users of the
# library; the header-only rest is needed to compile alcap and not afterwards.

# alcap_headers(NAME header package): finds a header-only library without relying on its CMake files, as the
# interface target alcap_dep_NAME. Used privately, so never exported.
function(alcap_headers name header package)
  find_path(ALCAP_${name}_INCLUDE_DIR ${header} DOC "Folder that holds ${header}")
  mark_as_advanced(ALCAP_${name}_INCLUDE_DIR)
  if(NOT ALCAP_${name}_INCLUDE_DIR)
    message(FATAL_ERROR "alcap: <${header}> was not found. On Debian: apt-get install ${package}\n"
                        "Elsewhere, pass -DALCAP_${name}_INCLUDE_DIR=FOLDER.")
  endif()
  add_library(alcap_dep_${name} INTERFACE IMPORTED)
  set_target_properties(alcap_dep_${name} PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES ${ALCAP_${name}_INCLUDE_DIR})
endfunction()

# alcap_package(package find_package-arguments...): find_package that says what to install.
macro(alcap_package package)
  find_package(${ARGN})
  if(NOT ${ARGV1}_FOUND)
    message(FATAL_ERROR "alcap: ${ARGV1} was not found. On Debian: apt-get install ${package}")
  endif()
endmacro()

list(APPEND CMAKE_MODULE_PATH ${CMAKE_CURRENT_LIST_DIR})  # FindCHOLMOD; this directory's scope only
alcap_package(libeigen3-dev Eigen3 3.4 NO_MODULE QUIET)
alcap_package(libtbb-dev TBB QUIET)
if(ALCAP_WITH_CHOLMOD)
  alcap_package("libsuitesparse-dev (or configure with -DALCAP_WITH_CHOLMOD=OFF)" CHOLMOD QUIET)
endif()
alcap_headers(SPECTRA Spectra/SymEigsBase.h libspectra-dev)
alcap_headers(FAST_FLOAT fast_float/fast_float.h libfast-float-dev)
alcap_headers(JSON nlohmann/json.hpp nlohmann-json3-dev)
