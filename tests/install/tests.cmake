# Installs into a scratch prefix and builds a small program against it, by pkg-config and by find_package.
add_test(NAME install/consumer
  COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/install/run ${PROJECT_BINARY_DIR} ${PROJECT_BINARY_DIR}/tests/install ${CMAKE_INSTALL_LIBDIR}
          ${LAVES_SANITIZE})
set_tests_properties(install/consumer PROPERTIES LABELS install ENVIRONMENT "CMAKE=${CMAKE_COMMAND};CC=${CMAKE_C_COMPILER}")
# A shared library of the same objects shows only what the header declares; and the bill of materials is one.
if(TARGET laves-shared AND NOT LAVES_SANITIZE)
  add_test(NAME install/symbols COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/install/symbols.py $<TARGET_FILE:laves-shared>
           ${PROJECT_SOURCE_DIR}/include/laves/laves.h)
endif()
add_test(NAME install/bill COMMAND sh -c "$0 $1 --zlib 1.2.13 --lua 5.4.4 -o bill.spdx.json && $0 $2 bill.spdx.json" ${Python3_EXECUTABLE}
         ${PROJECT_SOURCE_DIR}/tools/make_sbom.py ${CMAKE_CURRENT_SOURCE_DIR}/install/bill.py WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
get_property(tests DIRECTORY PROPERTY TESTS)
foreach(test ${tests})
  if(test MATCHES "^install/")
    set_tests_properties(${test} PROPERTIES LABELS install)
  endif()
endforeach()
