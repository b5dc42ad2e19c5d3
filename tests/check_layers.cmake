# SPDX-License-Identifier: MIT
#
# Reads the #include lines of ROOT and fails on a wrong arrow: cmake -D ROOT=. -P tests/check_layers.cmake
cmake_minimum_required(VERSION 3.25)
get_filename_component(ROOT "${ROOT}" ABSOLUTE)

# include/alcap, in the order the data flows. A header includes only headers above it. src/NAME_*.cpp implements the
# layer it is named after (the longest name that fits) and may include that header and everything above it.
set(layers
  errors version conventions parallel memory
  solve
  mesh_check mesh mesh_io generators topology
  geometry
  connection
  cones
  frames
  operators assembly energies
  field
  design
  singularities
  strokes
  streamlines
  controls
  alignment
  designer
  eigen_design
  design_file
  pipeline
  batch
  output
  alcap)
# Other files and folders (as regular expressions) = the layer they belong to.
set(also
  "^solvers/ = solve"
  "^src/io/ = mesh_io"
  "^src/output/ = output"
  "^src/face_edges = mesh_check"
  "^src/homology = topology"
  "^src/branches = field"
  "^src/component_blocks = design"
  "^src/(triangle_frame|correction_system|face_pairs|face_states|grounded_laplacian|large_array) = connection"
  "^src/simd/ = energies"
  "^src/simd/correction = connection"
  "^include/alcap/detail/triangle_entries = energies"
  "^include/alcap/detail/(isa|angles|unset_array) = conventions"
  "^include/alcap/detail/atomic_file = errors"
  "^include/alcap/detail/random = conventions")
# What each part may include, besides the standard library and itself: alcap headers (by the order above), folders,
# and third-party headers (by path). Listed as  part | folders | third party.
set(parts
  "include/alcap | alcap | Eigen/ sanitizer/"
  "kernels       | kernels | "
  "src           | alcap src kernels solvers | Eigen/ fast_float/ Spectra/ nlohmann/"
  "solvers       | alcap src kernels solvers | Eigen/ Spectra/"
  "apps          | alcap apps | Eigen/ CLI/ fmt/ nlohmann/")
# Doors: what only the file that matches may include.
set(doors
  "^(oneapi/)?tbb/ = ^include/alcap/parallel\\.h$"
  "^(suitesparse/)?(cholmod|umfpack|SuiteSparse_config|amd|camd|colamd|metis|cblas|lapacke|openblas_config)\\.h$ = ^solvers/cholmod[^/]*\\.cpp$"
  "^Eigen/(Cholmod|UmfPack|SPQR|Metis)Support$ = ^solvers/cholmod[^/]*\\.cpp$"
  "^Spectra/ = ^solvers/"
  "^alcap/parallel\\.h$ = ^(src|solvers|apps)/"
  "^sanitizer/ = ^include/alcap/parallel\\.h$"
  "^(EGL/|GLES3/|png\\.h$) = ^apps/alcap/png_[^/]*\\.(h|cpp)$"
  "^httplib\\.h$ = ^apps/alcap/studio_server\\.cpp$"
  "^omp\\.h$ = ^$")
# C and POSIX headers whose names have no slash but a .h. Public headers use none.
set(system_headers fcntl.h unistd.h dlfcn.h malloc.h sys/mman.h sys/stat.h sys/types.h sys/resource.h sys/ioctl.h immintrin.h cpuid.h)

set(problems)
macro(problem)
  string(CONCAT message ${ARGN})
  list(APPEND problems "${file}: ${message}")
endmacro()

# layer_of(out path): the position of the layer that a path belongs to, -1 if none.
function(layer_of out path)
  set(best -1)
  if(path MATCHES "^include/alcap/([^/]+)\\.h$")
    list(FIND layers ${CMAKE_MATCH_1} best)
  else()
    foreach(rule IN LISTS also)
      string(REGEX MATCH "^(.*) = (.*)$" rule "${rule}")
      set(pattern ${CMAKE_MATCH_1})
      set(layer ${CMAKE_MATCH_2})
      if(path MATCHES "${pattern}")
        list(FIND layers ${layer} best)
      endif()
    endforeach()
    if(best EQUAL -1)
      get_filename_component(stem ${path} NAME_WE)
      set(length 0)
      foreach(name IN LISTS layers)
        string(LENGTH ${name} here)
        if(stem MATCHES "^${name}(_|$)" AND here GREATER length)
          set(length ${here})
          list(FIND layers ${name} best)
        endif()
      endforeach()
    endif()
  endif()
  set(${out} ${best} PARENT_SCOPE)
