# Writes a manual page for the program and one for each of its commands, with their help texts as they stand:
# cmake -DPROGRAM=gibench -DVERSION=1 -DOUTPUT=FOLDER -P manual_pages.cmake
execute_process(COMMAND ${PROGRAM} --help OUTPUT_VARIABLE help COMMAND_ERROR_IS_FATAL ANY)
string(REGEX REPLACE ".*\nSubcommands:" "" commands "${help}")
string(REGEX MATCHALL "\n  [a-z-]+" commands "${commands}")
foreach(command "" ${commands})
  string(STRIP "${command}" command)
  string(JOIN "-" page gibench ${command})
  string(TOUPPER ${page} title)
  execute_process(COMMAND ${PROGRAM} ${command} --help OUTPUT_VARIABLE help COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX REPLACE "\nUsage:.*" "" summary "${help}")
  string(REGEX REPLACE "[ \n]+" " " summary "${summary}")
  string(REGEX REPLACE "^.*\nUsage:" "Usage:" help "${help}")
  # A dot or a quote at the start of a line would be a request of troff, and a plain hyphen is no minus.
  string(REPLACE "\\" "\\e" help "${help}")
  string(REPLACE "-" "\\-" help "${help}")
  string(REGEX REPLACE "\n([.'])" "\n\\\\&\\1" help "${help}")
  file(WRITE ${OUTPUT}/${page}.1
       ".TH ${title} 1 \"\" \"gibench ${VERSION}\"\n.SH NAME\n${page} \\- ${summary}\n.SH DESCRIPTION\n.nf\n${help}\n.fi\n")
endforeach()
