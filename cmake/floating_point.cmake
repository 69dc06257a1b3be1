# Exact predicates need IEEE doubles evaluated as written: no fused multiply-add, no extended precision, no reassociation.
# The flags belong to the target, so no user's flags can undo them; src/predicates/fp_environment.hpp checks what it can.
function(wellmesh_exact_floating_point target)
  target_compile_options(${target} PRIVATE -ffp-contract=off -fno-fast-math)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(i.86|x86)$")
    target_compile_options(${target} PRIVATE -msse2 -mfpmath=sse)
  endif()
endfunction()
