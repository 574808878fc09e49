# Writes what `PROGRAM help OPTIONS` prints to OUTPUT, whole or not at all. EMULATOR, perhaps empty, runs the program.
separate_arguments(options UNIX_COMMAND "${OPTIONS}")
execute_process(COMMAND ${EMULATOR} "${PROGRAM}" help ${options} OUTPUT_VARIABLE text RESULT_VARIABLE code)
if(NOT code EQUAL 0)
  message(FATAL_ERROR "'laves help ${OPTIONS}' ended with ${code}")
endif()
file(WRITE "${OUTPUT}.part" "${text}")
file(RENAME "${OUTPUT}.part" "${OUTPUT}")
