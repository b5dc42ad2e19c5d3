# SPDX-License-Identifier: MIT
#
# The library target: what it exposes, what it keeps to itself. Included after add_library(alcap ...).

# alcap_private_flags(target): warnings, and the folder that makes "kernels/..." includable, for alcap's own
# targets (library, tool, tests, benchmarks). Never inherited by a target that links alcap.
function(alcap_private_flags target)
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR})
  if(ALCAP_PORTABLE)
    target_compile_definitions(${target} PRIVATE ALCAP_PORTABLE)
  endif()
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wconversion -Wshadow
    $<$<BOOL:${ALCAP_WARNINGS_AS_ERRORS}>:-Werror>)
  # Peaks a fifth higher, and compiles a tenth sooner: gcc's collector waits for 700 MB instead of 128.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE --param=ggc-min-heapsize=700000)
  endif()
  # gcc 12 raises a false alarm on "text" + std::string (its bug 105651).
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-restrict)
  endif()
  # Parallel loops are annotated for ThreadSanitizer by hand; gcc warns about something else (fences) in TBB.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_FLAGS MATCHES "fsanitize=thread")
    target_compile_options(${target} PRIVATE -Wno-tsan)
  endif()
  # The sources ask for sanitizers by the macros of gcc, which clang does not define.
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    foreach(sanitizer IN ITEMS address thread)
      if(CMAKE_CXX_FLAGS MATCHES "fsanitize=[a-z,-]*${sanitizer}")
        string(TOUPPER __SANITIZE_${sanitizer}__ macro)
        # Public: Eigen allocates in another way under it, and both sides of the API must do the same.
        target_compile_definitions(${target} PUBLIC ${macro}=1)
      endif()
    endforeach()
  endif()
endfunction()

# alcap_harden(target): what makes a bug with a broken input file end the program rather than do what the file says: checked
# stack frames and string functions, random addresses, and tables of functions that cannot be written to. Not in
# debug builds and not with sanitizers, which look closer. Test hardened_binary.
function(alcap_harden target)
  if(NOT ALCAP_HARDENED OR CMAKE_CXX_FLAGS MATCHES "fsanitize")
    return()
  endif()
  set(release $<NOT:$<CONFIG:Debug>>)
  target_compile_options(${target} PRIVATE $<${release}:-fstack-protector-strong>)
  if(NOT CMAKE_CXX_FLAGS MATCHES "_FORTIFY_SOURCE")  # a packager's own level stays
    target_compile_options(${target} PRIVATE $<${release}:-U_FORTIFY_SOURCE> $<${release}:-D_FORTIFY_SOURCE=2>)
  endif()
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  if(CMAKE_SYSTEM_NAME STREQUAL "Linux")
    target_link_options(${target} PRIVATE $<${release}:LINKER:-z,relro,-z,now>)
  endif()
endfunction()

add_library(alcap::alcap ALIAS alcap)
alcap_private_flags(alcap)
alcap_harden(alcap)
target_compile_features(alcap PUBLIC cxx_std_20)
target_include_directories(alcap PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>)
target_link_libraries(alcap
  PUBLIC Eigen3::Eigen
  PRIVATE TBB::tbb $<BUILD_INTERFACE:alcap_dep_SPECTRA> $<BUILD_INTERFACE:alcap_dep_FAST_FLOAT>
  $<BUILD_INTERFACE:alcap_dep_JSON>)
target_compile_definitions(alcap PRIVATE ALCAP_VERSION="${PROJECT_VERSION}")
if(ALCAP_INDEX_64)
  target_compile_definitions(alcap PUBLIC ALCAP_INDEX_64)  # the type is part of the interface
endif()
if(ALCAP_WITH_CHOLMOD)
  target_link_libraries(alcap PRIVATE CHOLMOD::CHOLMOD)
  target_compile_definitions(alcap PRIVATE ALCAP_WITH_CHOLMOD)
endif()
if(ALCAP_NATIVE)
  # Public: Eigen's memory alignment follows the instruction set, so both sides of the API must be compiled alike.
  target_compile_options(alcap PUBLIC -march=native)
endif()

# A static alcap inside somebody's shared library exports nothing from there. A shared alcap exports its functions.
set_target_properties(alcap PROPERTIES
  OUTPUT_NAME ${alcap_name}
  VERSION ${PROJECT_VERSION}
  SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
  VISIBILITY_INLINES_HIDDEN ON
  POSITION_INDEPENDENT_CODE ON)
get_target_property(alcap_type alcap TYPE)
if(alcap_type STREQUAL "STATIC_LIBRARY")
  set_target_properties(alcap PROPERTIES CXX_VISIBILITY_PRESET hidden)
endif()

if(ALCAP_INSTALL)
  include(cmake/install.cmake)
endif()
