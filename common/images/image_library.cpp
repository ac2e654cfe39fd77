#include "common/images/image_library.h"

#include "common/core/error.h"

#include <dlfcn.h>

namespace gib {

namespace {

const ImageLibrary& load() {
    // The library is in the build's folder, whose path was compiled in. It is never unloaded, because objects that it
    // has made live on.
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
