#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

/// What an importer does to itself before it reads a file that nobody vouches for.
namespace mortise {

/// From here on this process has so many bytes of memory and of any file that it writes, and so
/// many seconds of processor; it leaves no core. Memory is not limited under a sanitizer, which
/// reserves terabytes of addresses.
void confine_this_process(std::uint64_t bytes, std::uint64_t seconds);

/// Writes all to an open file; false when it does not take it.
bool write_all(int file, const std::vector<std::byte>& bytes);

}  // namespace mortise
