# Installs the build into a scratch prefix, then configures, builds and runs a project that only
# knows find_package(locsim). Called with BUILD_DIR, SOURCE_DIR, SCRATCH_DIR.
file(REMOVE_RECURSE "${SCRATCH_DIR}")
function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY OUTPUT_VARIABLE output)
  message("${output}")
endfunction()
run(${CMAKE_COMMAND} --install "${BUILD_DIR}" --prefix "${SCRATCH_DIR}/prefix")
run(${CMAKE_COMMAND} -S "${SOURCE_DIR}" -B "${SCRATCH_DIR}/build" -G Ninja
    "-DCMAKE_PREFIX_PATH=${SCRATCH_DIR}/prefix" -DCMAKE_BUILD_TYPE=Release)
run(${CMAKE_COMMAND} --build "${SCRATCH_DIR}/build")
run("${SCRATCH_DIR}/build/consumer")
run("${SCRATCH_DIR}/prefix/bin/locsim" list localizers)
