#pragma once
// Memory on huge pages for large arrays that are read at random: the processor's cache of page addresses (TLB) then
// covers far more of an array.

#include <sys/mman.h>
#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <new>
#include <vector>

namespace gib {

/// An allocator for std::vector. It asks the system for huge pages if an array fills at least four of them; the
/// system may refuse, which costs only time.
template <typename T>
class HugePageAllocator {
public:
    using value_type = T;

    HugePageAllocator() = default;
    template <typename U>
    explicit HugePageAllocator(const HugePageAllocator<U>&) {}

    T* allocate(std::size_t n) {
        if (n > static_cast<std::size_t>(-1) / 2 / sizeof(T)) throw std::bad_alloc();
        const bool huge = n * sizeof(T) >= 4 * page;
        const std::size_t alignment = huge ? page : std::max(alignof(T), alignof(std::max_align_t));
        const std::size_t bytes = (n * sizeof(T) + alignment - 1) / alignment * alignment;
        void* memory = std::aligned_alloc(alignment, bytes);
        if (!memory) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
        if (huge) ::madvise(memory, bytes, MADV_HUGEPAGE);
#endif
        return static_cast<T*>(memory);
    }
    void deallocate(T* memory, std::size_t) { std::free(memory); }

    bool operator==(const HugePageAllocator&) const { return true; }

private:
    static constexpr std::size_t page = std::size_t{2} << 20;
};

template <typename T>
using HugePageVector = std::vector<T, HugePageAllocator<T>>;

}  // namespace gib
