# find_package(raywise CONFIG) and pkg-config.
include(CMakePackageConfigHelpers)

get_property(layers GLOBAL PROPERTY RAYWISE_LAYERS)
install(TARGETS ${layers} raywise EXPORT raywise-targets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT raywise-targets NAMESPACE raywise:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/raywise)
