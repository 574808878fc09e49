# The pages of `laves report`: what they hold, whether the program carries the page that web/ makes, and what a reader can do. The
# last two are skipped, loudly, where Node, the packages of web/ or Chromium are missing (tools/setup report).
if(TARGET laves-program)
  find_package(Python3 COMPONENTS Interpreter)
  add_test(NAME report/pages
    COMMAND Python3::Interpreter ${CMAKE_CURRENT_LIST_DIR}/check_pages $<TARGET_FILE:laves-program>)
  set_tests_properties(report/pages PROPERTIES LABELS report)
  if(NOT LAVES_SANITIZE)
    add_test(NAME report/template COMMAND ${CMAKE_CURRENT_LIST_DIR}/same_template)
    add_test(NAME report/browser COMMAND ${CMAKE_CURRENT_LIST_DIR}/browser $<TARGET_FILE:laves-program>)
    set_tests_properties(report/template report/browser PROPERTIES LABELS report SKIP_RETURN_CODE 77)
    set_tests_properties(report/browser PROPERTIES TIMEOUT 300 COST 100)
  endif()
endif()
