# SPDX-License-Identifier: MIT
#
# The hot loops, one copy per instruction set; src/simd/dispatch.cpp picks one at run time. No fused multiply-add: every
# copy then does the same roundings, so that all machines get the same bits. The loops are bound by memory, it costs
# little. No precompiled header and no unity build: nothing of other files may be compiled with these flags.
function(alcap_simd_source name)
  set_source_files_properties(src/simd/${name}.cpp PROPERTIES COMPILE_OPTIONS "-ffp-contract=off;${ARGN}"
    SKIP_PRECOMPILE_HEADERS ON SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()
alcap_simd_source(scalar)
alcap_simd_source(portable)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64|amd64")
  alcap_simd_source(avx2 -mavx2)
  alcap_simd_source(avx512 -mavx512f -mavx512dq -mavx512vl -mprefer-vector-width=512)
endif()
