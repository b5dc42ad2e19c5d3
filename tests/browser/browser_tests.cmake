# SPDX-License-Identifier: MIT
#
# The pages in a real browser: skipped, with a line that says why, where Chromium or npm is missing.
if(TARGET alcap_cli)
  add_test(NAME browser COMMAND ${CMAKE_CURRENT_LIST_DIR}/run.sh $<TARGET_FILE:alcap_cli>
    ${CMAKE_CURRENT_BINARY_DIR}/browser)
  set_tests_properties(browser PROPERTIES SKIP_RETURN_CODE 77 LABELS browser TIMEOUT 3600 RUN_SERIAL ON)
endif()
