# SPDX-License-Identifier: MIT
#
# The loops over triangles, angles, faces of the connection and rows of matrices, one copy per instruction set;
# triangle_entries.cpp, angles.cpp, correction_loops.cpp and block_kernels.cpp of src/simd pick one at run time.
# No fused multiply-add: every copy then does the same roundings, so that all machines get the same bits. The loops are
# bound by memory, it costs little.
set(alcap_simd_flags -ffp-contract=off)
set_source_files_properties(src/simd/correction_sse2.cpp src/simd/entries_scalar.cpp src/simd/entries_sse2.cpp
  src/simd/block_sse2.cpp PROPERTIES COMPILE_OPTIONS "${alcap_simd_flags}")
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64|amd64")
  set_source_files_properties(src/simd/correction_avx2.cpp src/simd/entries_avx2.cpp
    src/simd/block_avx2.cpp PROPERTIES COMPILE_OPTIONS "${alcap_simd_flags};-mavx2")
  set_source_files_properties(src/simd/correction_avx512.cpp src/simd/entries_avx512.cpp
    src/simd/block_avx512.cpp PROPERTIES COMPILE_OPTIONS
    "${alcap_simd_flags};-mavx512f;-mavx512dq;-mavx512vl;-mprefer-vector-width=512")
endif()
