# The man page and bash's completion, out of the program's own --help. A program that does not run
# here (another machine's, or an instrumented one) has neither.
find_package(Python3 COMPONENTS Interpreter)
if(NOT Python3_Interpreter_FOUND OR CMAKE_CROSSCOMPILING OR IMPACTDIC_SANITIZE)
  message(STATUS "No man page and no completion: they need Python 3 and a program that runs here")
  return()
endif()
set(pages ${CMAKE_BINARY_DIR}/pages)
set(writer ${CMAKE_SOURCE_DIR}/scripts/help_pages.py)
file(MAKE_DIRECTORY ${pages}/completions)
add_custom_command(
  OUTPUT ${pages}/impactdic.1 ${pages}/completions/impactdic
  COMMAND ${Python3_EXECUTABLE} ${writer} man $<TARGET_FILE:impactdic> ${pages}/impactdic.1
  COMMAND ${Python3_EXECUTABLE} ${writer} bash $<TARGET_FILE:impactdic>
          ${pages}/completions/impactdic
  DEPENDS impactdic ${writer}
  COMMENT "Man page and completion"
  VERBATIM)
add_custom_target(pages ALL DEPENDS ${pages}/impactdic.1 ${pages}/completions/impactdic)
install(FILES ${pages}/impactdic.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${pages}/completions/impactdic
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
