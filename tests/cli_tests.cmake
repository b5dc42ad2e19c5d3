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
