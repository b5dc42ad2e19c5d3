# SPDX-License-Identifier: MIT
#
# Proves that check_hardened.cmake accepts a hardened program, and refuses it once any one flag is taken away:
#   cmake -D CXX=c++ -D READELF=readelf -D WORK=folder -P check_hardened_selftest.cmake
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE ${WORK})
file(WRITE ${WORK}/main.cpp "#include <cstdio>\n#include <cstring>\nint main(int n, char** a) {\n"
  "  char text[64];\n  std::strcpy(text, a[n - 1]);\n  std::printf(\"%s\", text);\n}\n")

# attempt(expected complaint flags...): compiles with the flags and looks at what the check says.
function(attempt complaint)
  execute_process(COMMAND ${CXX} -O2 ${ARGN} ${WORK}/main.cpp -o ${WORK}/program COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${CMAKE_COMMAND} -D READELF=${READELF} -D BINARY=${WORK}/program
    -P ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/check_hardened.cmake RESULT_VARIABLE code ERROR_VARIABLE text)
  if(complaint STREQUAL "none" AND NOT code EQUAL 0)
    message(SEND_ERROR "refused a hardened program: ${text}")
  elseif(NOT complaint STREQUAL "none" AND (code EQUAL 0 OR NOT text MATCHES "${complaint}"))
    message(SEND_ERROR "should have been refused for '${complaint}': ${text}")
  endif()
endfunction()

set(pie -fPIE -pie)
set(relro -Wl,-z,relro)
set(now -Wl,-z,now)
set(stack -fstack-protector-strong)
set(fortify -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=2)
attempt(none ${pie} ${relro} ${now} ${stack} ${fortify})
attempt("PIE" -fno-pie -no-pie ${relro} ${now} ${stack} ${fortify})
attempt("read-only" ${pie} -Wl,-z,norelro ${now} ${stack} ${fortify})
attempt("partial" ${pie} ${relro} -Wl,-z,lazy ${stack} ${fortify})
attempt("executed" ${pie} ${relro} ${now} ${stack} ${fortify} -Wl,-z,execstack)
attempt("stack protector" ${pie} ${relro} ${now} -fno-stack-protector ${fortify})
attempt("FORTIFY" ${pie} ${relro} ${now} ${stack} -U_FORTIFY_SOURCE)
