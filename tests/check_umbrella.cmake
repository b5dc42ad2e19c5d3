# SPDX-License-Identifier: MIT
#
# alcap.h includes every public header except parallel.h, which needs TBB: cmake -D ROOT=. -P tests/check_umbrella.cmake
file(GLOB headers RELATIVE ${ROOT}/include ${ROOT}/include/alcap/*.h)
list(REMOVE_ITEM headers alcap/alcap.h alcap/parallel.h)
file(READ ${ROOT}/include/alcap/alcap.h umbrella)
foreach(header IN LISTS headers)
  string(FIND "${umbrella}" "#include \"${header}\"" at)
  if(at EQUAL -1)
    message(SEND_ERROR "include/alcap/alcap.h does not include ${header}")
  endif()
endforeach()
string(FIND "${umbrella}" "alcap/parallel.h" at)
if(NOT at EQUAL -1 OR headers STREQUAL "")
  message(SEND_ERROR "include/alcap/alcap.h includes parallel.h, or no headers were found under ${ROOT}")
endif()
