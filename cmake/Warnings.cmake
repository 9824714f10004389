# Compile options of our own targets; none of them reaches a consumer.
function(spherical_param_compile_options target)
  # Contraction to fused multiply-add would make results differ between compilers, and the exact
  # predicates of the core wrong.
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wconversion -Wshadow
                                           -ffp-contract=off)
  if(SPHERICAL_PARAM_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(SPHERICAL_PARAM_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${SPHERICAL_PARAM_SANITIZE}
                                             -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_link_options(${target} PRIVATE -fsanitize=${SPHERICAL_PARAM_SANITIZE})
  endif()
endfunction()
