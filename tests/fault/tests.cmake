# What fails: allocations and writes. Quick runs; with LAVES_EVERY=1 in the environment every single one.
add_executable(test_allocations fault/test_allocations.c fault/jobs.c fault/job_inputs.c fault/refuser.c)
target_link_libraries(test_allocations PRIVATE laves-fixtures)

add_executable(test_writes fault/test_writes.c fault/faulty_system.c)
target_link_libraries(test_writes PRIVATE laves-fixtures)
foreach(call open write pwrite close rename link sysconf)
  target_link_options(test_writes PRIVATE -Wl,--wrap=${call})
endforeach()

foreach(name test_allocations test_writes)
  add_test(NAME fault/${name} COMMAND ${name} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  set_tests_properties(fault/${name} PROPERTIES LABELS fault)
endforeach()

# The program itself. Its allocations fail by a library loaded before it, which needs glibc and suits no sanitizer.
if(TARGET laves-program AND Python3_FOUND)
  set(preload)
  if(CMAKE_SYSTEM_NAME STREQUAL "Linux" AND NOT LAVES_SANITIZE)
    add_library(fault_preload MODULE fault/preload.c)
    target_link_libraries(fault_preload PRIVATE ${CMAKE_DL_LIBS})
    set(preload --preload $<TARGET_FILE:fault_preload>)
  endif()
  add_test(NAME fault/program
    COMMAND Python3::Interpreter ${CMAKE_CURRENT_SOURCE_DIR}/fault/program.py --program $<TARGET_FILE:laves-program> ${preload})
  set_tests_properties(fault/program PROPERTIES LABELS fault)
endif()
