# SPDX-License-Identifier: MIT
#
# Tests of the build itself: layers, headers on their own, install and embed, the README's snippets.

# A wrong include arrow fails; and the checker itself is proven able to fail, one rule at a time.
add_test(NAME layers COMMAND ${CMAKE_COMMAND} -D ROOT=${PROJECT_SOURCE_DIR}
  -P ${CMAKE_CURRENT_LIST_DIR}/check_layers.cmake)
add_test(NAME layers_can_fail COMMAND ${CMAKE_COMMAND} -D WORK=${CMAKE_CURRENT_BINARY_DIR}/layers_can_fail
  -P ${CMAKE_CURRENT_LIST_DIR}/check_layers_selftest.cmake)

# Floating numbers become integers through one door.
add_test(NAME casts COMMAND ${CMAKE_COMMAND} -D ROOT=${PROJECT_SOURCE_DIR} -P ${CMAKE_CURRENT_LIST_DIR}/check_casts.cmake)
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/casts_can_fail/src/a.cpp "int f(double x) { return static_cast<int>(std::floor(x)); }\n")
add_test(NAME casts_can_fail COMMAND ${CMAKE_COMMAND} -D ROOT=${CMAKE_CURRENT_BINARY_DIR}/casts_can_fail
  -P ${CMAKE_CURRENT_LIST_DIR}/check_casts.cmake)
set_tests_properties(casts_can_fail PROPERTIES WILL_FAIL ON)

