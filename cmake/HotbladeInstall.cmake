# cmake --install and the Debian package: the program with its manual page, completion, documents and samples, and
# the curve library with its headers for find_package(hotblade).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS hotblade RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
install(FILES "${PROJECT_BINARY_DIR}/share/hotblade.1"
  DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
install(FILES "${PROJECT_BINARY_DIR}/share/hotblade.bash"
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME hotblade COMPONENT program)
# Snakemake finds the status script beside its profile.
install(DIRECTORY pipeline/batch/share/ DESTINATION ${CMAKE_INSTALL_DATADIR}/hotblade/batch COMPONENT program
  USE_SOURCE_PERMISSIONS)
install(FILES README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs COMPONENT program)
install(DIRECTORY samples/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/samples COMPONENT program
  FILES_MATCHING PATTERN "*.obj" PATTERN "*.toml" PATTERN "README.md")

install(DIRECTORY data/arms DESTINATION ${CMAKE_INSTALL_DATADIR}/hotblade COMPONENT program)

get_property(elastica_rooms GLOBAL PROPERTY HOTBLADE_ROOMS_OF_elastica)
install(TARGETS hotblade_elastica ${elastica_rooms} hotblade_options EXPORT hotblade
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
install(DIRECTORY elastica DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/hotblade COMPONENT development
  FILES_MATCHING PATTERN "*.hpp" PATTERN "*.h")
install(EXPORT hotblade NAMESPACE hotblade:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/hotblade
  FILE hotbladeTargets.cmake COMPONENT development)
configure_package_config_file(cmake/hotbladeConfig.cmake.in "${PROJECT_BINARY_DIR}/hotbladeConfig.cmake"
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/hotblade)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/hotbladeConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/hotbladeConfig.cmake" "${PROJECT_BINARY_DIR}/hotbladeConfigVersion.cmake"
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/hotblade COMPONENT development)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "hotblade maintainers <hotblade@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Plan hot-blade cutting of architectural formwork")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME hotblade)
set(CPACK_DEBIAN_PROGRAM_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
# Library packages follow from what the program links; pictures need a driver that can draw without a display.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "libegl-mesa0, libgl1-mesa-dri")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libhotblade-dev)
set(CPACK_DEBIAN_DEVELOPMENT_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libeigen3-dev, libboost-dev")
include(CPack)
