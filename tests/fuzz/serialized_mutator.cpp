// Mutates the uncompressed content of a serialized mesh and compresses it again. If the compressed bytes were
// mutated, nearly every input would end at zlib's checksum.

#include <zlib.h>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr std::size_t header_size = 4, largest_content = 1 << 14;

struct Unpacked {
    Bytes content;
    std::size_t consumed = 0;  ///< bytes of the stream; the dictionary follows
};

/// Decompresses the stream as far as it can be read.
Unpacked unpack(const std::uint8_t* data, std::size_t size) {
    Unpacked result;
    result.content.resize(largest_content);
    z_stream stream{};
    inflateInit(&stream);
    stream.next_in = const_cast<Bytef*>(data);
    stream.avail_in = static_cast<uInt>(size);
    stream.next_out = result.content.data();
    stream.avail_out = static_cast<uInt>(largest_content);
    inflate(&stream, Z_FINISH);
    result.content.resize(stream.total_out);
    result.consumed = stream.total_in;
    inflateEnd(&stream);
    return result;
}

Bytes packed(const Bytes& content) {
    Bytes result(compressBound(content.size()));
    uLongf size = result.size();
    compress2(result.data(), &size, content.data(), content.size(), 1);
    result.resize(size);
    return result;
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
    // One in eight mutations changes the file itself: its header, a damaged stream, the dictionary.
    if (size <= header_size || seed % 8 == 0) return LLVMFuzzerMutate(data, size, max_size);
    Unpacked unpacked = unpack(data + header_size, size - header_size);
    if (unpacked.content.empty()) return LLVMFuzzerMutate(data, size, max_size);
    Bytes& content = unpacked.content;
    const std::size_t content_size = content.size();
    content.resize(largest_content);
    content.resize(LLVMFuzzerMutate(content.data(), content_size, largest_content));
    Bytes file(data, data + header_size);
    const Bytes stream = packed(content);
    file.insert(file.end(), stream.begin(), stream.end());
    file.insert(file.end(), data + header_size + unpacked.consumed, data + size);
    file.resize(std::min(file.size(), max_size));
    std::memcpy(data, file.data(), file.size());
    return file.size();
}
