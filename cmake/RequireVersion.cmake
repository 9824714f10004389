# spherical_param_require_version(<what> <version found> <least> <package of Debian> [<too new>])
#
# Stops with a message that says what to do where a dependency is too old, or of a version that is
# known not to work. An unknown version passes: the compiler will judge.
function(spherical_param_require_version what found least package)
  if(found STREQUAL "")
    return()
  endif()
  if(found VERSION_LESS least)
    message(FATAL_ERROR "${what} ${found} was found, but ${least} or newer is needed: "
                        "install a newer ${package}, or tell CMake where it is (CMAKE_PREFIX_PATH)")
  endif()
  if(ARGC GREATER 4 AND NOT found VERSION_LESS ARGV4)
    message(FATAL_ERROR "${what} ${found} was found, but it must be older than ${ARGV4}, whose "
                        "interface differs: install an older ${package}, or tell CMake where it is "
                        "(CMAKE_PREFIX_PATH)")
  endif()
endfunction()

# The value of a number that a header defines: spherical_param_version_of_header(<result> <file>
# <macro>...), where several macros are parts of a version.
function(spherical_param_version_of_header result file)
  set(parts "")
  foreach(macro IN LISTS ARGN)
    set(line "")
    if(EXISTS "${file}")
      file(STRINGS "${file}" line LIMIT_COUNT 1
        REGEX "^#[ \t]*define[ \t]+${macro}[ \t]+\"?[0-9.]+\"?")
    endif()
    if(line MATCHES "${macro}[ \t]+\"?([0-9.]+)")
      list(APPEND parts ${CMAKE_MATCH_1})
    endif()
  endforeach()
  list(JOIN parts "." version)
  set(${result} "${version}" PARENT_SCOPE)
endfunction()
