# SPDX-License-Identifier: MIT
#
# The Python package: a wheel of this build's module, installed into a fresh environment and tested there. Skipped, and
# says why, where NumPy, SciPy, pytest or pybind11 is missing; not with sanitizers, whose runtime Python does not load.
if(CMAKE_CXX_FLAGS MATCHES "fsanitize")
  return()
endif()
if(TARGET alcap_python)
  add_test(NAME python_package COMMAND ${PROJECT_SOURCE_DIR}/scripts/python.sh --build ${PROJECT_BINARY_DIR}
    --work ${CMAKE_CURRENT_BINARY_DIR}/python_package)
else()
  add_test(NAME python_package COMMAND sh -c "echo 'SKIPPED: this build has no Python package: pybind11 or the headers of Python are missing'; exit 77")
endif()
set_tests_properties(python_package PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 600)
