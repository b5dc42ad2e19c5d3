# SPDX-License-Identifier: MIT
#
# Tests of the pages: links, files, names, tests and programs that they show.
if(ALCAP_PYTHON)
  add_test(NAME docs_pages COMMAND ${ALCAP_PYTHON} -B ${PROJECT_SOURCE_DIR}/scripts/docs_check.py)
  add_test(NAME docs_pages_can_fail COMMAND ${ALCAP_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/docs_check_selftest.py)
else()
  message(WARNING "alcap: no Python, so the pages are not tested")
endif()
