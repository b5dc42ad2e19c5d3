# SPDX-License-Identifier: MIT
#
# Results as JSON and as a page: what the command line and the Python package both show. Included by the top folder.
alcap_package(libfmt-dev fmt QUIET)
file(GLOB alcap_report_sources CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} apps/alcap/page/*.cpp apps/alcap/tables/*.cpp)
add_library(alcap_report STATIC apps/alcap/report/report.cpp apps/alcap/report/design_report.cpp apps/alcap/report/flags.cpp
  ${alcap_report_sources})
alcap_private_flags(alcap_report)
alcap_harden(alcap_report)
# What takes time is done by the library; here -O1 saves a third of the compile time.
target_compile_options(alcap_report PRIVATE $<$<CONFIG:Release>:-O1>)
set_target_properties(alcap_report PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden
  VISIBILITY_INLINES_HIDDEN ON)
target_link_libraries(alcap_report PUBLIC alcap::alcap alcap_dep_JSON PRIVATE TBB::tbb fmt::fmt-header-only)
include(apps/viewer/page_target.cmake)
alcap_embed_page(alcap_report)
alcap_unity(alcap_report)
alcap_precompile(alcap_report <fmt/core.h> <nlohmann/json.hpp>)
find_path(ALCAP_HTTPLIB_INCLUDE_DIR httplib.h DOC "Folder that holds httplib.h (Debian: libcpp-httplib-dev)")
mark_as_advanced(ALCAP_HTTPLIB_INCLUDE_DIR)
