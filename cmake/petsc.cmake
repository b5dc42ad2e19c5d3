# SPDX-License-Identifier: MIT
#
# alcap::petsc, the backends by PETSc and SLEPc (alcap/petsc.h), and alcap::distributed, fields over many machines
# (alcap/distributed.h), in libraries of their own: alcap itself knows no MPI.
# ALCAP_WITH_PETSC=AUTO builds it where both are found, as complex builds. PETSC_DIR and SLEPC_DIR (variables or
# environment) say where; Debian's folders are known.

# alcap_find_petsc(): sets ALCAP_PETSC_FOUND.
function(alcap_find_petsc)
  set(ALCAP_PETSC_FOUND OFF PARENT_SCOPE)
  set(petsc_hints ${PETSC_DIR} $ENV{PETSC_DIR} /usr/lib/petscdir/petsc-complex)
  set(slepc_hints ${SLEPC_DIR} $ENV{SLEPC_DIR} /usr/lib/slepcdir/slepc-complex)
  find_path(ALCAP_PETSC_INCLUDE_DIR petscksp.h HINTS ${petsc_hints} PATH_SUFFIXES include)
  find_path(ALCAP_SLEPC_INCLUDE_DIR slepceps.h HINTS ${slepc_hints} PATH_SUFFIXES include)
  find_library(ALCAP_PETSC_LIBRARY NAMES petsc_complex petsc HINTS ${petsc_hints} PATH_SUFFIXES lib)
  find_library(ALCAP_SLEPC_LIBRARY NAMES slepc_complex slepc HINTS ${slepc_hints} PATH_SUFFIXES lib)
  mark_as_advanced(ALCAP_PETSC_INCLUDE_DIR ALCAP_SLEPC_INCLUDE_DIR ALCAP_PETSC_LIBRARY ALCAP_SLEPC_LIBRARY)
  if(NOT ALCAP_PETSC_INCLUDE_DIR OR NOT ALCAP_SLEPC_INCLUDE_DIR OR NOT ALCAP_PETSC_LIBRARY OR NOT ALCAP_SLEPC_LIBRARY)
    return()
  endif()
  file(STRINGS ${ALCAP_PETSC_INCLUDE_DIR}/petscconf.h complex REGEX "define PETSC_USE_COMPLEX 1")
  file(STRINGS ${ALCAP_PETSC_INCLUDE_DIR}/petscconf.h wide REGEX "define PETSC_USE_64BIT_INDICES 1")
  find_package(MPI COMPONENTS CXX QUIET)
  if(complex AND NOT wide AND MPI_CXX_FOUND)
    set(ALCAP_PETSC_FOUND ON PARENT_SCOPE)
    set(MPI_CXX_INCLUDE_DIRS ${MPI_CXX_INCLUDE_DIRS} PARENT_SCOPE)
    set(MPI_CXX_LIBRARIES ${MPI_CXX_LIBRARIES} PARENT_SCOPE)
  endif()
endfunction()

# MPI keeps memory of its own, which sanitizers take for leaks.
if(ALCAP_WITH_PETSC STREQUAL "AUTO" AND CMAKE_CXX_FLAGS MATCHES "fsanitize")
  return()
endif()
alcap_find_petsc()
if(NOT ALCAP_PETSC_FOUND)
  set(alcap_petsc_missing "PETSc and SLEPc (complex builds, 32-bit indices) with MPI were not found. On Debian: "
    "apt-get install libpetsc-complex3.18-dev libslepc-complex3.18-dev")
  if(ALCAP_WITH_PETSC STREQUAL "AUTO")
    message(STATUS "alcap: no PETSc backends: " ${alcap_petsc_missing})
    return()
  endif()
  message(FATAL_ERROR "alcap: " ${alcap_petsc_missing})
endif()

file(GLOB alcap_petsc_sources CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} solvers/petsc/*.cpp)
add_library(alcap_petsc ${alcap_petsc_sources})
add_library(alcap::petsc ALIAS alcap_petsc)
alcap_private_flags(alcap_petsc)
alcap_harden(alcap_petsc)
target_include_directories(alcap_petsc SYSTEM PRIVATE
  ${ALCAP_PETSC_INCLUDE_DIR} ${ALCAP_SLEPC_INCLUDE_DIR} ${MPI_CXX_INCLUDE_DIRS})
# MPI's old C++ interface is not wanted.
target_compile_definitions(alcap_petsc PRIVATE OMPI_SKIP_MPICXX MPICH_SKIP_MPICXX PETSC_SKIP_CXX_COMPLEX_FIX)
target_link_libraries(alcap_petsc
  PUBLIC alcap PRIVATE TBB::tbb ${ALCAP_SLEPC_LIBRARY} ${ALCAP_PETSC_LIBRARY} ${MPI_CXX_LIBRARIES})
set_target_properties(alcap_petsc PROPERTIES
  EXPORT_NAME petsc VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
if(ALCAP_INSTALL)
  install(TARGETS alcap_petsc EXPORT alcapTargets)
endif()

file(GLOB alcap_distributed_sources CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} src/distributed/*.cpp)
add_library(alcap_distributed ${alcap_distributed_sources})
add_library(alcap::distributed ALIAS alcap_distributed)
alcap_private_flags(alcap_distributed)
alcap_harden(alcap_distributed)
target_include_directories(alcap_distributed SYSTEM PRIVATE
  ${ALCAP_PETSC_INCLUDE_DIR} ${ALCAP_SLEPC_INCLUDE_DIR} ${MPI_CXX_INCLUDE_DIRS})
target_compile_definitions(alcap_distributed PRIVATE $<TARGET_PROPERTY:alcap_petsc,COMPILE_DEFINITIONS>)
target_link_libraries(alcap_distributed PUBLIC alcap alcap_petsc
  PRIVATE TBB::tbb $<BUILD_INTERFACE:alcap_dep_JSON> ${ALCAP_SLEPC_LIBRARY} ${ALCAP_PETSC_LIBRARY} ${MPI_CXX_LIBRARIES})
set_target_properties(alcap_distributed PROPERTIES
  EXPORT_NAME distributed VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
if(ALCAP_INSTALL)
  install(TARGETS alcap_distributed EXPORT alcapTargets)
endif()
