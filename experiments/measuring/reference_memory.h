#pragma once

namespace gib {

/// Throws InputError unless memory can hold what is alive while the file of a reference of this size [pixels] is written.
void require_memory_for_reference(int width, int height);

}  // namespace gib
