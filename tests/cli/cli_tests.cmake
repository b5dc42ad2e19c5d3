# SPDX-License-Identifier: MIT
#
# Tests that run the command line tool as users do and read its JSON, only where the tool is built; and of the logic of
# `alcap tables` without its command line.
if(NOT TARGET alcap_cli)
  return()
endif()
alcap_test_folder(cli alcap_dep_JSON)
target_sources(test_cli PRIVATE ../apps/alcap/tables/tables.cpp ../apps/alcap/tables/tables_harmonics.cpp
  ../apps/alcap/tables/tables_print.cpp ../apps/alcap/tables/tables_published.cpp ../apps/alcap/tables/tables_shapes.cpp)
target_compile_definitions(test_cli PRIVATE ALCAP_CLI="$<TARGET_FILE:alcap_cli>")
add_dependencies(test_cli alcap_cli)
target_sources(test_cli PRIVATE ../apps/alcap/studio/design_lock.cpp ../apps/alcap/studio/passing_file.cpp)
# Calls of the system that go wrong while the tool runs.
if(CMAKE_SYSTEM_NAME STREQUAL "Linux" AND NOT ALCAP_PORTABLE AND NOT CMAKE_CXX_FLAGS MATCHES "fsanitize")
  add_library(alcap_fault_preload MODULE faults/fault_preload.cpp)
  alcap_private_flags(alcap_fault_preload)
  target_compile_options(alcap_fault_preload PRIVATE -U_FORTIFY_SOURCE)
  target_link_libraries(alcap_fault_preload PRIVATE ${CMAKE_DL_LIBS})
  target_compile_definitions(test_cli PRIVATE ALCAP_FAULT_PRELOAD="$<TARGET_FILE:alcap_fault_preload>")
  add_dependencies(test_cli alcap_fault_preload)
endif()

# Pictures are looked at where libpng is; other programs read what the tool writes where they are installed.
get_target_property(alcap_cli_definitions alcap_cli COMPILE_DEFINITIONS)
if("ALCAP_WITH_PICTURES" IN_LIST alcap_cli_definitions)
  find_package(PNG REQUIRED)
  target_link_libraries(test_cli PRIVATE PNG::PNG)
  target_compile_definitions(test_cli PRIVATE ALCAP_TEST_PNG)
endif()
find_package(Python3 QUIET COMPONENTS Interpreter)
if(Python3_FOUND AND ALCAP_HTTPLIB_INCLUDE_DIR)
  add_test(NAME studio_faults COMMAND Python3::Interpreter ${CMAKE_CURRENT_LIST_DIR}/studio_faults.py $<TARGET_FILE:alcap_cli>)
endif()
if(ALCAP_VTK_PYTHON)
  add_test(NAME cli_outputs_read_back
    COMMAND ${ALCAP_VTK_PYTHON} ${CMAKE_CURRENT_LIST_DIR}/read_outputs.py $<TARGET_FILE:alcap_cli>)
  set_tests_properties(cli_outputs_read_back PROPERTIES SKIP_RETURN_CODE 77)
  add_test(NAME cli_matrices_read_back
    COMMAND ${ALCAP_VTK_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/read_matrices.py $<TARGET_FILE:alcap_cli>)
  set_tests_properties(cli_matrices_read_back PROPERTIES SKIP_RETURN_CODE 77)
endif()
