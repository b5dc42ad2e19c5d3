# SPDX-License-Identifier: MIT
#
# The hot loops, one copy per instruction set; src/simd/dispatch.cpp picks one at run time. No fused multiply-add: every
# copy then does the same roundings, so that all machines get the same bits. The loops are bound by memory, it costs
# little.
set(alcap_simd_flags -ffp-contract=off)
set_source_files_properties(src/simd/scalar.cpp src/simd/portable.cpp PROPERTIES COMPILE_OPTIONS "${alcap_simd_flags}")
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64|amd64")
  set_source_files_properties(src/simd/avx2.cpp PROPERTIES COMPILE_OPTIONS "${alcap_simd_flags};-mavx2")
  set_source_files_properties(src/simd/avx512.cpp PROPERTIES COMPILE_OPTIONS
    "${alcap_simd_flags};-mavx512f;-mavx512dq;-mavx512vl;-mprefer-vector-width=512")
endif()
