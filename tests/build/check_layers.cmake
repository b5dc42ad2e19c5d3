# SPDX-License-Identifier: MIT
#
# Reads the #include lines of ROOT and fails on a wrong arrow: cmake -D ROOT=. -P tests/build/check_layers.cmake
cmake_minimum_required(VERSION 3.25)
get_filename_component(ROOT "${ROOT}" ABSOLUTE)

# The layers, in the order the data flows: a folder with all below it, and the public headers it implements. A file
# includes its own layer and earlier ones; a public header includes only public headers that stand before it here.
set(layers
  "kernels                 |"
  "src/base                | index names errors control version conventions memory"
  "src/simd                |"
  "solvers/dense           |"
  "solvers/linear          | solve backends"
  "solvers/multigrid       |"
  "solvers/eigenpair       |"
  "solvers/petsc           | petsc"
  "src/mesh                | mesh_check mesh mesh_repair arrays generators topology geometry surface surface_path shortest_path sharp_edges intrinsic"
  "src/io/mesh             | mesh_io"
  "src/io/matrix           | matrix_file"
  "src/connection          | connection cones frames connected_surface transport"
  "src/energy              | operators assembly energies"
  "src/field               | field smoothest singularities alignment sizing"
  "src/curves/strokes      | strokes"
  "src/curves/streamlines  | streamlines"
  "src/design              | controls aligned designer eigen_design design_file"
  "src/io/field            | output handoff"
  "src/run                 | field_run design_run batch plan alcap"
  "src/distributed         | distributed distributed_output distributed_design"
  "apps                    |"
  "c                       | alcap_c"
  "python                  |")
# What files of a part may include: the standard library, the layers of these parts, and third-party headers.
set(parts
  "include/alcap | include               | Eigen/"
  "kernels       | kernels               |"
  "src           | include src kernels solvers | Eigen/ fast_float/ nlohmann/"
  "solvers       | include src kernels solvers | Eigen/"
  "apps          | include apps src/base src/simd/isa.h | Eigen/ fmt/ nlohmann/"
  "c             | include apps c |"
  "python        | include apps python | pybind11/")
# Doors: what only the files that match may include.
set(doors
  "^(oneapi/)?tbb/ = ^src/base/parallel\\.cpp$"
  "^sanitizer/ = ^src/base/parallel\\.cpp$"
  "^(suitesparse/)?(cholmod|umfpack|SuiteSparse_config|amd|camd|colamd|metis|cblas|lapacke|openblas_config)\\.h$ = ^solvers/linear/cholmod[^/]*\\.cpp$"
  "^Eigen/(Cholmod|UmfPack|SPQR|Metis)Support$ = ^solvers/linear/cholmod[^/]*\\.cpp$"
  "^Spectra/ = ^solvers/"
  "^(petsc|slepc)[a-z]*\\.h$ = ^(solvers/petsc|src/distributed)/"
  "^mpi\\.h$ = ^(solvers/petsc|src/distributed)/"
  "^(EGL/|GLES3/|png\\.h$) = ^apps/alcap/picture/[^/]*$"
  "^httplib\\.h$ = ^apps/alcap/studio/studio_server\\.cpp$"
  "^(arpa/inet|netinet/in|sys/socket)\\.h$ = ^apps/alcap/studio/"
  "^CLI/ = ^apps/alcap/options/cli\\.cpp$"
  "^omp\\.h$ = ^$")
# C and POSIX headers whose names have no slash but a .h. Public headers use none.
set(system_headers stddef.h stdint.h fcntl.h unistd.h dlfcn.h malloc.h sys/mman.h sys/file.h sys/stat.h sys/wait.h poll.h sys/types.h sys/resource.h sys/ioctl.h immintrin.h cpuid.h)

# split(line): the fields of "a | b | c" as field_0, field_1, field_2, without the spaces around them.
macro(split line)
  string(REGEX REPLACE " *\\| *" "|" fields "${line}")
  string(REPLACE "|" ";" fields "${fields};")
  set(field_0)
  set(field_1)
  set(field_2)
  set(count 0)
  foreach(value IN LISTS fields)
    string(STRIP "${value}" field_${count})
    math(EXPR count "${count} + 1")
  endforeach()
endmacro()

# Each layer's folder, and each public header's layer and rank.
set(folders)
set(public_headers)
set(public_layers)
foreach(line IN LISTS layers)
  split("${line}")
  list(LENGTH folders here)
  list(APPEND folders ${field_0})
  separate_arguments(field_1)
  foreach(header IN LISTS field_1)
    list(APPEND public_headers ${header})
    list(APPEND public_layers ${here})
  endforeach()
endforeach()

