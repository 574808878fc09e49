# What packages hold beside what install.cmake installs, and how CPack makes them: four for Debian and one tar of everything,
# which runs wherever it is unpacked.
#
#   liblaves0.1    the shared library          component library
#   liblaves-dev   header, laves.pc, CMake     component development
#   laves          program, man page, ...      component program
#   python3-laves  the Python package          component python
if(NOT BUILD_SHARED_LIBS)
  message(FATAL_ERROR "packages hold a shared library: set BUILD_SHARED_LIBS to ON, as the preset `package` does")
endif()
find_package(Python3 REQUIRED COMPONENTS Interpreter)
find_program(LAVES_GZIP gzip REQUIRED)
mark_as_advanced(LAVES_GZIP)

set(LAVES_MAINTAINER "The laves authors <maintainer@laves.invalid>" CACHE STRING "name and address that packages carry")
set(LAVES_PACKAGE_REVISION 1 CACHE STRING "number behind the version of Debian packages")
set(soname ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(deb_version ${PROJECT_VERSION}-${LAVES_PACKAGE_REVISION})
set(papers ${PROJECT_BINARY_DIR}/packaging)

# ---- Python: as the wheel has it, with links to library and program for the copies that a wheel carries ----

set(python_dir lib/python3/dist-packages/laves)
install(DIRECTORY python/laves/ DESTINATION ${python_dir} COMPONENT python
  FILES_MATCHING PATTERN "*.py" PATTERN "py.typed" PATTERN "__pycache__" EXCLUDE)
# laves_install_link(TARGET FOLDER NAME): a relative link, so that it holds below any prefix.
function(laves_install_link target folder name)
  file(RELATIVE_PATH way /${folder} /${target})
  file(MAKE_DIRECTORY ${papers}/${folder})
  file(CREATE_LINK ${way} ${papers}/${folder}/${name} SYMBOLIC)
  install(FILES ${papers}/${folder}/${name} DESTINATION ${folder} COMPONENT python)
endfunction()
laves_install_link(${CMAKE_INSTALL_LIBDIR}/liblaves.so.${soname} ${python_dir}/lib liblaves.so.${soname})
laves_install_link(${CMAKE_INSTALL_BINDIR}/laves ${python_dir}/bin laves)

# ---- papers: copyright and changelogs of each package, bill of materials ----

# Of the version's last change where the environment says when that was, so that the same sources give the same packages.
string(TIMESTAMP LAVES_DATE "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(READ LICENSE license)
string(REGEX REPLACE "^[^\n]*\n\n[^\n]*\n\n" "" license "${license}")
string(REGEX REPLACE "\n$" "" license "${license}")
string(REGEX REPLACE "\n\n" "\n.\n" license "${license}")
string(REGEX REPLACE "\n" "\n " LAVES_LICENSE " ${license}")
configure_file(packaging/copyright.in ${papers}/copyright @ONLY)
configure_file(packaging/changelog.in ${papers}/changelog.Debian @ONLY)
configure_file(CHANGELOG.md ${papers}/changelog COPYONLY)
foreach(file changelog changelog.Debian)
  execute_process(COMMAND ${LAVES_GZIP} -9nkf ${papers}/${file} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
# Sets are component:package.
foreach(pair library:liblaves${soname} development:liblaves-dev program:laves python:python3-laves)
  string(REPLACE ":" ";" pair ${pair})
  list(GET pair 0 component)
  list(GET pair 1 package)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${package})
  install(FILES ${papers}/copyright ${papers}/changelog.gz ${papers}/changelog.Debian.gz
    DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/${package} COMPONENT ${component})
endforeach()

set(bill ${PROJECT_BINARY_DIR}/laves.spdx.json)
add_custom_command(OUTPUT ${bill} VERBATIM
  COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tools/make_sbom.py --zlib ${ZLIB_VERSION_STRING} --lua ${LUA_VERSION_STRING}
          -o ${bill}
  DEPENDS tools/make_sbom.py web/package-lock.json VERSION LICENSE)
add_custom_target(laves-sbom ALL DEPENDS ${bill})
install(FILES ${bill} DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)

# ---- CPack ----

set(CPACK_GENERATOR DEB TGZ)
set(CPACK_PACKAGE_NAME laves)
set(CPACK_PACKAGE_VENDOR "")
set(CPACK_PACKAGE_CONTACT ${LAVES_MAINTAINER})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_PACKAGE_FILE_NAME laves-${PROJECT_VERSION}-linux-${CMAKE_SYSTEM_PROCESSOR})
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL library development program python)
set(CPACK_ARCHIVE_COMPONENT_INSTALL OFF)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE ${LAVES_PACKAGE_REVISION})
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR})
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(about "laves fills any solid, given as triangles or as a formula, with nearly regular
 tetrahedra, and states in a certificate how good they are.
 .")
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION "${about}
 It holds the shared library.")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/packaging/library/triggers)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")

set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "${about}
 It holds what programs are built with: header, files for pkg-config and CMake.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "liblaves${soname} (= ${deb_version})")

set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "${about}
 It holds the program, its man page and completion.")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION math)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "liblaves${soname} (= ${deb_version})")

set(CPACK_DEBIAN_PYTHON_DESCRIPTION "${about}
 It holds the Python package.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "liblaves${soname} (= ${deb_version}), python3:any (>= 3.8), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS laves)
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
  ${PROJECT_SOURCE_DIR}/packaging/python/postinst ${PROJECT_SOURCE_DIR}/packaging/python/prerm)
include(CPack)
