# SPDX-License-Identifier: Apache-2.0
# The library as others use it: clray::clray (shared) and clray::static, made of the objects of the modules, and what
# `cmake --install` copies: both, the public headers, the CMake package and clray.pc. Users see include/clray and GLM.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(objects "")
foreach(module text ephemeris scene body pass beam exact kernels device slr pipeline io)
  list(APPEND objects $<TARGET_OBJECTS:clray_${module}>)
endforeach()
set(used fmt::fmt OpenCL::OpenCL OpenMeshCore OpenMeshTools PNG::PNG PkgConfig::openexr PkgConfig::cfitsio
    PkgConfig::netcdf PkgConfig::erfa Threads::Threads)

file(WRITE ${PROJECT_BINARY_DIR}/library.cpp "// The objects of the modules make the library.\n")
add_library(clray_shared SHARED ${PROJECT_BINARY_DIR}/library.cpp ${objects})
target_link_libraries(clray_shared PRIVATE ${used})
target_link_options(clray_shared PRIVATE LINKER:--exclude-libs,ALL
                    LINKER:--version-script=${PROJECT_SOURCE_DIR}/cmake/library.map)
set_target_properties(clray_shared PROPERTIES OUTPUT_NAME clray VERSION ${PROJECT_VERSION} EXPORT_NAME clray
                      SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
                      LINK_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/library.map)
add_library(clray_static STATIC ${PROJECT_BINARY_DIR}/library.cpp ${objects})
target_link_libraries(clray_static PRIVATE ${used})
set_target_properties(clray_static PROPERTIES OUTPUT_NAME clray EXPORT_NAME static)
foreach(library clray_shared clray_static)
  target_include_directories(${library} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                                               $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(${library} PUBLIC cxx_std_17)
  add_dependencies(${library} clray_text clray_ephemeris clray_scene clray_body clray_pass clray_beam clray_exact
                   clray_kernels clray_device clray_slr clray_pipeline clray_io)
endforeach()
add_library(clray::clray ALIAS clray_shared)
add_library(clray::static ALIAS clray_static)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/clray)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/clray DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT library)
install(TARGETS clray_shared EXPORT clray_shared LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
install(TARGETS clray_static EXPORT clray_static ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library)
install(EXPORT clray_shared NAMESPACE clray:: DESTINATION ${package} COMPONENT library)
install(EXPORT clray_static NAMESPACE clray:: DESTINATION ${package} COMPONENT library)
configure_package_config_file(cmake/clrayConfig.cmake.in ${PROJECT_BINARY_DIR}/clrayConfig.cmake
                              INSTALL_DESTINATION ${package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/clrayConfigVersion.cmake COMPATIBILITY SameMinorVersion)
configure_file(cmake/clray.pc.in ${PROJECT_BINARY_DIR}/clray.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/clrayConfig.cmake ${PROJECT_BINARY_DIR}/clrayConfigVersion.cmake
        DESTINATION ${package} COMPONENT library)
install(FILES ${PROJECT_BINARY_DIR}/clray.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT library)
