# Installs wellmesh to a fresh place, moves it, and builds and runs tests/package/consumer against it.
# cmake -D BUILD=<build tree of wellmesh> -D SOURCE=<this folder> -D WORK=<scratch folder> -D GENERATOR=... -D CXX=... -D VERSION=x.y.z -P this
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "failed (${status}): ${ARGV}\n${output}")
  endif()
  message(STATUS "${output}")
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/first)
file(RENAME ${WORK}/first ${WORK}/installed)  # the package must not know where it was put

# Nothing of the build or source tree may be named by what was installed.
file(GLOB_RECURSE package_files ${WORK}/installed/*.cmake)
foreach(package_file ${package_files})
  file(STRINGS ${package_file} leaks REGEX "${BUILD}|${WORK}/first")
  if(leaks)
    message(FATAL_ERROR "${package_file} names the build tree: ${leaks}")
  endif()
endforeach()

run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE}/consumer -B ${WORK}/consumer -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_BUILD_TYPE=Release
    -DCMAKE_PREFIX_PATH=${WORK}/installed)
run(${CMAKE_COMMAND} --build ${WORK}/consumer)
run(${WORK}/consumer/consumer)

# Another minor version is refused.
file(WRITE ${WORK}/wrong/CMakeLists.txt "cmake_minimum_required(VERSION 3.25)\nproject(wrong LANGUAGES NONE)\nfind_package(wellmesh 99.0 REQUIRED)\n")
execute_process(COMMAND ${CMAKE_COMMAND} -G ${GENERATOR} -S ${WORK}/wrong -B ${WORK}/wrong/build -DCMAKE_PREFIX_PATH=${WORK}/installed
                RESULT_VARIABLE status OUTPUT_QUIET ERROR_QUIET)
if(status EQUAL 0)
  message(FATAL_ERROR "find_package(wellmesh 99.0) accepted ${VERSION}")
endif()
file(REMOVE_RECURSE ${WORK})
