# SPDX-License-Identifier: MIT
#
# Headers of others that most files of a target include, compiled once a target: a second of every file is Eigen alone.
# Only a shorter build: a file still includes what it uses, which builds without unity (preset dev, clang-tidy) hold it to.
# Sources with flags of their own for floating point (src/simd/) take no part.
set(alcap_common_headers
  <algorithm> <array> <atomic> <charconv> <cmath> <complex> <cstdint> <filesystem> <functional> <limits> <map> <memory>
  <mutex> <numeric> <optional> <set> <span> <sstream> <string> <string_view> <unordered_map> <utility> <vector>
  <Eigen/Core> <Eigen/Geometry> <Eigen/SparseCore>)

# alcap_precompile(target headers...): these and the common ones.
function(alcap_precompile target)
  if(NOT ALCAP_UNITY)
    return()
  endif()
  target_precompile_headers(${target} PRIVATE ${ARGN} ${alcap_common_headers})
  # gcc 12 loses which functions of strings are the system's once they are inlined from here, and warns of what they do.
  # Builds without unity keep these warnings.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-stringop-overflow -Wno-stringop-overread -Wno-array-bounds)
  endif()
endfunction()

# alcap_precompile_like(target other): the headers as `other` has compiled them; the flags of both must be the same.
function(alcap_precompile_like target other)
  if(ALCAP_UNITY)
    target_precompile_headers(${target} REUSE_FROM ${other})
  endif()
endfunction()
