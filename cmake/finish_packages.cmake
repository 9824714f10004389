# Run by cpack after it made the packages: gives libraries what CPack does not know of. ldconfig is
# called by dpkg's trigger instead of scripts of ours, and the libraries of several architectures
# may be installed at a time.
foreach(package IN LISTS CPACK_PACKAGE_FILES)
  get_filename_component(name ${package} NAME)
  string(REGEX REPLACE "_.*" "" name ${name})
  if(NOT name MATCHES "^lib")
    continue()
  endif()
  set(tree ${CPACK_TOPLEVEL_DIRECTORY}/finish/${name})
  file(REMOVE_RECURSE ${tree})
  file(MAKE_DIRECTORY ${CPACK_TOPLEVEL_DIRECTORY}/finish)
  execute_process(COMMAND dpkg-deb --raw-extract ${package} ${tree} COMMAND_ERROR_IS_FATAL ANY)
  file(READ ${tree}/DEBIAN/control control)
  string(REGEX REPLACE "\nArchitecture: ([^\n]*)\n" "\nArchitecture: \\1\nMulti-Arch: same\n"
    control "\n${control}")
  string(REGEX REPLACE "^\n+" "" control "${control}")
  file(WRITE ${tree}/DEBIAN/control "${control}")
  if(EXISTS ${tree}/DEBIAN/shlibs)
    file(REMOVE ${tree}/DEBIAN/postinst ${tree}/DEBIAN/postrm)
    file(WRITE ${tree}/DEBIAN/triggers "activate-noawait ldconfig\n")
  endif()
  file(CHMOD ${tree}/DEBIAN
    PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
  file(GLOB control_files ${tree}/DEBIAN/*)
  file(CHMOD ${control_files} PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
  execute_process(COMMAND dpkg-deb --root-owner-group -Zxz --build ${tree} ${package}
    OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  file(REMOVE_RECURSE ${tree})
endforeach()
