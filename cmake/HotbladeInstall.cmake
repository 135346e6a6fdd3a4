# cmake --install and the Debian packages: the program with its manual page, completion, documents and samples, and
# the library with its headers for find_package(hotblade) (docs/library.md).
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
  FILES_MATCHING PATTERN "*.obj" PATTERN "*.toml" PATTERN "*.ipynb" PATTERN "README.md")

install(DIRECTORY data/arms DESTINATION ${CMAKE_INSTALL_DATADIR}/hotblade COMPONENT program)

# The library: every room that neither draws, studies nor speaks to a user, hotblade::elastica_curve for
# hotblade_elastica_curve. The curves are an export of their own, which needs Eigen and Boost alone.
set(rooms_curves hotblade_options)
set(rooms_rest)
set(headers)
foreach(folder IN ITEMS elastica surface gpu robot pipeline)
  get_property(inner GLOBAL PROPERTY HOTBLADE_ROOMS_OF_${folder})
  foreach(room IN LISTS inner)
    if(room MATCHES "_(preview|drawing|report|study|batch|cli)$")
      continue()
    elseif(folder STREQUAL "elastica")
      list(APPEND rooms_curves ${room})
    else()
      list(APPEND rooms_rest ${room})
    endif()
    get_target_property(own ${room} HOTBLADE_HEADERS)
    list(APPEND headers ${own})
  endforeach()
endforeach()
list(APPEND rooms_curves hotblade_elastica)
list(APPEND rooms_rest hotblade_surface hotblade_gpu hotblade_robot)
foreach(target IN LISTS rooms_curves rooms_rest)
  string(REPLACE "hotblade_" "" name "${target}")
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
endforeach()
# What only the rooms' own sources may include.
list(REMOVE_ITEM headers surface/read/half_edges.hpp)
foreach(header IN LISTS headers)
  cmake_path(GET header PARENT_PATH folder)
  install(FILES "${PROJECT_SOURCE_DIR}/${header}" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/hotblade/${folder}"
    COMPONENT development)
endforeach()
set(config ${CMAKE_INSTALL_LIBDIR}/cmake/hotblade)
foreach(part IN ITEMS curves rest)
  install(TARGETS ${rooms_${part}} EXPORT hotblade_${part} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
    COMPONENT development)
  install(EXPORT hotblade_${part} NAMESPACE hotblade:: DESTINATION ${config} FILE hotblade-${part}.cmake
    COMPONENT development)
endforeach()
configure_package_config_file(cmake/hotbladeConfig.cmake.in "${PROJECT_BINARY_DIR}/hotbladeConfig.cmake"
  INSTALL_DESTINATION ${config})
write_basic_package_version_file("${PROJECT_BINARY_DIR}/hotbladeConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/hotbladeConfig.cmake" "${PROJECT_BINARY_DIR}/hotbladeConfigVersion.cmake"
  DESTINATION ${config} COMPONENT development)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "hotblade maintainers <hotblade@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Plan hot-blade cutting of architectural formwork")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL program development)
if(HOTBLADE_BUILD_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
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
# The curves need no more; the rest of the library does.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS
  "libopenmesh-dev, libcgal-dev, libceres-dev, libmodbus-dev, libtomlplusplus-dev, nlohmann-json3-dev, libfmt-dev, libtinyxml2-dev, libfcl-dev, libtbb-dev, ocl-icd-opencl-dev, libssl-dev, zlib1g-dev, pkg-config")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-hotblade)
set(CPACK_DEBIAN_PYTHON_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
if(HOTBLADE_BUILD_PYTHON)
  include(cmake/HotbladePythonDepends.cmake)
endif()
include(CPack)
