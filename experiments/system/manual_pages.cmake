# Writes a manual page for the program and one for each of its commands, as far as help2man is installed, which makes them of the
# help texts: cmake -DPROGRAM=gibench -DVERSION=1 -DOUTPUT=FOLDER -P manual_pages.cmake
file(MAKE_DIRECTORY ${OUTPUT})
find_program(HELP2MAN help2man)
if(NOT HELP2MAN)
  message(STATUS "There is no help2man, and so no manual page")
  return()
endif()
execute_process(COMMAND ${PROGRAM} --help OUTPUT_VARIABLE help COMMAND_ERROR_IS_FATAL ANY)
string(REGEX REPLACE ".*\nSubcommands:" "" commands "${help}")
string(REGEX MATCHALL "\n  [a-z-]+" commands "${commands}")
foreach(command "" ${commands})
  string(STRIP "${command}" command)
  string(JOIN "-" page gibench ${command})
  string(STRIP "${PROGRAM} ${command}" whole)
  execute_process(COMMAND ${PROGRAM} ${command} --help OUTPUT_VARIABLE help COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX REPLACE "\nUsage:.*" "" summary "${help}")
  string(REGEX REPLACE "[ \n]+" " " summary "${summary}")
  execute_process(
    COMMAND ${HELP2MAN} --no-info --version-string=${VERSION} "--name=${summary}" --output=${OUTPUT}/${page}.1 "${whole}"
    COMMAND_ERROR_IS_FATAL ANY)
endforeach()
