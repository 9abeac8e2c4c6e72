#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "common/base/result.h"

namespace mortise {

struct McapSchema {
  std::uint16_t id = 0;
  std::string name, encoding;
  std::span<const std::byte> data;
};
struct McapChannel {
  std::uint16_t id = 0, schema = 0;
  std::string topic, message_encoding;
  std::map<std::string, std::string> metadata;
};
struct McapMessage {
  std::uint64_t log_time_ns = 0, publish_time_ns = 0;
  std::uint32_t sequence = 0;
  std::span<const std::byte> data;
};
struct McapAttachment {
  std::string name, media_type;
  std::uint64_t log_time_ns = 0;
  std::span<const std::byte> data;
};

/// Called in the order of the file; an empty function skips its kind. Spans are valid during the
/// call.
struct McapHandler {
  std::function<void(const McapSchema&)> on_schema = {};
  std::function<void(const McapChannel&)> on_channel = {};  ///< first sight of each channel
  std::function<void(const McapChannel&, const McapMessage&)> on_message = {};
  std::function<void(const McapAttachment&)> on_attachment = {};
  std::function<void(const std::string& name, const std::map<std::string, std::string>&)>
      on_metadata = {};
  std::function<void(const std::string& what)> on_loss = {};  ///< bytes were lost here
  /// A message of a channel that nothing announced was left out.
  std::function<void(const std::string& what)> on_stray = {};
  /// After each record: the share of the file that is read, 0 to 1.
  std::function<void(double share)> on_progress = {};
  std::function<bool()> is_enough = {};  ///< after each record; true: the rest is not read
};

/// Limits for a hostile file.
struct McapLimits {
  std::uint64_t chunk_bytes = 256ULL << 20;  ///< of one decompressed chunk
  /// All chunks together, as a multiple of the file's size: our records contain hashes and an
  /// index, which keeps genuine logs below ten.
  std::uint64_t expansion = 64;
  std::uint64_t expansion_floor_bytes = 64ULL << 20;  ///< allowed to the smallest file
};

struct McapScan {
  std::string profile, library;
  bool complete = false;  ///< footer and closing magic were found
  std::uint64_t file_bytes = 0, records = 0, chunks = 0, messages = 0, attachments = 0;
  std::uint64_t bytes_read = 0;  ///< with those that were read again
  std::uint64_t lost_chunks = 0, lost_attachments = 0;
  /// How many messages the index states, by topic; empty: there is none that is whole.
  std::map<std::string, std::uint64_t> stated;
  std::vector<std::string> notes;  ///< what was lost or unexpected, with its place in the file
};

/// Reads an MCAP file from front to back: a file without its tail, or with damage in the middle,
/// gives all chunks that are whole. Of the index it takes schemas and channels alone, where it is
/// whole. Fails only when the file cannot be opened, or neither begins nor ends as MCAP. Never
/// throws on any content; memory is bounded by the limits and the size of the file, and what is
/// read, by a small multiple of that size, whatever its lengths say.
Result<McapScan> scan_mcap(const std::filesystem::path& file, const McapHandler& handler,
                           const McapLimits& limits = {});

}  // namespace mortise
