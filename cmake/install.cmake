# What `cmake --install` puts in place: library, headers, program, laves.pc for pkg-config, and the files by which
# find_package(laves) gives the target laves::laves. A static library names what it leans on, so both find it.
# Components, which become packages: library, development, program, python (package.cmake).
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/laves)

install(TARGETS laves EXPORT laves-targets
  LIBRARY COMPONENT library NAMELINK_COMPONENT development
  ARCHIVE COMPONENT development RUNTIME COMPONENT library)
install(DIRECTORY include/laves/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/laves COMPONENT development FILES_MATCHING PATTERN "*.h")
install(FILES ${PROJECT_BINARY_DIR}/include/laves/version.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/laves COMPONENT development)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
if(TARGET laves-program)
  install(TARGETS laves-program COMPONENT program)
endif()

# Man page and completion, which the program prints from its table of options: where it can be run while it is built.
if(TARGET laves-program AND (NOT CMAKE_CROSSCOMPILING OR CMAKE_CROSSCOMPILING_EMULATOR))
  set(help_dir ${PROJECT_BINARY_DIR}/help)
  # laves_print_help(FILE FOLDER OPTIONS...): what `laves help OPTIONS` prints becomes FILE and is installed in FOLDER.
  function(laves_print_help file folder)
    string(JOIN " " options ${ARGN})
    add_custom_command(OUTPUT ${help_dir}/${file}
      COMMAND ${CMAKE_COMMAND} "-DPROGRAM=$<TARGET_FILE:laves-program>" "-DEMULATOR=${CMAKE_CROSSCOMPILING_EMULATOR}"
              "-DOPTIONS=${options}" "-DOUTPUT=${help_dir}/${file}" -P ${PROJECT_SOURCE_DIR}/cmake/print_help.cmake
      DEPENDS laves-program ${PROJECT_SOURCE_DIR}/cmake/print_help.cmake VERBATIM)
    set_property(GLOBAL APPEND PROPERTY LAVES_HELP_FILES ${help_dir}/${file})
    install(FILES ${help_dir}/${file} DESTINATION ${folder} COMPONENT program)
  endfunction()
  laves_print_help(laves.1 ${CMAKE_INSTALL_MANDIR}/man1 --man)
  laves_print_help(laves ${CMAKE_INSTALL_DATADIR}/bash-completion/completions --completion bash)
  laves_print_help(_laves ${CMAKE_INSTALL_DATADIR}/zsh/site-functions --completion zsh)
  laves_print_help(laves.fish ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d --completion fish)
  get_property(help_files GLOBAL PROPERTY LAVES_HELP_FILES)
  add_custom_target(laves-help ALL DEPENDS ${help_files})
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
# The way up from the file's folder, so that a copy works wherever it is; the library's folder may be lib or lib/TRIPLET.
set(LAVES_PC_PREFIX ${CMAKE_INSTALL_PREFIX})
if(NOT IS_ABSOLUTE "${CMAKE_INSTALL_LIBDIR}")
  file(RELATIVE_PATH LAVES_PC_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
  set(LAVES_PC_PREFIX "\${pcfiledir}/${LAVES_PC_PREFIX}")
  string(REGEX REPLACE "/$" "" LAVES_PC_PREFIX "${LAVES_PC_PREFIX}")
endif()
configure_file(cmake/laves.pc.in ${PROJECT_BINARY_DIR}/laves.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/laves.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)

# find_package
install(EXPORT laves-targets NAMESPACE laves:: DESTINATION ${package_dir} COMPONENT development)
configure_package_config_file(cmake/laves-config.cmake.in ${PROJECT_BINARY_DIR}/laves-config.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/laves-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/laves-config.cmake ${PROJECT_BINARY_DIR}/laves-config-version.cmake
  DESTINATION ${package_dir} COMPONENT development)
