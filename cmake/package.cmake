# `cmake --install`: the command, the libraries, their headers, and a package config, so that
# another project writes find_package(locsim) and links locsim::localization.

include(CMakePackageConfigHelpers)
set(config_dir "${CMAKE_INSTALL_LIBDIR}/cmake/locsim")

get_property(libraries GLOBAL PROPERTY LOCSIM_LIBRARIES)
install(TARGETS ${libraries} EXPORT locsim-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS locsim RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
foreach(folder core maps localization sim scenarios render)
  install(DIRECTORY ${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/locsim
          FILES_MATCHING PATTERN "*.h")
endforeach()
install(DIRECTORY scenarios/library/ DESTINATION ${CMAKE_INSTALL_DATADIR}/locsim/scenarios)
install(EXPORT locsim-targets NAMESPACE locsim:: DESTINATION ${config_dir})
configure_package_config_file(cmake/locsim-config.cmake.in
                              "${CMAKE_CURRENT_BINARY_DIR}/locsim-config.cmake"
                              INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/locsim-config-version.cmake"
                                 COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/locsim-config.cmake"
              "${CMAKE_CURRENT_BINARY_DIR}/locsim-config-version.cmake" cmake/dependencies.cmake
        DESTINATION ${config_dir})
