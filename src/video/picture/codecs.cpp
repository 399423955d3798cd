#include "video/picture/codecs.hpp"

#include "base/text/error.hpp"

#include <dlfcn.h>

namespace treacle::video {

namespace {
// The module stands beside the program or in the folder of its build, where the program's own search path leads.
const Codecs& load() {
    constexpr const char* module = "treacle_codecs.so";
    void* library = dlopen(module, RTLD_NOW | RTLD_LOCAL);
    void* entry = library ? dlsym(library, "treacle_codecs") : nullptr;
    if (!entry)
        throw SimulationError({module, "the codecs of pictures and movies cannot be loaded", dlerror(),
            "keep it beside the program, and install OpenCV's libraries for pictures and videos"});
    return *reinterpret_cast<const Codecs* (*)()>(entry)();
}
} // namespace

const Codecs& codecs() {
    static const Codecs& loaded = load();
    return loaded;
}

} // namespace treacle::video
