# Other programs read every format that laves writes and count and measure what they find. Skipped, loudly, where a
# program is missing.
add_executable(write_formats referee/write_formats.c ${LAVES_FIXTURES})
target_include_directories(write_formats PRIVATE ${PROJECT_SOURCE_DIR}/src ${CMAKE_CURRENT_SOURCE_DIR})
target_link_libraries(write_formats PRIVATE laves PkgConfig::CMOCKA)
foreach(referee meshio gmsh)
  add_test(NAME referee/${referee}
    COMMAND ${CMAKE_CURRENT_LIST_DIR}/read_with_${referee} $<TARGET_FILE:write_formats>)
  set_tests_properties(referee/${referee} PROPERTIES LABELS referee SKIP_RETURN_CODE 77)
endforeach()
