# SPDX-License-Identifier: MIT
#
# A file compiled for wide registers defines functions in its own namespace only: the linker keeps one copy of an inline
# function, and must never put this one where machines without those registers call it.
#   cmake -D NM=nm -D SET=avx2 -D OBJECT=avx2.cpp.o -P check_simd_symbols.cmake
execute_process(COMMAND ${NM} -C --defined-only ${OBJECT} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
string(REGEX REPLACE "[][;]" "." symbols "${symbols}")
string(REPLACE "\n" ";" symbols "${symbols}")
set(functions 0)
foreach(symbol IN LISTS symbols)
  if(NOT symbol MATCHES "^[0-9a-f]+ [TW] (.*)$")
    continue()
  endif()
  set(name "${CMAKE_MATCH_1}")
  math(EXPR functions "${functions} + 1")
  if(NOT name MATCHES "simd::${SET}::")
    message(SEND_ERROR "${OBJECT} defines ${name}, which other files could share")
  endif()
endforeach()
if(functions EQUAL 0)
  message(SEND_ERROR "${OBJECT} defines no function at all")
endif()
message(STATUS "${functions} functions, all in simd::${SET}")
