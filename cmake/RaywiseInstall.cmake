# What an install holds: the layers, the umbrella target, headers, find_package(raywise CONFIG) and pkg-config files.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/raywise)
get_property(layers GLOBAL PROPERTY RAYWISE_LAYERS)
install(TARGETS ${layers} raywise EXPORT raywise-targets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT raywise-targets NAMESPACE raywise:: DESTINATION ${package_dir})
configure_package_config_file(
    ${CMAKE_CURRENT_LIST_DIR}/raywise-config.cmake.in ${PROJECT_BINARY_DIR}/raywise-config.cmake
    INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(
    ${PROJECT_BINARY_DIR}/raywise-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/raywise-config.cmake ${PROJECT_BINARY_DIR}/raywise-config-version.cmake
    DESTINATION ${package_dir})

# Static archives are listed from the top layer down, as linkers want them.
set(archives ${layers})
list(REVERSE archives)
list(TRANSFORM archives PREPEND -l)
list(JOIN archives " " RAYWISE_PC_LIBS)
configure_file(${CMAKE_CURRENT_LIST_DIR}/raywise.pc.in ${PROJECT_BINARY_DIR}/raywise.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/raywise.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
