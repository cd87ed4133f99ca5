# Every library from outside, as an imported target. All are packages of Debian 12
# (scripts/setup.sh lists them). Included by the build and by the installed package config.

find_package(Eigen3 3.4 REQUIRED)
find_package(Threads REQUIRED)
find_package(TBB REQUIRED)
find_package(embree 3 REQUIRED)
find_package(assimp REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(PNG REQUIRED)
find_package(Freetype REQUIRED)
find_package(Boost REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(GEOGRAPHICLIB REQUIRED IMPORTED_TARGET geographiclib)
pkg_check_modules(OSMESA REQUIRED IMPORTED_TARGET osmesa)
# The double-precision build: worlds are kilometres wide.
pkg_check_modules(BULLET REQUIRED IMPORTED_TARGET bullet-float64)
pkg_check_modules(FLANN REQUIRED IMPORTED_TARGET flann)

# PCL's own package config asks for VTK and Qt, which nothing here uses.
if(NOT TARGET locsim_pcl)
  find_path(LOCSIM_PCL_INCLUDE_DIR pcl/point_types.h PATH_SUFFIXES pcl-1.13 pcl-1.14 pcl-1.12
            REQUIRED)
  add_library(locsim_pcl INTERFACE IMPORTED)
  target_include_directories(locsim_pcl SYSTEM INTERFACE "${LOCSIM_PCL_INCLUDE_DIR}")
  target_link_libraries(locsim_pcl INTERFACE Eigen3::Eigen Boost::headers PkgConfig::FLANN)
  foreach(component common io octree kdtree search sample_consensus filters features registration)
    find_library(LOCSIM_PCL_${component} pcl_${component} REQUIRED)
    target_link_libraries(locsim_pcl INTERFACE "${LOCSIM_PCL_${component}}")
  endforeach()
endif()
