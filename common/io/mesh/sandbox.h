#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// What a program that reads a stranger's file may still do. Linked by the importers and by the
/// program that starts them.
namespace mortise {

/// How much it may use; its parent tells it in the last word of the command line.
struct Allowance {
  std::uint64_t memory_bytes = 0;       ///< address space for the file
  std::uint64_t most_memory_bytes = 0;  ///< with the files that it names (grant_memory_for())
  std::uint64_t cpu_s = 0;
  int parent = 0;  ///< process that it may not outlive
};

/// Bytes of memory for reading so many bytes of file, at most `most`.
std::uint64_t memory_for(std::uint64_t file_bytes, std::uint64_t most);

std::string word_of(const Allowance& allowance);
std::optional<Allowance> allowance_of(const std::string& word);

/// Of the calling process, for good: opens regular files and folders for reading only, none outside
/// the folder of `file`, links followed; no network, no program, no signal to others, no new code,
/// no more memory and processor time than allowed; ends when its parent does. `helpers`: may fork
/// processes that are held to the same. Landlock holds the folder where the kernel has it, seccomp
/// the rest. False: `file` is not there. With a sanitizer only time and size of output are limited.
bool enter_sandbox(const Allowance& allowance, const std::filesystem::path& file,
                   bool helpers = false);

/// Raises the limit of memory of the calling process for another file of so many bytes, within what
/// it was allowed at most.
void grant_memory_for(std::uint64_t file_bytes);
/// The limit now; 0: none.
std::uint64_t granted_memory_bytes();

/// Writes all to an open file: what the process answers. False when it is not taken.
bool write_all(int file, const std::vector<std::byte>& bytes);

}  // namespace mortise
