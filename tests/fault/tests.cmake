# What fails: allocations and writes. Quick runs; LAVES_EVERY=1 makes test_allocations take every allocation.
add_executable(test_allocations fault/test_allocations.c fault/jobs.c fault/job_inputs.c fault/refuser.c)
target_link_libraries(test_allocations PRIVATE laves-fixtures PkgConfig::JANSSON)
add_test(NAME fault/test_allocations COMMAND test_allocations WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
set_tests_properties(fault/test_allocations PROPERTIES LABELS fault)
