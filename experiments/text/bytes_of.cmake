# bytes_of(PATH RESULT) sets RESULT to the bytes of a file as numbers for a C++ array, because a compiler need not accept a
# string literal of a page's length.
function(bytes_of path result)
  file(READ ${path} hex HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
  string(REGEX REPLACE "(................................................................................)" "\\1\n" bytes "${bytes}")
  set(${result} "${bytes}" PARENT_SCOPE)
endfunction()
