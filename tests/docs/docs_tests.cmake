# SPDX-License-Identifier: MIT
#
# Tests of the pages: links, files, names, tests and programs that they show; and that Doxygen builds the site without a
# warning, undocumented public names included. docs_site is skipped, and says so, where Doxygen is missing.
if(ALCAP_PYTHON)
  add_test(NAME docs_pages COMMAND ${ALCAP_PYTHON} -B ${PROJECT_SOURCE_DIR}/scripts/docs_check.py)
  add_test(NAME docs_pages_can_fail COMMAND ${ALCAP_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/docs_check_selftest.py)
  add_test(NAME accuracy_script COMMAND ${ALCAP_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/accuracy_selftest.py)
  add_test(NAME docs_site COMMAND ${PROJECT_SOURCE_DIR}/scripts/docs.sh --check ${CMAKE_CURRENT_BINARY_DIR}/docs)
  set_tests_properties(docs_site PROPERTIES SKIP_RETURN_CODE 3 TIMEOUT 600)
else()
  message(WARNING "alcap: no Python, so the pages are not tested")
endif()
