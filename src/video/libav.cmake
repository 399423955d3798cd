# FFmpeg's libraries, which OpenCV's videoio rests on already: exact time stamps, display matrices and colour
# transfer need them directly.
find_package(PkgConfig REQUIRED)
pkg_check_modules(libav REQUIRED IMPORTED_TARGET libavformat libavcodec libavutil libswscale)
