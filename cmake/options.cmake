# Options and defaults; nothing here leaks into a parent project.
if(PROJECT_IS_TOP_LEVEL AND NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Debug, Release, RelWithDebInfo or MinSizeRel" FORCE)
endif()

option(ALCAP_BUILD_APPS "Build the command line tool" ${PROJECT_IS_TOP_LEVEL})
option(ALCAP_BUILD_TESTS "Build the tests" ${PROJECT_IS_TOP_LEVEL})
option(ALCAP_BUILD_PERF "Build the benchmarks" OFF)
option(ALCAP_WITH_CHOLMOD "Direct solves through SuiteSparse CHOLMOD (Eigen otherwise)" ON)
option(ALCAP_NATIVE "Compile for this machine only (-march=native)" OFF)
option(ALCAP_WARNINGS_AS_ERRORS "Fail on compiler warnings" OFF)
