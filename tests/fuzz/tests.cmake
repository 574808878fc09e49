# Fuzz targets: each fuzz/fuzz_NAME.c with its seeds in fuzz/corpus/NAME/ is
#   fuzz_NAME    a libFuzzer program, with LAVES_FUZZERS=ON and clang; the library is compiled again with its instruments
#   replay_NAME  the same target with replay.c, and CTest tests that run all seeds, and all of them altered, with any compiler
set(LAVES_FUZZ_FOLDER ${CMAKE_CURRENT_LIST_DIR})
file(GLOB LAVES_FUZZ_TARGETS CONFIGURE_DEPENDS ${LAVES_FUZZ_FOLDER}/fuzz_*.c)

if(LAVES_FUZZERS AND NOT CMAKE_C_COMPILER_ID MATCHES "Clang")
  message(FATAL_ERROR "LAVES_FUZZERS needs clang: configure with -DCMAKE_C_COMPILER=clang")
endif()
if(LAVES_FUZZERS)
  get_target_property(sources laves SOURCES)
  list(TRANSFORM sources REPLACE "^([^/].*)$" "${PROJECT_SOURCE_DIR}/\\1")
  add_library(laves-fuzzed STATIC ${sources})
  target_include_directories(laves-fuzzed PUBLIC ${PROJECT_SOURCE_DIR}/include ${PROJECT_BINARY_DIR}/include
    PRIVATE ${PROJECT_SOURCE_DIR}/src ${LUA_INCLUDE_DIR})
  target_compile_definitions(laves-fuzzed PRIVATE LAVES_BUILD PUBLIC LAVES_VALIDATE)
  target_compile_options(laves-fuzzed PUBLIC -g -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all)
  target_link_libraries(laves-fuzzed PUBLIC ZLIB::ZLIB ${LUA_LIBRARIES} Threads::Threads m)
endif()

add_custom_target(fuzz-targets) # all of them, and nothing else
foreach(source ${LAVES_FUZZ_TARGETS})
  get_filename_component(target ${source} NAME_WE)
  string(REPLACE "fuzz_" "" name ${target})
  add_executable(replay_${name} ${source} ${LAVES_FUZZ_FOLDER}/replay.c)
  target_link_libraries(replay_${name} PRIVATE laves m)
  add_test(NAME fuzz/replay_${name} COMMAND replay_${name} ${LAVES_FUZZ_FOLDER}/corpus/${name})
  set_tests_properties(fuzz/replay_${name} PROPERTIES LABELS fuzz)
  if(NOT name STREQUAL "pipeline" AND NOT LAVES_SANITIZE) # a mesh for each byte would take too long; so would sanitizers
    add_test(NAME fuzz/alter_${name} COMMAND replay_${name} --alter ${LAVES_FUZZ_FOLDER}/corpus/${name})
    set_tests_properties(fuzz/alter_${name} PROPERTIES LABELS fuzz TIMEOUT 600)
  endif()
  set(programs replay_${name})
  if(LAVES_FUZZERS)
    add_executable(${target} ${source})
    target_link_libraries(${target} PRIVATE laves-fuzzed)
    target_link_options(${target} PRIVATE -fsanitize=fuzzer,address,undefined)
    list(APPEND programs ${target})
  endif()
  add_dependencies(fuzz-targets ${programs})
  foreach(program ${programs})
    target_include_directories(${program} PRIVATE ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR}/tests)
  endforeach()
endforeach()
