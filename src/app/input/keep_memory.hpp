#pragma once
#include <malloc.h>

namespace treacle::app {

// Frames of a video take arrays of 10 to 100 MB: those that are free stay with the program, which would otherwise spend a
// third of its time on getting them from the system anew.
inline void keep_memory() {
    mallopt(M_MMAP_THRESHOLD, 1 << 30);
    mallopt(M_TRIM_THRESHOLD, 1 << 30);
}

} // namespace treacle::app
