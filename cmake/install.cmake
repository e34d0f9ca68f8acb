# Installs libraries and headers, and what find_package(mlo) needs. Component "development"; the program is its own.
include(CMakePackageConfigHelpers)

get_property(libraries GLOBAL PROPERTY MLO_LIBRARIES)
add_library(mlo_mlo INTERFACE)
add_library(mlo::mlo ALIAS mlo_mlo)
set_target_properties(mlo_mlo PROPERTIES EXPORT_NAME mlo)
target_link_libraries(mlo_mlo INTERFACE ${libraries})

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/mlo)
install(TARGETS ${libraries} mlo_mlo EXPORT mloTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
  FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
install(EXPORT mloTargets NAMESPACE mlo:: DESTINATION ${package_folder} COMPONENT development)

set(MLO_FIND_DEPENDENCIES "")
foreach(dependency IN LISTS MLO_DEPENDENCIES)
  string(APPEND MLO_FIND_DEPENDENCIES "find_dependency(${dependency})\n")
endforeach()
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/mloConfig.cmake.in
  ${PROJECT_BINARY_DIR}/mloConfig.cmake INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/mloConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/mloConfig.cmake ${PROJECT_BINARY_DIR}/mloConfigVersion.cmake
  DESTINATION ${package_folder} COMPONENT development)
