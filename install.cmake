# Installs the program and what it reads at run time (cmake --install build/release --prefix FOLDER), and makes a Debian
# package of that (cmake --workflow --preset package). The program finds its files relative to itself
# (common/core/program_file.h), so that FOLDER may be moved.
install(TARGETS gibench RUNTIME DESTINATION bin)
install(TARGETS gib_images LIBRARY DESTINATION lib/gibench)
# Libraries that are not in the system's folders, such as an Embree of one's own, are found where they were at build time.
set_target_properties(gibench gib_images PROPERTIES INSTALL_RPATH_USE_LINK_PATH ON)

# The scenes of an experiment are relative to its file. scripts/meshes makes the large meshes of scenes/meshes/generated/.
file(GLOB experiment_files CONFIGURE_DEPENDS experiments/*.toml)
install(FILES ${experiment_files} experiments/README.md experiments/MORE.md DESTINATION share/gibench/experiments)
install(DIRECTORY scenes DESTINATION share/gibench PATTERN generated EXCLUDE)
install(PROGRAMS scripts/meshes DESTINATION share/gibench/scripts)

install(CODE "execute_process(COMMAND $<TARGET_FILE:gibench> completion bash OUTPUT_FILE ${PROJECT_BINARY_DIR}/completion.bash
                              COMMAND_ERROR_IS_FATAL ANY)")
install(FILES ${PROJECT_BINARY_DIR}/completion.bash DESTINATION share/bash-completion/completions RENAME gibench)

install(CODE "execute_process(COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:gibench> -DVERSION=${PROJECT_VERSION}
                              -DOUTPUT=${PROJECT_BINARY_DIR}/man1 -P ${CMAKE_CURRENT_SOURCE_DIR}/experiments/system/manual_pages.cmake
                              COMMAND_ERROR_IS_FATAL ANY)")
install(DIRECTORY ${PROJECT_BINARY_DIR}/man1 DESTINATION share/man)

# The licence, and those of the libraries whose code is in the program, as Debian has them.
file(READ LICENSE copyright)
set(licences libcli11-dev libeigen3-dev libboost-dev libkainjow-mustache-dev libtomlplusplus-dev nlohmann-json3-dev libjs-chart.js)
list(TRANSFORM licences REPLACE "(.+)" "/usr/share/doc/\\1/copyright")
foreach(licence ${licences} ${GIB_THREE}/LICENSE ${CMAKE_CURRENT_SOURCE_DIR}/common/color/hosek_wilkie.license)
  if(EXISTS ${licence})
    file(READ ${licence} text)
    string(APPEND copyright "\n\nThe program also contains code under the licence ${licence}:\n\n${text}")
  endif()
endforeach()
file(WRITE ${PROJECT_BINARY_DIR}/copyright "${copyright}")
install(FILES ${PROJECT_BINARY_DIR}/copyright DESTINATION share/doc/gibench)

set(CPACK_GENERATOR DEB)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "bash-completion, glmark2-data, python3")  # the last two for scripts/meshes
set(CPACK_STRIP_FILES ON)
# The project has no address; -DCPACK_PACKAGE_CONTACT="NAME <ADDRESS>" sets that of who hands the package on.
if(NOT CPACK_PACKAGE_CONTACT)
  set(CPACK_PACKAGE_CONTACT "the gibench authors <gibench@localhost>")
endif()
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "test-bench for global illumination methods")
set(CPACK_PACKAGE_DESCRIPTION
    "gibench renders the same scene with several global illumination methods and
measures each against a converged reference whose own error is known. It
reports what every step of accuracy costs in time, whether the error that
remains is bias or noise, and which light transport each method simulated or
left out.")
# A package has to run on every processor of its architecture.
if(GIB_NATIVE)
  file(WRITE ${PROJECT_BINARY_DIR}/refuse_package.cmake
       "message(FATAL_ERROR \"this build is for this machine's processor alone (GIB_NATIVE): cmake --workflow --preset package\")\n")
  set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_BINARY_DIR}/refuse_package.cmake)
endif()
include(CPack)
