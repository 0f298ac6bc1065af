# What `cmake --install` and the Debian package put where: the program, the data it
# reads (share/polyglide mirrors the source tree), and libraries with headers.
include(CMakePackageConfigHelpers)

set(data ${CMAKE_INSTALL_DATADIR}/polyglide)
install(DIRECTORY catalog/data catalog/schema DESTINATION ${data}/catalog COMPONENT program)
install(DIRECTORY examples DESTINATION ${data} COMPONENT program)
install(FILES README.md LICENSE CHANGELOG.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR}
        COMPONENT program)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/Polyglide)
install(EXPORT polyglide NAMESPACE polyglide:: FILE PolyglideTargets.cmake DESTINATION ${package}
        COMPONENT dev)
configure_package_config_file(cmake/PolyglideConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/PolyglideConfig.cmake
                              INSTALL_DESTINATION ${package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/PolyglideConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/PolyglideConfig.cmake
              ${PROJECT_BINARY_DIR}/PolyglideConfigVersion.cmake
        DESTINATION ${package} COMPONENT dev)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME polyglide)
set(CPACK_PACKAGE_CONTACT "polyglide developers")
set(CPACK_PACKAGE_DESCRIPTION
    "Enumerates layouts of parallel kinematic machines, rejects those that are kinematically
uncertain and says why, tunes the dimensions of the rest and writes a ranked design report.")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS
    "chromium-headless-shell, libboost-dev, libeigen3-dev, nlohmann-json3-dev, libtbb-dev, libnlopt-cxx-dev, libfcl-dev, libfmt-dev, liblapacke-dev, libmuparser-dev, libsqlitecpp-dev, libnauty2-dev")
include(CPack)
