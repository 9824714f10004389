# The flags that harden Debian's packages. On in optimised builds of this project on Linux: the tools
# read files from anywhere. Not in another project's build, which has its own flags, and not with
# sanitizers, which check more.
set(hardening_default OFF)
if(CMAKE_SYSTEM_NAME STREQUAL "Linux" AND PROJECT_IS_TOP_LEVEL AND NOT SPHERICAL_PARAM_SANITIZE
   AND CMAKE_BUILD_TYPE MATCHES "^(Release|RelWithDebInfo|MinSizeRel)$")
  set(hardening_default ON)
endif()
option(SPHERICAL_PARAM_HARDENING "Compile and link as Debian's packages are" ${hardening_default})
if(SPHERICAL_PARAM_HARDENING)
  # The compiler's default may be programs that are not position-independent.
  include(CheckPIESupported)
  check_pie_supported(LANGUAGES CXX)
  add_compile_options(-fstack-protector-strong -Wformat -Werror=format-security
                      -Wdate-time -D_FORTIFY_SOURCE=2)
  add_link_options(-Wl,-z,relro -Wl,-z,now)
endif()
