# What `cmake --install` puts in place: library, headers, program, laves.pc for pkg-config, and the files by which
# find_package(laves) gives the target laves::laves. A static library names what it leans on, so both find it.
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/laves)

install(TARGETS laves EXPORT laves-targets)
install(DIRECTORY include/laves/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/laves FILES_MATCHING PATTERN "*.h")
install(FILES ${PROJECT_BINARY_DIR}/include/laves/version.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/laves)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
if(TARGET laves-program)
  install(TARGETS laves-program)
endif()

# pkg-config. Lua has no package name of its own that holds on every system, so it goes in by library.
set(LAVES_PC_LIBS_PRIVATE "-lz")
foreach(library ${LUA_LIBRARIES})
  get_filename_component(name ${library} NAME_WLE)
  string(REGEX REPLACE "^lib" "-l" name ${name})
  string(REGEX REPLACE "^m$" "-lm" name ${name})
  string(APPEND LAVES_PC_LIBS_PRIVATE " ${name}")
endforeach()
string(APPEND LAVES_PC_LIBS_PRIVATE " ${CMAKE_THREAD_LIBS_INIT} -lm")
set(LAVES_PC_CFLAGS "")
if(LAVES_OPENMP)
  string(APPEND LAVES_PC_LIBS_PRIVATE " ${OpenMP_C_FLAGS}")
endif()
set(LAVES_PC_LIBS "-llaves")
if(NOT BUILD_SHARED_LIBS)
  string(APPEND LAVES_PC_LIBS " ${LAVES_PC_LIBS_PRIVATE}")
  set(LAVES_PC_LIBS_PRIVATE "")
  set(LAVES_PC_CFLAGS "-DLAVES_STATIC")
endif()
configure_file(cmake/laves.pc.in ${PROJECT_BINARY_DIR}/laves.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/laves.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

# find_package
install(EXPORT laves-targets NAMESPACE laves:: DESTINATION ${package_dir})
configure_package_config_file(cmake/laves-config.cmake.in ${PROJECT_BINARY_DIR}/laves-config.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/laves-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/laves-config.cmake ${PROJECT_BINARY_DIR}/laves-config-version.cmake
  DESTINATION ${package_dir})
