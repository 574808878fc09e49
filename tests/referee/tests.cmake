# Other programs read every format that laves writes and count and measure what they find, and laves reads what they write.
# Skipped, loudly, where a program is missing.
foreach(program write_formats write_graded count_mesh size_at)
  add_executable(${program} referee/${program}.c)
  target_link_libraries(${program} PRIVATE laves-fixtures)
endforeach()
foreach(referee meshio gmsh tetgen)
  add_test(NAME referee/read_with_${referee}
    COMMAND ${CMAKE_CURRENT_LIST_DIR}/read_with_${referee} $<TARGET_FILE:write_formats>)
  add_test(NAME referee/written_by_${referee}
    COMMAND ${CMAKE_CURRENT_LIST_DIR}/written_by_${referee} $<TARGET_FILE:count_mesh>)
  set_tests_properties(referee/read_with_${referee} referee/written_by_${referee} PROPERTIES LABELS referee SKIP_RETURN_CODE 77)
endforeach()
add_test(NAME referee/read_with_vtk COMMAND ${CMAKE_CURRENT_LIST_DIR}/read_with_vtk $<TARGET_FILE:write_formats>)
set_tests_properties(referee/read_with_vtk PROPERTIES LABELS referee SKIP_RETURN_CODE 77)
add_test(NAME referee/sizes_by_gmsh COMMAND ${CMAKE_CURRENT_LIST_DIR}/sizes_by_gmsh $<TARGET_FILE:size_at>)
set_tests_properties(referee/sizes_by_gmsh PROPERTIES LABELS referee SKIP_RETURN_CODE 77)
if(TARGET laves-program)
  add_test(NAME referee/solved_by_calculix COMMAND ${CMAKE_CURRENT_LIST_DIR}/solved_by_calculix $<TARGET_FILE:laves-program>)
  set_tests_properties(referee/solved_by_calculix PROPERTIES LABELS referee SKIP_RETURN_CODE 77)
  add_test(NAME referee/surfaces_by_gmsh COMMAND ${CMAKE_CURRENT_LIST_DIR}/surfaces_by_gmsh $<TARGET_FILE:laves-program>)
  set_tests_properties(referee/surfaces_by_gmsh PROPERTIES LABELS referee SKIP_RETURN_CODE 77)
endif()
# Exact arithmetic in another language has the second word on certificates, and refuses forged ones.
if(TARGET laves-program)
  add_test(NAME referee/certificates COMMAND ${CMAKE_CURRENT_LIST_DIR}/certificates $<TARGET_FILE:laves-program> $<TARGET_FILE:write_graded>)
  set_tests_properties(referee/certificates PROPERTIES LABELS referee)
endif()
