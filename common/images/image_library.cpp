#include "common/images/image_library.h"

#include "common/core/error.h"
#include "common/core/program_file.h"

#include <dlfcn.h>

namespace gib {

namespace {

const ImageLibrary& load() {
    // The library is never unloaded, because objects that it has made live on.
    const std::string path = program_file(GIB_INSTALLED_IMAGE_LIBRARY, GIB_IMAGE_LIBRARY);
    void* library = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
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
