# SPDX-License-Identifier: MIT
#
# Fails where a floating number becomes an integer other than through src/base/numbers.h (to_integer, rounded): such a
# cast has no defined result for NaN and for numbers out of range. Finds roundings to integers, and casts of expressions
# that are floating by their looks; -fsanitize=float-cast-overflow (the preset asan) finds the rest at run time.
#
#   cmake -D ROOT=. -P tests/build/check_casts.cmake
file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/src/*.cpp ${ROOT}/src/*.h ${ROOT}/apps/*.cpp ${ROOT}/apps/*.h
  ${ROOT}/solvers/*.cpp ${ROOT}/solvers/*.h ${ROOT}/include/*.h ${ROOT}/c/*.cpp ${ROOT}/c/*.h ${ROOT}/python/src/*.cpp
  ${ROOT}/python/src/*.h)
set(rounds "(^|[^a-zA-Z_])(l?lround|l?lrint)[fl]?\\(")
set(integer "(Index|int|long|unsigned|char|std::size_t|size_t|std::u?int[0-9]+_t|std::ptrdiff_t|Eigen::Index)")
set(floating "std::(floor|ceil|round|nearbyint|trunc|sqrt|pow|exp2?|log2?|hypot|fmod)\\(|[^();]*([0-9][.][0-9]|[0-9]e[0-9])")
set(found 0)
foreach(file IN LISTS files)
  if(file STREQUAL "src/base/numbers.h")
    continue()
  endif()
  file(STRINGS ${ROOT}/${file} lines)
  foreach(line IN LISTS lines)
    if(line MATCHES "${rounds}" OR line MATCHES "static_cast<${integer}>\\((${floating})")
      message("${file}: ${line}")
      math(EXPR found "${found} + 1")
    endif()
  endforeach()
endforeach()
if(found GREATER 0)
  message(FATAL_ERROR "${found} casts of floating numbers to integers that are not checked; use detail::to_integer or detail::rounded")
endif()
