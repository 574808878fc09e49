# The tables in the tree are what their generators make; the list of sources is up to date; links and keys of documents hold.
find_package(Qhull CONFIG)
if(Qhull_FOUND)
  add_executable(make_tiling ${PROJECT_SOURCE_DIR}/tools/make_tiling.c)
  target_compile_options(make_tiling PRIVATE -w) # Qhull's header warns
  target_link_libraries(make_tiling PRIVATE Qhull::qhull_r m)
  add_test(NAME tools/tiling COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/tools/same_output ${PROJECT_SOURCE_DIR}/src/background/c15_table.c
           $<TARGET_FILE:make_tiling>)
endif()
find_package(Python3 REQUIRED COMPONENTS Interpreter)
add_test(NAME tools/knot COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/tools/same_output ${PROJECT_SOURCE_DIR}/demo/knot.ply
         ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tools/make_knot.py)
add_test(NAME tools/pow10_table COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/tools/same_output ${PROJECT_SOURCE_DIR}/src/io/pow10_table.c
         ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tools/make_pow10_table.py)
add_test(NAME tools/source_list COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tools/source_list.py)
add_test(NAME tools/check_docs COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tools/check_docs.py)
add_test(NAME tools/api_reference COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tools/api_reference.py)
add_test(NAME tools/site COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/tools/site.py ${CMAKE_CURRENT_BINARY_DIR}/site)
set_tests_properties(tools/site PROPERTIES SKIP_RETURN_CODE 77)
if(TARGET laves-program)
  add_test(NAME tools/help_files COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/tools/help_files.py $<TARGET_FILE:laves-program>)
endif()
if(TARGET laves-program AND NOT LAVES_SANITIZE)
  add_test(NAME tools/paper COMMAND ${PROJECT_SOURCE_DIR}/bench/paper/run $<TARGET_FILE:laves-program> --quick --models ""
           -o ${CMAKE_CURRENT_BINARY_DIR}/paper)
endif()
get_property(tests DIRECTORY PROPERTY TESTS)
foreach(test ${tests})
  if(test MATCHES "^tools/")
    set_tests_properties(${test} PROPERTIES LABELS tools)
  endif()
endforeach()
