# Every command, script and fragment in README and docs, run as a reader would (snippets.py). Nothing in them is new to sanitizers.
find_package(Python3 COMPONENTS Interpreter)
if(TARGET laves-program AND Python3_FOUND AND NOT LAVES_SANITIZE)
  add_test(NAME docs/snippets
    COMMAND Python3::Interpreter ${CMAKE_CURRENT_SOURCE_DIR}/docs/snippets.py --program $<TARGET_FILE:laves-program>
            --compiler ${CMAKE_C_COMPILER} --include ${PROJECT_SOURCE_DIR}/include --include ${PROJECT_BINARY_DIR}/include)
  set_tests_properties(docs/snippets PROPERTIES LABELS docs COST 50)
endif()
