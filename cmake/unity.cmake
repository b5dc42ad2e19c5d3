# SPDX-License-Identifier: MIT
#
# Compiles the files of a folder together: headers are read and templates instantiated once a folder. Editors and clang-tidy
# want every file on its own: -DALCAP_UNITY=OFF, as preset dev has.

# alcap_unity(target): one translation unit per folder of the target's sources, or several of a folder with more than
# 1,400 lines, so that all cores have work. The copies for an instruction set stay alone (they have flags of their own), and
# so do generated files, and classes whose members have types that are local to their file. A folder's files share one
# namespace: what is local to a file needs a name of its own there, or a namespace, as field_parts in field_command.cpp,
# and `using` must not give another meaning to a name of the library.
set(alcap_alone "^src/simd/|^src/connection/(global|trivial)|^src/mesh/homology|^solvers/eigenpair/lanczos_loop")
function(alcap_unity target)
  if(NOT ALCAP_UNITY)
    return()
  endif()
  get_target_property(sources ${target} SOURCES)
  get_target_property(folder_of_target ${target} SOURCE_DIR)
  list(SORT sources)
  set(last_folder)
  foreach(source IN LISTS sources)
    cmake_path(IS_ABSOLUTE source generated)
    if(generated OR source MATCHES "${alcap_alone}" OR NOT source MATCHES "\\.cpp$")
      set_source_files_properties(${source} TARGET_DIRECTORY ${target} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
      continue()
    endif()
    cmake_path(GET source PARENT_PATH folder)
    if(NOT folder STREQUAL last_folder)
      set(last_folder ${folder})
      set(part 1)
      set(lines 0)
    endif()
    file(STRINGS ${folder_of_target}/${source} text)
    list(LENGTH text count)
    math(EXPR lines "${lines} + ${count}")
    if(lines GREATER 1400)
      math(EXPR part "${part} + 1")
      set(lines ${count})
    endif()
    string(REPLACE / _ group ${folder})
    set_source_files_properties(${source} TARGET_DIRECTORY ${target} PROPERTIES UNITY_GROUP ${group}_${part})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()
