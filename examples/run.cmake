# SPDX-License-Identifier: MIT
#
# run.cmake: runs PROGRAM; fails unless its exit code is 0 and its output matches every part of EXPECTED (separated by "|").
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND ${PROGRAM} OUTPUT_VARIABLE output ERROR_VARIABLE errors RESULT_VARIABLE code)
message(STATUS "${output}${errors}")
if(NOT code EQUAL 0)
  message(FATAL_ERROR "${PROGRAM} ended with ${code}")
endif()
string(REPLACE "|" ";" parts "${EXPECTED}")
foreach(part IN LISTS parts)
  if(NOT output MATCHES "${part}")
    message(FATAL_ERROR "'${part}' is not in the output")
  endif()
endforeach()
