# SPDX-License-Identifier: MIT
#
# Tests that run the command line tool as users do and read its JSON, only where the tool is built; and of alcap.h.
add_test(NAME umbrella_is_complete COMMAND ${CMAKE_COMMAND} -D ROOT=${PROJECT_SOURCE_DIR}
  -P ${CMAKE_CURRENT_SOURCE_DIR}/check_umbrella.cmake)
if(NOT TARGET alcap_cli)
  return()
endif()
foreach(topic IN ITEMS cli_batch cli_field cli_bad_input cli_commands cli_design)
  alcap_test(${topic} alcap_dep_JSON)
  target_compile_definitions(test_${topic} PRIVATE ALCAP_CLI="$<TARGET_FILE:alcap_cli>"
    ALCAP_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  add_dependencies(test_${topic} alcap_cli)
endforeach()

# Pictures are looked at where libpng is; other programs read what the tool writes where they are installed.
alcap_test(cli_picture alcap_dep_JSON)
target_compile_definitions(test_cli_picture PRIVATE ALCAP_CLI="$<TARGET_FILE:alcap_cli>")
add_dependencies(test_cli_picture alcap_cli)
get_target_property(alcap_cli_definitions alcap_cli COMPILE_DEFINITIONS)
if("ALCAP_WITH_PICTURES" IN_LIST alcap_cli_definitions)
  find_package(PNG REQUIRED)
  target_link_libraries(test_cli_picture PRIVATE PNG::PNG)
  target_compile_definitions(test_cli_picture PRIVATE ALCAP_TEST_PNG)
endif()
if(ALCAP_VTK_PYTHON)
  add_test(NAME cli_outputs_read_back
    COMMAND ${ALCAP_VTK_PYTHON} ${CMAKE_CURRENT_LIST_DIR}/read_outputs.py $<TARGET_FILE:alcap_cli>)
  set_tests_properties(cli_outputs_read_back PROPERTIES SKIP_RETURN_CODE 77)
endif()
