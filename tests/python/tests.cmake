# The Python package, from the source tree, on a shared library (laves-shared) of the same objects as the static one; each
# tests/python/test_*.py is a CTest test. They need a Python with NumPy, which need not be the first on the path. A Python without
# sanitizers cannot load a library that has them.
if(LAVES_SANITIZE OR NOT TARGET laves-program)
  return()
endif()
set(LAVES_PYTHON "")
foreach(candidate ${Python3_EXECUTABLE} /usr/bin/python3)
  if(NOT LAVES_PYTHON)
    execute_process(COMMAND ${candidate} -c "import numpy" RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
    if(NOT failed)
      set(LAVES_PYTHON ${candidate})
    endif()
  endif()
endforeach()

set_target_properties(laves-shared laves-callback PROPERTIES EXCLUDE_FROM_ALL OFF)

file(GLOB LAVES_PYTHON_TESTS CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/python/test_*.py)
foreach(path ${LAVES_PYTHON_TESTS})
  get_filename_component(name ${path} NAME_WE)
  if(LAVES_PYTHON)
    add_test(NAME python/${name} COMMAND ${LAVES_PYTHON} ${path})
  else()
    add_test(NAME python/${name} COMMAND sh -c "echo 'SKIPPED: there is no Python with NumPy (Debian: python3-numpy)'; exit 77")
  endif()
  set_tests_properties(python/${name} PROPERTIES LABELS python SKIP_RETURN_CODE 77 ENVIRONMENT
    "PYTHONPATH=${PROJECT_SOURCE_DIR}/python;PYTHONDONTWRITEBYTECODE=1;LAVES_LIBRARY=$<TARGET_FILE:laves-shared>;LAVES_PROGRAM=$<TARGET_FILE:laves-program>;LAVES_BUILD=${PROJECT_BINARY_DIR};CMAKE=${CMAKE_COMMAND};CC=${CMAKE_C_COMPILER}")
endforeach()
add_test(NAME tools/python_header COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/tools/same_output
         ${PROJECT_SOURCE_DIR}/python/laves/_header.py ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tools/make_python_header.py)
set_tests_properties(tools/python_header PROPERTIES LABELS tools)
