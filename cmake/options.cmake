# SPDX-License-Identifier: MIT
#
# Options and defaults. Everything global (build type, compiler launcher, compile_commands.json) is set only
# when alcap is the top-level project; a parent project keeps its own.
option(ALCAP_BUILD_APPS "Build the command line tool" ${PROJECT_IS_TOP_LEVEL})
option(ALCAP_BUILD_TESTS "Build the tests" ${PROJECT_IS_TOP_LEVEL})
option(ALCAP_BUILD_EXAMPLES "Build the programs of docs/recipes.md" ${PROJECT_IS_TOP_LEVEL})
option(ALCAP_BUILD_PERF "Build the benchmarks" OFF)
option(ALCAP_INSTALL "Add the install rules" ${PROJECT_IS_TOP_LEVEL})
option(ALCAP_WITH_CHOLMOD "Direct solves through SuiteSparse CHOLMOD (Eigen otherwise)" ON)
option(ALCAP_WITH_PICTURES "Pictures from the command line tool, where OpenGL ES and libpng are found" ON)
option(ALCAP_NATIVE "Compile for this machine only (-march=native), alcap and everything that links it" OFF)
option(ALCAP_UNITY "Compile the files of a folder together: a build from nothing is shorter, one of a single file longer" ON)
option(ALCAP_HARDENED "Stack protector, checked string functions, full RELRO, PIE" ON)
option(ALCAP_WARNINGS_AS_ERRORS "Fail on compiler warnings" OFF)

if(PROJECT_IS_TOP_LEVEL)
  get_property(alcap_multi_config GLOBAL PROPERTY GENERATOR_IS_MULTI_CONFIG)
  if(NOT alcap_multi_config AND NOT CMAKE_BUILD_TYPE)
    message(STATUS "alcap: no build type given, building Release")
    set(CMAKE_BUILD_TYPE Release CACHE STRING "Debug, Release, RelWithDebInfo or MinSizeRel" FORCE)
  endif()
  set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
  find_program(ALCAP_CCACHE ccache DOC "Compiler cache, used when present")
  mark_as_advanced(ALCAP_CCACHE)
  if(ALCAP_CCACHE AND NOT DEFINED CMAKE_CXX_COMPILER_LAUNCHER)
    set(CMAKE_CXX_COMPILER_LAUNCHER ${ALCAP_CCACHE})
  endif()
endif()
