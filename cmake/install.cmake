# What is installed: the command, the libraries with their headers, the documents and the manual. Nothing that is installed
# knows the source tree, and a prefix can be moved.
include(CMakePackageConfigHelpers)

set(cmake_folder ${CMAKE_INSTALL_LIBDIR}/cmake/isoshade)
set(pkgconfig_folder ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
set(data_folder ${CMAKE_INSTALL_DATADIR}/isoshade)

set(libraries compiler)
if(ISOSHADE_RUNTIME)
  list(APPEND libraries runtime)
endif()
set(targets isoshade_generated)
foreach(library ${libraries})
  list(APPEND targets isoshade_${library})
endforeach()
if(ISOSHADE_COMMAND)
  list(APPEND targets isoshade)
endif()
install(TARGETS ${targets} EXPORT isoshadeTargets)
install(EXPORT isoshadeTargets NAMESPACE isoshade:: DESTINATION ${cmake_folder})

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/isoshadeConfig.cmake.in
  ${PROJECT_BINARY_DIR}/generated/isoshadeConfig.cmake INSTALL_DESTINATION ${cmake_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/generated/isoshadeConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES
  ${PROJECT_BINARY_DIR}/generated/isoshadeConfig.cmake
  ${PROJECT_BINARY_DIR}/generated/isoshadeConfigVersion.cmake
  ${PROJECT_SOURCE_DIR}/cmake/isoshade_add_graph.cmake
  DESTINATION ${cmake_folder})

# isoshade_compiler.pc, isoshade_runtime.pc; paths relative to the file, so that the prefix can be moved.
file(RELATIVE_PATH prefix_from_pkgconfig /${pkgconfig_folder} /)
set(description_of_compiler "Compiles shader graphs to GLSL, C++ and SPIR-V")
set(description_of_runtime "Renders scenes of shader graphs with the same bits on every machine")
foreach(library ${libraries})
  set(description ${description_of_${library}})
  configure_file(${PROJECT_SOURCE_DIR}/cmake/isoshade.pc.in
    ${PROJECT_BINARY_DIR}/generated/isoshade_${library}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/generated/isoshade_${library}.pc DESTINATION ${pkgconfig_folder})
endforeach()

# The headers; include/isoshade/lanes is a link to the folder whose headers are listed.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/isoshade DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  FILES_MATCHING PATTERN "*.h" PATTERN lanes EXCLUDE)
install(FILES ${ISOSHADE_VERSION_FOLDER}/isoshade/version.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/isoshade)
get_property(lanes_headers GLOBAL PROPERTY ISOSHADE_LANES_HEADERS)
foreach(header ${lanes_headers})
  cmake_path(GET header FILENAME name)
  install(FILES ${PROJECT_SOURCE_DIR}/runtime/lanes/${name} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/isoshade/lanes)
endforeach()

# share/isoshade/library holds the functions that documents use by name.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/graphs/ DESTINATION ${data_folder} PATTERN README.md EXCLUDE)
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${PROJECT_SOURCE_DIR}/graphs/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/graphs)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs DESTINATION ${CMAKE_INSTALL_DOCDIR})

# cpack -G DEB (scripts/package.sh). dpkg-shlibdeps finds the libraries that the binaries load when they start; drivers and
# compilers are looked for at run time.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME isoshade)
set(CPACK_PACKAGE_CONTACT "The isoshade authors <isoshade@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "g++ | c++-compiler, libvulkan1, mesa-vulkan-drivers")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "cmake, pkg-config, graphviz, gnuplot-nox")
include(CPack)
