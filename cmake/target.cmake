add_library(alcap::alcap ALIAS alcap)
target_compile_features(alcap PUBLIC cxx_std_20)
target_include_directories(alcap PUBLIC
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
  $<INSTALL_INTERFACE:include>)
target_link_libraries(alcap PUBLIC Eigen3::Eigen PRIVATE TBB::tbb)
if(ALCAP_WITH_CHOLMOD)
  target_link_libraries(alcap PRIVATE CHOLMOD::CHOLMOD)
  target_compile_definitions(alcap PRIVATE ALCAP_WITH_CHOLMOD)
endif()
target_compile_options(alcap PRIVATE -Wall -Wextra -Wpedantic -Wconversion
  $<$<BOOL:${ALCAP_WARNINGS_AS_ERRORS}>:-Werror> $<$<BOOL:${ALCAP_NATIVE}>:-march=native>)
