#include "methods/parts/stored_light/stored_light.h"

#include "methods/method.h"

namespace gib {

StoredLight Run::stored_light() const { return {}; }

}  // namespace gib
