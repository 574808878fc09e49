# The proof of docs/proof.md. Bounds are rounded outward, so the compiler has to respect the rounding mode.
file(GLOB LAVES_PROOF_SOURCES CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/proof/*.c)
add_executable(proof ${LAVES_PROOF_SOURCES})
set_source_files_properties(${CMAKE_CURRENT_SOURCE_DIR}/proof/bound.c PROPERTIES COMPILE_OPTIONS -frounding-math)
target_include_directories(proof PRIVATE ${PROJECT_SOURCE_DIR}/src)
target_link_libraries(proof PRIVATE laves m)
add_test(NAME proof/angles COMMAND proof)
set_tests_properties(proof/angles PROPERTIES LABELS proof)
