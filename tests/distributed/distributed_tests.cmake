# SPDX-License-Identifier: MIT
#
# Tests that run on several ranks: every test_*.cpp of this folder on 1, 2, 3 and 4, however many cores there are.
find_program(ALCAP_MPIRUN NAMES mpirun mpiexec)
mark_as_advanced(ALCAP_MPIRUN)
file(GLOB sources CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} distributed/*.cpp)
add_executable(test_distributed ${sources})
alcap_private_flags(test_distributed)
target_compile_options(test_distributed PRIVATE $<$<CONFIG:Release>:-O1>)
target_include_directories(test_distributed PRIVATE ${DOCTEST_INCLUDE_DIR})
target_include_directories(test_distributed SYSTEM PRIVATE
  ${ALCAP_PETSC_INCLUDE_DIR} ${ALCAP_SLEPC_INCLUDE_DIR} ${MPI_CXX_INCLUDE_DIRS})
target_compile_definitions(test_distributed PRIVATE $<TARGET_PROPERTY:alcap_petsc,COMPILE_DEFINITIONS>)
target_link_libraries(test_distributed PRIVATE alcap::distributed TBB::tbb
  ${ALCAP_SLEPC_LIBRARY} ${ALCAP_PETSC_LIBRARY} ${MPI_CXX_LIBRARIES})

# What Open MPI asks for before it starts more ranks than cores, and as root; idle ranks give their core away. Other MPIs
# do not look at it.
set(alcap_mpi_environment OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
  OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_mpi_yield_when_idle=1 OMPI_MCA_hwloc_base_binding_policy=none
  OMPI_MCA_btl_vader_single_copy_mechanism=none OPENBLAS_NUM_THREADS=1)
list(FILTER sources INCLUDE REGEX "test_.*[.]cpp$")
if(ALCAP_MPIRUN)
  foreach(source IN LISTS sources)
    string(REGEX REPLACE "^.*/test_(.*)\\.cpp$" "\\1" name ${source})
    foreach(ranks RANGE 1 4)
      add_test(NAME ${name}_${ranks} COMMAND ${ALCAP_MPIRUN} -n ${ranks} $<TARGET_FILE:test_distributed> --source-file=*/${source})
      set_tests_properties(${name}_${ranks} PROPERTIES ENVIRONMENT "${alcap_mpi_environment}" TIMEOUT 300)
    endforeach()
  endforeach()
endif()
if(ALCAP_MPIRUN AND TARGET alcap_mpi)
  foreach(ranks IN ITEMS 2 3)
    add_test(NAME mpi_cli_${ranks} COMMAND ${CMAKE_COMMAND} -D ALCAP=$<TARGET_FILE:alcap_cli> -D ALCAP_MPI=$<TARGET_FILE:alcap_mpi>
      -D MPIRUN=${ALCAP_MPIRUN} -D RANKS=${ranks} -D WORK=${CMAKE_CURRENT_BINARY_DIR}/mpi_cli_${ranks}
      -P ${CMAKE_CURRENT_LIST_DIR}/mpi_cli.cmake)
    set_tests_properties(mpi_cli_${ranks} PROPERTIES ENVIRONMENT "${alcap_mpi_environment}" TIMEOUT 300)
  endforeach()
  if(CMAKE_SYSTEM_NAME STREQUAL "Linux")  # by /proc
    add_test(NAME mpi_killed COMMAND sh ${CMAKE_CURRENT_LIST_DIR}/mpi_killed.sh $<TARGET_FILE:alcap_cli> $<TARGET_FILE:alcap_mpi>
      ${ALCAP_MPIRUN} ${CMAKE_CURRENT_BINARY_DIR}/mpi_killed)
    set_tests_properties(mpi_killed PROPERTIES ENVIRONMENT "${alcap_mpi_environment}" TIMEOUT 120)
  endif()
endif()
