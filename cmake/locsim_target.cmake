# The one way a target of this project is made: standard, warnings, sanitizers, ccache.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

find_program(LOCSIM_CCACHE ccache)
if(LOCSIM_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${LOCSIM_CCACHE}")
endif()

function(locsim_compile_options target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                         -Woverloaded-virtual -Werror)
  # Designated initialisers leave the rest to the defaults; the other two are wrong on std::string
  # and std::optional in GCC 12 (bugs 105329 and 80635).
  target_compile_options(${target} PRIVATE -Wno-missing-field-initializers)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -Wno-restrict -Wno-maybe-uninitialized)
  endif()
  # Same source, same numbers: no contraction to FMA where a flag would allow it.
  target_compile_options(${target} PRIVATE -ffp-contract=off)
  if(LOCSIM_NATIVE)
    target_compile_options(${target} PRIVATE -march=native)
  endif()
  if(LOCSIM_SANITIZE)
    target_compile_options(${target} PUBLIC -fsanitize=${LOCSIM_SANITIZE} -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${LOCSIM_SANITIZE})
  endif()
endfunction()

# locsim_library(NAME FOLDER PUBLIC libs… PRIVATE libs… [EXCLUDE folders…])
#
# The library of one folder: all its sources, `locsim::NAME`, headers included from the top of
# the tree ("core/pose.h").
function(locsim_library name)
  cmake_parse_arguments(ARG "" "" "PUBLIC;PRIVATE;EXCLUDE" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/*.cpp")
  foreach(excluded IN LISTS ARG_EXCLUDE)
    list(FILTER sources EXCLUDE REGEX "^${CMAKE_CURRENT_SOURCE_DIR}/${excluded}/")
  endforeach()
  add_library(locsim_${name} STATIC ${sources})
  add_library(locsim::${name} ALIAS locsim_${name})
  set_target_properties(locsim_${name} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(locsim_${name} PUBLIC "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>"
                             "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/locsim>")
  target_link_libraries(locsim_${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  locsim_compile_options(locsim_${name})
  set_property(GLOBAL APPEND PROPERTY LOCSIM_LIBRARIES locsim_${name})
endfunction()
