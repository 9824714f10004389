# Compile options of our own targets; none of them reaches a consumer.
function(spherical_param_compile_options target)
  # Contraction to fused multiply-add would make results differ between compilers, and the exact
  # predicates of the core wrong.
  if(MSVC)
    # 4996: functions of the standard that Microsoft has others for.
    target_compile_options(${target} PRIVATE /W4 /wd4996 /permissive- /utf-8 /bigobj /fp:precise
                                             $<$<BOOL:${SPHERICAL_PARAM_WERROR}>:/WX>)
  else()
    target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wconversion -Wshadow
                                             -ffp-contract=off
                                             $<$<CXX_COMPILER_ID:Clang>:-Wreserved-identifier>
                                             $<$<BOOL:${SPHERICAL_PARAM_WERROR}>:-Werror>)
  endif()
  if(SPHERICAL_PARAM_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${SPHERICAL_PARAM_SANITIZE}
                                             -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_link_options(${target} PRIVATE -fsanitize=${SPHERICAL_PARAM_SANITIZE})
  endif()
  if(SPHERICAL_PARAM_FUZZERS)
    # What libFuzzer is guided by. Comparisons are not traced: arithmetic would become twice as slow.
    target_compile_options(${target} PRIVATE -fsanitize-coverage=inline-8bit-counters,pc-table)
  endif()
endfunction()

# A program of libFuzzer, if SPHERICAL_PARAM_FUZZERS.
function(spherical_param_add_fuzzer target)
  add_executable(${target} ${ARGN})
  spherical_param_compile_options(${target})
  target_link_options(${target} PRIVATE -fsanitize=fuzzer)
endfunction()
