# Each tests/cli/*.case is a CTest test: the program by example, run by run.py.
find_package(Python3 COMPONENTS Interpreter)
if(TARGET laves-program AND Python3_FOUND)
  file(GLOB LAVES_CLI_CASES CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/cli/*.case)
  if(LAVES_SANITIZE)
    list(FILTER LAVES_CLI_CASES EXCLUDE REGEX address_space)
  endif()
  foreach(case ${LAVES_CLI_CASES})
    get_filename_component(name ${case} NAME_WE)
    add_test(NAME cli/${name}
      COMMAND Python3::Interpreter ${CMAKE_CURRENT_SOURCE_DIR}/cli/run.py --program $<TARGET_FILE:laves-program> ${case})
    set_tests_properties(cli/${name} PROPERTIES LABELS cli SKIP_RETURN_CODE 77)
  endforeach()
endif()
