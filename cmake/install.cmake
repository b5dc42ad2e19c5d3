# SPDX-License-Identifier: MIT
#
# Install rules and the package that find_package(alcap) reads. Nothing in the installed tree depends on where
# it was built or installed.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(alcap_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/${alcap_name})
target_include_directories(alcap PUBLIC $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
install(TARGETS alcap EXPORT alcapTargets)
install(DIRECTORY include/alcap DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  FILES_MATCHING PATTERN "*.h")
install(EXPORT alcapTargets NAMESPACE alcap:: DESTINATION ${alcap_package_dir})
configure_package_config_file(cmake/alcapConfig.cmake.in ${PROJECT_BINARY_DIR}/${alcap_name}Config.cmake
  INSTALL_DESTINATION ${alcap_package_dir}
  NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/${alcap_name}ConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES
    ${PROJECT_BINARY_DIR}/${alcap_name}Config.cmake
    ${PROJECT_BINARY_DIR}/${alcap_name}ConfigVersion.cmake
    cmake/FindCHOLMOD.cmake
  DESTINATION ${alcap_package_dir})

# For users without CMake: pkg-config. A static library is linked with what it uses, so that is public then. CHOLMOD of
# Debian 12 comes without a pkg-config file.
set(alcap_pc_requires eigen3)
set(alcap_pc_libs)
if(alcap_type STREQUAL "STATIC_LIBRARY")
  string(APPEND alcap_pc_requires " tbb")
  if(ALCAP_WITH_CHOLMOD)
    set(alcap_pc_libs -lcholmod)
  endif()
endif()
set(alcap_pc_cflags)
if(ALCAP_INDEX_64)
  set(alcap_pc_cflags " -DALCAP_INDEX_64")
endif()
file(RELATIVE_PATH alcap_pc_prefix /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
configure_file(cmake/alcap.pc.in ${PROJECT_BINARY_DIR}/${alcap_name}.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/${alcap_name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