# What is compiled for wide registers shares no function with the rest.
if(CMAKE_NM AND NOT CMAKE_CXX_FLAGS MATCHES "fsanitize" AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64|amd64")
  foreach(set IN ITEMS avx2 avx512)
    add_test(NAME simd_symbols_${set} COMMAND ${CMAKE_COMMAND} -D NM=${CMAKE_NM} -D SET=${set}
      -D "OBJECT=$<FILTER:$<TARGET_OBJECTS:alcap>,INCLUDE,/src/simd/${set}[.]cpp>"
      -P ${CMAKE_CURRENT_LIST_DIR}/check_simd_symbols.cmake)
  endforeach()
  add_test(NAME simd_symbols_can_fail COMMAND ${CMAKE_COMMAND} -D NM=${CMAKE_NM} -D SET=avx2
    -D "OBJECT=$<FILTER:$<TARGET_OBJECTS:alcap>,INCLUDE,/src/simd/dispatch[.]cpp>"
    -P ${CMAKE_CURRENT_LIST_DIR}/check_simd_symbols.cmake)
  set_tests_properties(simd_symbols_can_fail PROPERTIES WILL_FAIL ON)
endif()

# alcap.h includes every public header.
add_test(NAME umbrella_is_complete COMMAND ${CMAKE_COMMAND} -D ROOT=${PROJECT_SOURCE_DIR}
  -P ${CMAKE_CURRENT_LIST_DIR}/check_umbrella.cmake)

# Every public header compiles alone and twice. Compiling is the test, so a mistake here fails the build.
file(GLOB alcap_public_headers RELATIVE ${PROJECT_SOURCE_DIR}/include CONFIGURE_DEPENDS
  ${PROJECT_SOURCE_DIR}/include/alcap/*.h)
set(alcap_header_sources)
foreach(header IN LISTS alcap_public_headers)
  string(MAKE_C_IDENTIFIER ${header} id)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/headers/${id}.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT "#include \"@header@\"\n#include \"@header@\"\n" @ONLY)
  list(APPEND alcap_header_sources ${source})
endforeach()
add_library(alcap_headers_alone OBJECT ${alcap_header_sources})
alcap_private_flags(alcap_headers_alone)
target_compile_options(alcap_headers_alone PRIVATE -O0)
target_link_libraries(alcap_headers_alone PRIVATE alcap::alcap TBB::tbb)

# What benchmarks are judged by: which differences count, and the table of targets.
find_program(ALCAP_PYTHON python3)
mark_as_advanced(ALCAP_PYTHON)
if(ALCAP_PYTHON)
  add_test(NAME bench_scripts COMMAND ${ALCAP_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/bench_scripts.py)
  # Types of one name in one namespace, which no compiler sees together.
  add_test(NAME one_definition COMMAND ${ALCAP_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/one_definition.py include kernels solvers
    src apps WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  add_test(NAME one_definition_selftest COMMAND ${ALCAP_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/one_definition.py --selftest)
endif()

# Users of the library: one finds it installed, one embeds its sources. Both inherit how this build was made.
find_program(ALCAP_PKG_CONFIG pkg-config)
mark_as_advanced(ALCAP_PKG_CONFIG)
string(TOUPPER "${CMAKE_BUILD_TYPE}" config_upper)
set(consumer_settings
  -D CXX=${CMAKE_CXX_COMPILER} -D LAUNCHER=$<IF:$<BOOL:${ALCAP_CCACHE}>,${ALCAP_CCACHE},> -D GENERATOR=${CMAKE_GENERATOR}
  -D CONFIG=$<CONFIG> -D "FLAGS=${CMAKE_CXX_FLAGS}" -D "FLAGS_CONFIG=${CMAKE_CXX_FLAGS_${config_upper}}"
  -D WITH_CHOLMOD=${ALCAP_WITH_CHOLMOD} -D NATIVE=${ALCAP_NATIVE} -D SHARED=${BUILD_SHARED_LIBS} -D WERROR=${ALCAP_WARNINGS_AS_ERRORS}
  -D ALCAP_SOURCE=${PROJECT_SOURCE_DIR} -D ALCAP_BUILD=${PROJECT_BINARY_DIR} -D ALCAP_VERSION=${PROJECT_VERSION}
  -D PKG_CONFIG=${ALCAP_PKG_CONFIG} -D INDEX_64=${ALCAP_INDEX_64} -D NAME=${alcap_name})
foreach(kind IN ITEMS find_package pkg_config subdirectory fetch_content)
  if((kind MATCHES "find_package|pkg_config" AND NOT ALCAP_INSTALL) OR (kind STREQUAL "pkg_config" AND NOT ALCAP_PKG_CONFIG))
    continue()
  endif()
  add_test(NAME consumer_${kind} COMMAND ${CMAKE_COMMAND} ${consumer_settings} -D KIND=${kind}
    -D WORK=${CMAKE_CURRENT_BINARY_DIR}/consumer_${kind} -P ${CMAKE_CURRENT_LIST_DIR}/consumer.cmake)
  set_tests_properties(consumer_${kind} PROPERTIES TIMEOUT 900)
endforeach()

# The version that is cited is that of the project.
add_test(NAME version_is_one COMMAND ${CMAKE_COMMAND} -D ROOT=${PROJECT_SOURCE_DIR} -D VERSION=${PROJECT_VERSION}
  -P ${CMAKE_CURRENT_LIST_DIR}/check_version.cmake)

# The tool is hardened where that was asked for, and the check sees a program that is not.
find_program(ALCAP_READELF readelf)
mark_as_advanced(ALCAP_READELF)
if(TARGET alcap_cli AND ALCAP_HARDENED AND ALCAP_READELF AND CMAKE_BUILD_TYPE STREQUAL "Release"
    AND NOT CMAKE_CXX_FLAGS MATCHES "fsanitize")
  add_test(NAME hardened_binary COMMAND ${CMAKE_COMMAND} -D READELF=${ALCAP_READELF} -D BINARY=$<TARGET_FILE:alcap_cli>
    -P ${CMAKE_CURRENT_LIST_DIR}/check_hardened.cmake)
  add_test(NAME hardened_binary_can_fail COMMAND ${CMAKE_COMMAND} -D READELF=${ALCAP_READELF} -D CXX=${CMAKE_CXX_COMPILER}
    -D WORK=${CMAKE_CURRENT_BINARY_DIR}/hardened -P ${CMAKE_CURRENT_LIST_DIR}/check_hardened_selftest.cmake)
endif()

# A configure without a build type is an optimised build.
add_test(NAME default_build_is_optimised COMMAND ${CMAKE_COMMAND} ${consumer_settings} -D KIND=default_build
  -D WORK=${CMAKE_CURRENT_BINARY_DIR}/default_build -P ${CMAKE_CURRENT_LIST_DIR}/consumer.cmake)

# Every C++ snippet of the README is compiled and run.
include(build/readme_snippets.cmake)

set_tests_properties(layers layers_can_fail umbrella_is_complete version_is_one PROPERTIES LABELS quick)
