# ctest reads this file after the discovered tests. It gives the label `quick` to the tests of the suites that
# quick_tests.txt lists. Once all programs are built, a suite that none of them has is
# an error.
file(STRINGS "${CMAKE_CURRENT_LIST_DIR}/quick_tests.txt" lines REGEX "^[a-z]")
set(missing "")
set(all_built TRUE)
foreach(line IN LISTS lines)
  string(REGEX REPLACE "^[^:]*: *" "" suites "${line}")
  string(REPLACE " " ";" suites "${suites}")
  list(APPEND missing ${suites})
endforeach()
set(quick ${missing})
foreach(program gib_tests gib_image_tests gib_mesh_tests gib_fuzz_findings_tests gib_hard_case_tests gib_degenerate_tests
                gib_machine_tests gib_property_tests gib_sampler_tests)
  if(NOT DEFINED ${program}_TESTS)
    set(all_built FALSE)
  endif()
  foreach(test IN LISTS ${program}_TESTS)
    # A parameterised test is called Instance/Suite.Test/parameter.
    string(REGEX REPLACE "^([^./]*/)?([^./]+)\\..*$" "\\2" suite "${test}")
    # ctest reads this with CMake's oldest policies, which have no IN_LIST.
    list(FIND quick "${suite}" index)
    if(NOT index EQUAL -1)
      set_tests_properties("${test}" PROPERTIES LABELS quick)
      list(REMOVE_ITEM missing "${suite}")
    endif()
  endforeach()
endforeach()
if(missing AND all_built)
  message(FATAL_ERROR "quick_tests.txt lists suites that no test program has: ${missing}")
endif()
