# Debian's component packages bring no OpenCVConfig.cmake (it needs libopencv-dev, and with it VTK and more).
set(components core imgproc imgcodecs videoio video features2d calib3d)
find_package(OpenCV QUIET COMPONENTS ${components})
if(NOT OpenCV_FOUND)
  find_path(OpenCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
  foreach(component IN LISTS components)
    find_library(OpenCV_${component}_LIBRARY opencv_${component} REQUIRED)
    add_library(opencv_${component} UNKNOWN IMPORTED GLOBAL)
    set_target_properties(opencv_${component} PROPERTIES
      IMPORTED_LOCATION "${OpenCV_${component}_LIBRARY}"
      INTERFACE_INCLUDE_DIRECTORIES "${OpenCV_INCLUDE_DIR}")
  endforeach()
  set(OpenCV_INCLUDE_DIRS "${OpenCV_INCLUDE_DIR}")
endif()
# Those of pictures and videos load some 200 libraries more: treacle_opencv is without them.
set(codecs imgcodecs videoio)
list(REMOVE_ITEM components ${codecs})
list(TRANSFORM components PREPEND opencv_)
list(TRANSFORM codecs PREPEND opencv_)
add_library(treacle_opencv INTERFACE)
target_link_libraries(treacle_opencv INTERFACE ${components})
target_include_directories(treacle_opencv SYSTEM INTERFACE ${OpenCV_INCLUDE_DIRS})
add_library(treacle_opencv_codecs INTERFACE)
target_link_libraries(treacle_opencv_codecs INTERFACE treacle_opencv ${codecs})
