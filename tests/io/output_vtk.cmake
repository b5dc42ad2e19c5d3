# SPDX-License-Identifier: MIT
#
# The written .vtp and .ply files, read back by VTK. Debian's VTK belongs to Debian's Python, which need not be the first
# in PATH. Reported as skipped where VTK is missing.
find_program(ALCAP_VTK_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH
  DOC "Python that has VTK (Debian: python3-vtk9), for a test")
find_program(ALCAP_VTK_PYTHON python3)
mark_as_advanced(ALCAP_VTK_PYTHON)
if(ALCAP_VTK_PYTHON AND TARGET test_io)
  add_test(NAME output_vtk
    COMMAND ${ALCAP_VTK_PYTHON} ${CMAKE_CURRENT_LIST_DIR}/read_vtp.py $<TARGET_FILE:test_io>)
  set_tests_properties(output_vtk PROPERTIES SKIP_RETURN_CODE 77)
  alcap_test_environment(output_vtk)
else()
  message(WARNING "alcap: no python3; the .vtp files are not checked with VTK")
endif()