endfunction()

set(files)
foreach(part IN LISTS parts)
  string(REGEX MATCH "^([^| ]+) *\\| *([^|]*[^| ]) *\\| *(.*)$" part "${part}")
  set(part ${CMAKE_MATCH_1})
  string(REPLACE " " ";" may_include "${CMAKE_MATCH_2}")
  string(REPLACE " " ";" third_party "${CMAKE_MATCH_3}")
  file(GLOB_RECURSE part_files RELATIVE ${ROOT} ${ROOT}/${part}/*.h ${ROOT}/${part}/*.cpp)
  list(APPEND files ${part_files})
  foreach(file IN LISTS part_files)
    layer_of(layer ${file})
    if(part MATCHES "^(include/alcap|src|solvers)$" AND layer EQUAL -1)
      problem("belongs to no layer: name it after one, or put it into the list on top of tests/check_layers.cmake")
      continue()
    endif()
    file(STRINGS ${ROOT}/${file} includes REGEX "^[ \t]*#[ \t]*include[ \t]*[<\"]")
    foreach(line IN LISTS includes)
      string(REGEX MATCH "include[ \t]*[<\"]([^>\"]+)[>\"]" line "${line}")
      set(header ${CMAKE_MATCH_1})
      foreach(door IN LISTS doors)
        string(REGEX MATCH "^(.*) = (.*)$" door "${door}")
        set(behind ${CMAKE_MATCH_1})
        set(keeper ${CMAKE_MATCH_2})
        if(header MATCHES "${behind}" AND NOT file MATCHES "${keeper}")
          problem("includes ${header}, which only files matching ${keeper} may")
        endif()
      endforeach()
      # Ours or somebody else's?
      get_filename_component(folder ${file} DIRECTORY)
      set(ours "")
      if(header MATCHES "^alcap/" AND part STREQUAL "apps" AND EXISTS ${ROOT}/apps/${header})
        set(ours apps/${header})
      elseif(header MATCHES "^alcap/")
        set(ours include/${header})
      elseif(header MATCHES "^(kernels|src|solvers|apps)/")
        set(ours ${header})
      elseif(part STREQUAL "src" AND EXISTS ${ROOT}/src/${header})
        set(ours src/${header})
      elseif(EXISTS ${ROOT}/${folder}/${header})
        cmake_path(SET ours NORMALIZE ${folder}/${header})
      endif()
      if(NOT ours STREQUAL "")
        string(REGEX REPLACE "^include/" "" target ${ours})
        string(REGEX REPLACE "/.*$" "" target ${target})
        if(NOT target IN_LIST may_include)
          problem("includes ${header}, but ${part} may include only: ${may_include}")
        elseif(NOT target MATCHES "^(kernels|apps)$" AND NOT part STREQUAL "apps")
          layer_of(other ${ours})
          if(other EQUAL -1)
            problem("includes ${header}, which belongs to no layer")
          elseif(other GREATER layer OR (other EQUAL layer AND part STREQUAL "include/alcap" AND NOT file MATCHES "/detail/" AND NOT ours MATCHES "/detail/"))
            list(GET layers ${layer} layer_name)
            list(GET layers ${other} other_name)
            problem("includes ${header}: layer '${layer_name}' comes before '${other_name}'")
          endif()
        endif()
        continue()
      endif()
      set(allowed OFF)
      if(NOT header MATCHES "[./]" OR (NOT part STREQUAL "include/alcap" AND header IN_LIST system_headers))
        set(allowed ON)  # standard library
      endif()
      foreach(prefix IN LISTS third_party)
        if(header MATCHES "^${prefix}")
          set(allowed ON)
        endif()
      endforeach()
      foreach(door IN LISTS doors)
        string(REGEX REPLACE " = .*$" "" behind "${door}")
        if(header MATCHES "${behind}")
          set(allowed ON)  # judged above
        endif()
      endforeach()
      if(NOT allowed)
        problem("includes ${header}, but ${part} may include only the standard library, ${third_party} and alcap's own")
      endif()
    endforeach()
  endforeach()
endforeach()

list(LENGTH files count)
if(problems)
  list(JOIN problems "\n  " text)
  message(FATAL_ERROR "wrong includes:\n  ${text}")
endif()
if(count EQUAL 0)
  message(FATAL_ERROR "no files found under ${ROOT}")
endif()
message(STATUS "${count} files, every include points to an earlier layer")
