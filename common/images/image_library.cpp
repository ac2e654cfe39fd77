#include "common/images/image_library.h"

#include "common/core/error.h"

#include <dlfcn.h>

namespace gib {

namespace {

const ImageLibrary& load() {
    // Found in the build's folder, which the program knows; never unloaded, as what it has made lives on.
    void* library = ::dlopen(GIB_IMAGE_LIBRARY, RTLD_NOW | RTLD_LOCAL);
    void* entry = library ? ::dlsym(library, image_library_entry) : nullptr;
    if (!entry) throw RunError(std::string("cannot load the library that reads images: ") + ::dlerror());
    return *reinterpret_cast<ImageLibraryEntry*>(entry)();
}

}  // namespace

const ImageLibrary& image_library() {
    static const ImageLibrary& library = load();
    return library;
}

}  // namespace gib