# layer_of(layer rank path): the layer of a file (-1: none), and the rank of a public header.
function(layer_of out rank path)
  set(layer -1)
  set(place -1)
  if(path MATCHES "^include/alcap/([^/]+)\\.h$")
    list(FIND public_headers ${CMAKE_MATCH_1} place)
    if(NOT place EQUAL -1)
      list(GET public_layers ${place} layer)
    endif()
  else()
    foreach(folder IN LISTS folders)
      string(FIND ${path} ${folder}/ at)
      if(at EQUAL 0)
        list(FIND folders ${folder} layer)
        break()
      endif()
    endforeach()
  endif()
  set(${out} ${layer} PARENT_SCOPE)
  set(${rank} ${place} PARENT_SCOPE)
endfunction()

# ours(out header): the file under ROOT that an #include names, or empty. Paths start at the root.
function(ours out header)
  if(header MATCHES "^alcap/")
    set(${out} include/${header} PARENT_SCOPE)
  elseif(header MATCHES "^(kernels|src|solvers|apps|c|python)/")
    set(${out} ${header} PARENT_SCOPE)
  else()
    set(${out} "" PARENT_SCOPE)
  endif()
endfunction()

set(problems)
macro(problem)
  string(CONCAT message ${ARGN})
  list(APPEND problems "${file}: ${message}")
endmacro()

# starts_with_any(out text prefixes...)
function(starts_with_any out text)
  set(${out} OFF PARENT_SCOPE)
  foreach(prefix IN LISTS ARGN)
    string(FIND ${text} ${prefix} at)
    if(at EQUAL 0)
      set(${out} ON PARENT_SCOPE)
    endif()
  endforeach()
endfunction()

macro(check_ours)
  string(REGEX REPLACE "/alcap/[^/]*$" "" target ${included})
  starts_with_any(may ${target} ${may_include})
  layer_of(other other_rank ${included})
  if(NOT may)
    problem("includes ${header}, but ${part} may include only: ${may_include}")
  elseif(other EQUAL -1)
    problem("includes ${header}, which belongs to no layer")
  elseif(other GREATER layer OR (NOT rank EQUAL -1 AND NOT other_rank LESS rank))
    list(GET folders ${layer} layer_name)
    list(GET folders ${other} other_name)
    problem("includes ${header}: the layer '${layer_name}' comes before '${other_name}', or the header before it")
  endif()
endmacro()

# The standard library has neither a dot nor a slash.
macro(check_foreign)
  set(allowed OFF)
  if(NOT header MATCHES "[./]" OR (header IN_LIST system_headers AND (NOT part STREQUAL "include/alcap" OR file STREQUAL "include/alcap/alcap_c.h")))
    set(allowed ON)
  endif()
  starts_with_any(third ${header} ${third_party})
  foreach(door IN LISTS doors)
    string(REGEX MATCH "^(.*) = (.*)$" door "${door}")
    set(behind ${CMAKE_MATCH_1})
    set(keeper ${CMAKE_MATCH_2})
    if(header MATCHES "${behind}")
      set(third ON)
      if(NOT file MATCHES "${keeper}")
        problem("includes ${header}, which only files matching ${keeper} may")
      endif()
    endif()
  endforeach()
  if(NOT allowed AND NOT third)
    problem("includes ${header}, but ${part} may include only the standard library, ${third_party} and alcap's own, by paths that start at the root")
  endif()
endmacro()

set(checked 0)
foreach(line IN LISTS parts)
  split("${line}")
  set(part ${field_0})
  string(REPLACE " " ";" may_include "${field_1}")
  string(REPLACE " " ";" third_party "${field_2}")
  file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/${part}/*.h ${ROOT}/${part}/*.cpp)
  foreach(file IN LISTS files)
    math(EXPR checked "${checked} + 1")
    layer_of(layer rank ${file})
    if(layer EQUAL -1)
      problem("belongs to no layer: put it into a folder (or, a public header, into a line) of tests/build/check_layers.cmake")
      continue()
    endif()
    file(STRINGS ${ROOT}/${file} includes REGEX "^[ \t]*#[ \t]*include[ \t]*[<\"]")
    foreach(include IN LISTS includes)
      string(REGEX MATCH "include[ \t]*[<\"]([^>\"]+)[>\"]" include "${include}")
      set(header ${CMAKE_MATCH_1})
      ours(included ${header})
      if(included STREQUAL "")
        check_foreign()
      else()
        check_ours()
      endif()
    endforeach()
  endforeach()
endforeach()

if(problems)
  list(JOIN problems "\n  " text)
  message(FATAL_ERROR "wrong includes:\n  ${text}")
endif()
if(checked EQUAL 0)
  message(FATAL_ERROR "no files found under ${ROOT}")
endif()
message(STATUS "${checked} files, every include points to its own or an earlier layer")
