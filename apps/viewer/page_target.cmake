# SPDX-License-Identifier: MIT
#
# The page as an object file, alcap_embed_page(target), and the library that serves it, alcap_link_studio(target server.cpp).
# Included by apps/alcap/report.cmake.
function(alcap_embed_page target)
  set(source ${PROJECT_SOURCE_DIR}/apps/viewer)
  set(work ${CMAKE_CURRENT_BINARY_DIR}/viewer)
  set(ALCAP_PAGE ${work}/page.html)
  find_program(ALCAP_NPM npm DOC "Fetches three.js and esbuild for the page of --html, view and studio")
  mark_as_advanced(ALCAP_NPM)
  file(GLOB inputs CONFIGURE_DEPENDS ${source}/src/*.js)
  add_custom_command(OUTPUT ${ALCAP_PAGE}
    COMMAND ${CMAKE_COMMAND} -D NPM=$<$<BOOL:${ALCAP_NPM}>:${ALCAP_NPM}> -D SOURCE=${source} -D WORK=${work}
      -D OUTPUT=${ALCAP_PAGE} -P ${source}/page.cmake
    DEPENDS ${inputs} ${source}/index.html ${source}/style.css ${source}/package-lock.json ${source}/page.cmake
    COMMENT "Building the page of apps/viewer" VERBATIM)
  configure_file(${source}/embed.cpp.in ${work}/embed.cpp @ONLY)
  set_source_files_properties(${work}/embed.cpp PROPERTIES OBJECT_DEPENDS ${ALCAP_PAGE})
  target_sources(${target} PRIVATE ${work}/embed.cpp)
endfunction()

# cpp-httplib is compiled (Debian, with TLS and compression, which change its classes) or header-only. Without it
# `alcap studio` says what is missing.
function(alcap_link_studio target server)
  find_library(ALCAP_HTTPLIB_LIBRARY cpp-httplib DOC "cpp-httplib, if compiled")
  mark_as_advanced(ALCAP_HTTPLIB_LIBRARY)
  if(NOT ALCAP_HTTPLIB_INCLUDE_DIR)
    message(STATUS "alcap: no studio. On Debian: apt-get install libcpp-httplib-dev")
    return()
  endif()
  find_package(Threads REQUIRED)
  set(definitions ALCAP_WITH_HTTPLIB)
  if(ALCAP_HTTPLIB_LIBRARY)
    list(APPEND definitions CPPHTTPLIB_OPENSSL_SUPPORT CPPHTTPLIB_ZLIB_SUPPORT CPPHTTPLIB_BROTLI_SUPPORT)
    target_link_libraries(${target} PRIVATE ${ALCAP_HTTPLIB_LIBRARY})
  endif()
  set_source_files_properties(${server} PROPERTIES COMPILE_DEFINITIONS "${definitions}")
  target_link_libraries(${target} PRIVATE Threads::Threads)
endfunction()
