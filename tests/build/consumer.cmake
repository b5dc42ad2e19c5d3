# SPDX-License-Identifier: MIT
#
# Builds and runs a project that uses alcap, as ctest calls it: cmake -D KIND=... -P consumer.cmake.
#   find_package   installs alcap to a fresh folder, moves that folder, and finds it there
#   pkg_config     installs it likewise, and compiles by what pkg-config says; with the other width of Index nothing links
#   subdirectory   add_subdirectory(alcap) in a parent that checks that nothing of it changed
#   fetch_content  FetchContent in a parent, with the sources where they are; compiles the parent, not the library
#   default_build  configures alcap alone without a build type and looks at the flags
cmake_minimum_required(VERSION 3.25)

function(run what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(NOT code EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${what} failed (${code}): ${command}\n${out}")
  endif()
  message(STATUS "${what}: ok")
  set(output "${out}" PARENT_SCOPE)
endfunction()

# check_width(): what includes the header alone links, with the width of Index that pkg-config told, and only with that.
function(check_width)
  file(WRITE ${WORK}/width.cpp "#include <alcap/index.h>\nint main() { return sizeof(alcap::Index) == 8 ? 64 : 32; }\n")
  set(command ${CXX} -std=c++20 ${WORK}/width.cpp -o ${WORK}/build/width)
  run(width ${command} ${flags})
  set(other ${flags})
  if(INDEX_64)
    list(REMOVE_ITEM other -DALCAP_INDEX_64)
  else()
    list(PREPEND other -DALCAP_INDEX_64)
  endif()
  execute_process(COMMAND ${command} ${other} RESULT_VARIABLE code ERROR_VARIABLE message)
  if(code EQUAL 0 OR NOT message MATCHES "alcap_was_compiled_with_an_index_of_another_width")
    message(FATAL_ERROR "a program with the other width of Index should not link: ${code} ${message}")
  endif()
  message(STATUS "the other width: does not link")
endfunction()

string(TOUPPER "${CONFIG}" config_upper)
set(settings -G ${GENERATOR} -D CMAKE_CXX_COMPILER=${CXX} -D CMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}
  -D CMAKE_CXX_FLAGS=${FLAGS} -D ALCAP_WITH_CHOLMOD=${WITH_CHOLMOD} -D ALCAP_NATIVE=${NATIVE}
  -D BUILD_SHARED_LIBS=${SHARED} -D ALCAP_WARNINGS_AS_ERRORS=${WERROR}
  -D ALCAP_INDEX_64=${INDEX_64} -D ALCAP_NAME=${NAME})
set(typed -D CMAKE_BUILD_TYPE=${CONFIG} -D CMAKE_CXX_FLAGS_${config_upper}=${FLAGS_CONFIG})
file(REMOVE_RECURSE ${WORK})
set(project ${ALCAP_SOURCE}/tests/build/consumer_${KIND})

if(KIND MATCHES "find_package|pkg_config")
  run(install ${CMAKE_COMMAND} --install ${ALCAP_BUILD} --config ${CONFIG} --prefix ${WORK}/first)
  file(RENAME ${WORK}/first ${WORK}/moved)
endif()
if(KIND STREQUAL "find_package")
  run(configure ${CMAKE_COMMAND} -S ${project} -B ${WORK}/build ${settings} ${typed}
    -D CMAKE_PREFIX_PATH=${WORK}/moved -D ALCAP_VERSION=${ALCAP_VERSION})
elseif(KIND STREQUAL "pkg_config")
  file(GLOB_RECURSE pc ${WORK}/moved/${NAME}.pc)
  cmake_path(GET pc PARENT_PATH folder)
  set(ENV{PKG_CONFIG_PATH} ${folder})
  run(version ${PKG_CONFIG} --modversion ${NAME})
  if(NOT output MATCHES "^${ALCAP_VERSION}\n$")
    message(FATAL_ERROR "pkg-config knows another version: ${output}")
  endif()
  run(flags ${PKG_CONFIG} --cflags --libs ${NAME})
  separate_arguments(flags UNIX_COMMAND "${FLAGS} ${output}")
  if(NOT flags MATCHES "-I${WORK}/moved/" AND NOT flags MATCHES "-I${folder}")
    message(FATAL_ERROR "pkg-config found another alcap: ${flags}")
  endif()
  cmake_path(GET folder PARENT_PATH libraries)
  file(MAKE_DIRECTORY ${WORK}/build)
  run(compile ${CXX} -std=c++20 ${ALCAP_SOURCE}/tests/build/consumer.cpp -o ${WORK}/build/consumer ${flags}
    -Wl,-rpath,${libraries})
  check_width()
elseif(KIND MATCHES "subdirectory|fetch_content")
  # All of alcap is compiled once more (subdirectory): without optimisation, because what is tested is the embedding.
  if(CONFIG STREQUAL "Release")
    list(APPEND typed -D "CMAKE_CXX_FLAGS_RELEASE=-O0 -DNDEBUG" -D ALCAP_HARDENED=OFF)
  endif()
  run(configure ${CMAKE_COMMAND} -S ${project} -B ${WORK}/build ${settings} ${typed} -D ALCAP_SOURCE=${ALCAP_SOURCE}
    -D FETCHCONTENT_SOURCE_DIR_ALCAP=${ALCAP_SOURCE})
elseif(KIND STREQUAL "default_build")
  run(configure ${CMAKE_COMMAND} -S ${ALCAP_SOURCE} -B ${WORK}/build ${settings}
    -D ALCAP_BUILD_TESTS=OFF -D ALCAP_BUILD_APPS=OFF -D ALCAP_UNITY=OFF)  # a command for every file
  file(STRINGS ${WORK}/build/compile_commands.json commands REGEX "\"command\":.*src/base/version.cpp")
  if(NOT commands MATCHES " -O3 .*-DNDEBUG")
    message(FATAL_ERROR "a configure without a build type does not optimise: ${commands}")
  endif()
  message(STATUS "default flags: ok")
  return()
endif()
if(KIND STREQUAL "fetch_content")
  run(compile ${CMAKE_COMMAND} --build ${WORK}/build --config ${CONFIG} --target consumer_object)
  return()
endif()
if(NOT KIND STREQUAL "pkg_config")
  cmake_host_system_information(RESULT cores QUERY NUMBER_OF_LOGICAL_CORES)
  run(build ${CMAKE_COMMAND} --build ${WORK}/build --config ${CONFIG} -j ${cores})
endif()
run(run ${CMAKE_COMMAND} -E chdir ${WORK} ${WORK}/build/consumer)
message(STATUS "${output}")
