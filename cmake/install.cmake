# SPDX-License-Identifier: MIT
#
# Install rules and the package that find_package(alcap) reads. Nothing in the installed tree depends on where
# it was built or installed.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(alcap_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/alcap)
target_include_directories(alcap PUBLIC $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
install(TARGETS alcap EXPORT alcapTargets)
install(DIRECTORY include/alcap DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  FILES_MATCHING PATTERN "*.h")
install(EXPORT alcapTargets NAMESPACE alcap:: DESTINATION ${alcap_package_dir})
configure_package_config_file(cmake/alcapConfig.cmake.in ${PROJECT_BINARY_DIR}/alcapConfig.cmake
  INSTALL_DESTINATION ${alcap_package_dir}
  NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/alcapConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES
    ${PROJECT_BINARY_DIR}/alcapConfig.cmake
    ${PROJECT_BINARY_DIR}/alcapConfigVersion.cmake
    cmake/FindCHOLMOD.cmake
  DESTINATION ${alcap_package_dir})
