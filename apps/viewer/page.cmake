# SPDX-License-Identifier: MIT
#
# Makes the page: cmake -D NPM=npm -D SOURCE=apps/viewer -D WORK=folder -D OUTPUT=page.html -P page.cmake
# The packages go into WORK/node_modules, so that the source tree stays clean. Where they cannot be had, OUTPUT is empty
# and the program says so; the next build tries again.
file(MAKE_DIRECTORY ${WORK})

function(give_up reason)
  message(WARNING "alcap: no page for --html, view and studio: ${reason}")
  file(WRITE ${OUTPUT} "")
  execute_process(COMMAND touch -d 2000-01-01 ${OUTPUT})
endfunction()

if(NOT NPM)
  give_up("npm was not found. On Debian: apt-get install npm")
  return()
endif()
file(READ ${SOURCE}/package-lock.json lock)
set(installed "")
if(EXISTS ${WORK}/installed)
  file(READ ${WORK}/installed installed)
endif()
if(NOT lock STREQUAL installed)
  file(COPY ${SOURCE}/package.json ${SOURCE}/package-lock.json DESTINATION ${WORK})
  execute_process(
    COMMAND ${NPM} ci --ignore-scripts --no-audit --no-fund --prefer-offline --fetch-retries=1 --loglevel=error
    WORKING_DIRECTORY ${WORK} RESULT_VARIABLE status OUTPUT_VARIABLE log ERROR_VARIABLE log)
  if(NOT status EQUAL 0)
    give_up("npm could not install its packages (${status}):\n${log}")
    return()
  endif()
  file(WRITE ${WORK}/installed "${lock}")
endif()
execute_process(COMMAND ${CMAKE_COMMAND} -E env NODE_PATH=${WORK}/node_modules
  ${WORK}/node_modules/.bin/esbuild ${SOURCE}/src/main.js --bundle --minify --format=iife --target=es2020
  --charset=utf8 --legal-comments=inline --log-level=warning --outfile=${WORK}/main.js
  RESULT_VARIABLE status OUTPUT_VARIABLE log ERROR_VARIABLE log)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "the page does not build:\n${log}")
endif()
execute_process(COMMAND ${WORK}/node_modules/.bin/esbuild ${SOURCE}/style.css --minify --log-level=warning
  --outfile=${WORK}/style.css RESULT_VARIABLE status OUTPUT_VARIABLE log ERROR_VARIABLE log)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "the style sheet does not build:\n${log}")
endif()
file(READ ${SOURCE}/index.html page)
file(READ ${WORK}/style.css style)
file(READ ${WORK}/main.js script)
foreach(part IN ITEMS style script)
  string(FIND "${${part}}" "</${part}" found)
  if(NOT found EQUAL -1)
    message(FATAL_ERROR "the ${part} would end its own element")
  endif()
  string(REPLACE "{{${part}}}" "${${part}}" page "${page}")
endforeach()
file(WRITE ${OUTPUT} "${page}")
