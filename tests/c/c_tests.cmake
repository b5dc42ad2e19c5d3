# SPDX-License-Identifier: MIT
#
# The C interface: from C99, from Python's ctypes, for leaks, and against the recorded binary interface.
if(NOT TARGET alcap_c)
  return()
endif()
enable_language(C)
add_executable(test_c ${CMAKE_CURRENT_LIST_DIR}/test_c.c)
target_compile_options(test_c PRIVATE -std=c99 -pedantic -pedantic-errors -Wall -Wextra -Werror)
target_link_libraries(test_c PRIVATE alcap::alcap_c m)
add_test(NAME c_interface COMMAND test_c ${CMAKE_CURRENT_BINARY_DIR}/test_c.ply)
alcap_test_environment(c_interface)
if(CMAKE_CXX_FLAGS MATCHES "fsanitize")
  set_target_properties(test_c PROPERTIES LINKER_LANGUAGE CXX)  # the library needs the sanitizers' part for C++
  return()
endif()

find_program(ALCAP_VALGRIND valgrind DOC "Finds leaks of the C interface")
mark_as_advanced(ALCAP_VALGRIND)
if(ALCAP_VALGRIND)
  add_test(NAME c_leaks COMMAND ${ALCAP_VALGRIND} -q --leak-check=full --errors-for-leak-kinds=definite --error-exitcode=9
    --suppressions=${CMAKE_CURRENT_LIST_DIR}/valgrind.supp $<TARGET_FILE:test_c> ${CMAKE_CURRENT_BINARY_DIR}/test_c_leaks.ply)
else()
  add_test(NAME c_leaks COMMAND sh -c "echo 'SKIPPED: no valgrind'; exit 77")
endif()
set_tests_properties(c_leaks PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 600)
if(ALCAP_PYTHON)
  add_test(NAME c_from_ctypes COMMAND ${ALCAP_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/test_ctypes.py $<TARGET_FILE:alcap_c>)
  add_test(NAME c_abi COMMAND ${ALCAP_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/abi.py --cc ${CMAKE_C_COMPILER}
    --library $<TARGET_FILE:alcap_c> --nm ${CMAKE_NM} --include ${PROJECT_SOURCE_DIR}/include
    --record ${CMAKE_CURRENT_LIST_DIR}/abi.txt)
  # By abidiff as well, and it sees a parameter of another type.
  set(alcap_changed_header ${CMAKE_CURRENT_BINARY_DIR}/abidiff_can_fail)
  file(READ ${PROJECT_SOURCE_DIR}/include/alcap/alcap_c.h text)
  string(REPLACE "alcap_run_vectors(const alcap_run* run, int32_t k" "alcap_run_vectors(const alcap_run* run, int64_t k" text "${text}")
  file(WRITE ${alcap_changed_header}/alcap/alcap_c.h "${text}")
  foreach(include IN ITEMS ${PROJECT_SOURCE_DIR}/include ${alcap_changed_header})
    set(name c_abidiff)
    if(include STREQUAL "${alcap_changed_header}")
      set(name c_abidiff_can_fail)
    endif()
    add_test(NAME ${name} COMMAND ${ALCAP_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/abidiff.py --cc ${CMAKE_C_COMPILER}
      --include ${include} --map ${PROJECT_SOURCE_DIR}/c/alcap_c.map --record ${CMAKE_CURRENT_LIST_DIR}/abi.abixml)
    set_tests_properties(${name} PROPERTIES SKIP_RETURN_CODE 77)
  endforeach()
  set_tests_properties(c_abidiff_can_fail PROPERTIES WILL_FAIL ON)
endif()
