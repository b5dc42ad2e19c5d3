# SPDX-License-Identifier: MIT
#
# alcap.h includes every public header but those of the C interface and of the programs that run under MPI: cmake -D ROOT=. -P tests/build/check_umbrella.cmake
file(GLOB headers RELATIVE ${ROOT}/include ${ROOT}/include/alcap/*.h)
list(REMOVE_ITEM headers alcap/alcap.h alcap/alcap_c.h alcap/distributed.h alcap/distributed_output.h alcap/distributed_design.h)
file(READ ${ROOT}/include/alcap/alcap.h umbrella)
foreach(header IN LISTS headers)
  string(FIND "${umbrella}" "#include \"${header}\"" at)
  if(at EQUAL -1)
    message(SEND_ERROR "include/alcap/alcap.h does not include ${header}")
  endif()
endforeach()
if(headers STREQUAL "")
  message(SEND_ERROR "no headers were found under ${ROOT}")
endif()
