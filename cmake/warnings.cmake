option(WELLMESH_STRICT "Treat warnings as errors" OFF)
function(wellmesh_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wno-missing-field-initializers
                                           $<$<BOOL:${WELLMESH_STRICT}>:-Werror>)
endfunction()
