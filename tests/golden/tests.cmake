# What a few inputs give, figure by figure. To renew the table after a change that is meant:
#   build/tests/golden_table > tests/golden/table.txt
add_executable(golden_table ${CMAKE_CURRENT_SOURCE_DIR}/golden/golden_table.c)
target_link_libraries(golden_table PRIVATE laves m)
add_test(NAME golden/table COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/tools/same_output ${CMAKE_CURRENT_SOURCE_DIR}/golden/table.txt
         $<TARGET_FILE:golden_table>)
set_tests_properties(golden/table PROPERTIES LABELS golden)
