#pragma once
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/io/log/input_file.h"
#include "common/io/log/mcap_reader.h"
#include "common/io/state/bytes.h"

/// Private to the reader of MCAP files.
namespace mortise::mcap {

std::map<std::string, std::string> read_map(ByteReader& in);
/// Nothing: the record is damaged.
std::optional<McapSchema> schema_of(std::span<const std::byte> content);
std::optional<McapChannel> channel_of(std::span<const std::byte> content);

/// What the index at the end of a file repeats of its front.
struct Index {
  std::map<std::uint16_t, McapSchema> schemas;  ///< their data are in `bytes`
  std::map<std::uint16_t, McapChannel> channels;
  std::map<std::uint16_t, std::uint64_t> messages;  ///< how many were written, by channel
  std::vector<std::byte> bytes;
  std::uint64_t start = UINT64_MAX;  ///< the records before end below it
};
/// Nothing where the file has no index, or its checksum does not fit. `at`: where it begins, if not
/// where the footer says; 0: there.
std::optional<Index> read_index(const InputFile& file, std::uint64_t at = 0);

}  // namespace mortise::mcap
