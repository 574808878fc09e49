# Installs into a scratch prefix and builds a small program against it, by pkg-config and by find_package.
add_test(NAME install/consumer
  COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/install/run ${PROJECT_BINARY_DIR} ${PROJECT_BINARY_DIR}/tests/install ${CMAKE_INSTALL_LIBDIR}
          ${LAVES_SANITIZE})
set_tests_properties(install/consumer PROPERTIES LABELS install ENVIRONMENT "CMAKE=${CMAKE_COMMAND};CC=${CMAKE_C_COMPILER}")
