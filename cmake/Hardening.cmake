# The flags that Debian wants in its packages: those of dpkg-buildflags where it is, the same ones
# by hand elsewhere. Without -g and -O2, which the build type says, and without the folder of the
# build, which no file of a package must tell; and without link-time optimisation, which some
# distributions put among them.
#
# On for whoever builds this project to use it: the tools read files from anywhere. Not for another
# project's build, which has its own flags; nor without optimisation, on which the checked calls of
# the C library depend; nor with sanitizers, which do the same and more.
set(hardening_default OFF)
if(PROJECT_IS_TOP_LEVEL AND NOT SPHERICAL_PARAM_SANITIZE
   AND CMAKE_BUILD_TYPE MATCHES "^(Release|RelWithDebInfo|MinSizeRel)$")
  set(hardening_default ON)
endif()
option(SPHERICAL_PARAM_HARDENING "Compile and link as Debian's packages are" ${hardening_default})
if(SPHERICAL_PARAM_HARDENING)
  set(hardening_compile "-fstack-protector-strong -Wformat -Werror=format-security")
  set(hardening_preprocess "-Wdate-time -D_FORTIFY_SOURCE=2")
  set(hardening_link "-Wl,-z,relro -Wl,-z,now")
  find_program(DPKG_BUILDFLAGS dpkg-buildflags)
  if(DPKG_BUILDFLAGS)
    foreach(kind compile=CXXFLAGS preprocess=CPPFLAGS link=LDFLAGS)
      string(REGEX MATCH "^(.*)=(.*)$" kind "${kind}")
      # The user's own variables would be counted in a second time.
      execute_process(
        COMMAND ${CMAKE_COMMAND} -E env --unset=CXXFLAGS --unset=CPPFLAGS --unset=LDFLAGS
                "DEB_BUILD_MAINT_OPTIONS=hardening=+all reproducible=-fixfilepath"
                ${DPKG_BUILDFLAGS} --get ${CMAKE_MATCH_2}
        OUTPUT_VARIABLE flags OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE code ERROR_QUIET)
      if(code EQUAL 0)
        set(hardening_${CMAKE_MATCH_1} "${flags}")
      endif()
    endforeach()
  endif()
  separate_arguments(hardening_flags UNIX_COMMAND "${hardening_compile} ${hardening_preprocess}")
  list(FILTER hardening_flags EXCLUDE REGEX
    "^(-g|-O[0-9]|-f[a-z]+-prefix-map=.*|-f(fat-)?lto(-objects|=.*)?)$")
  separate_arguments(hardening_link UNIX_COMMAND "${hardening_link}")
  list(FILTER hardening_link EXCLUDE REGEX "^-f(fat-)?lto(-objects|=.*)?$")
  # The compiler's default may be programs that are not position-independent.
  include(CheckPIESupported)
  check_pie_supported(LANGUAGES CXX)
  add_compile_options(${hardening_flags})
  add_link_options(${hardening_link})
endif()
