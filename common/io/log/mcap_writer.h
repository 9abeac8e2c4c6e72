#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/result.h"
#include "common/io/log/output_file.h"
#include "common/io/log/spool.h"
#include "common/io/state/bytes.h"

struct ZSTD_CCtx_s;

namespace mortise {

struct McapWriterOptions {
  std::string profile, library;
  bool compress = true;               ///< zstd; without it any reader needs no decompressor
  std::size_t chunk_bytes = 1 << 20;  ///< a chunk is closed when it holds this much
};

/// Writes one MCAP file from front to back: after a crash the file ends in the middle of at most
/// one record. After an error of the disk later calls do nothing, see OutputFile; sync() and
/// close() return the error. Not thread safe.
class McapWriter {
 public:
  /// Fails when the file exists: a record of a session is never overwritten.
  static Result<std::unique_ptr<McapWriter>> create(const std::filesystem::path& file,
                                                    McapWriterOptions options = {});
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// Schemas and channels are numbered from 1. Schema 0 is "none".
  std::uint16_t add_schema(std::string_view name, std::string_view encoding, std::string_view data);
  std::uint16_t add_channel(std::string_view topic, std::string_view message_encoding,
                            std::uint16_t schema,
                            const std::map<std::string, std::string>& metadata = {});
  void add_attachment(std::string_view name, std::string_view media_type,
                      std::span<const std::byte> data, std::uint64_t time_ns);
  void add_metadata(std::string_view name, const std::map<std::string, std::string>& values);
  /// The same; there may be many.
  void add_seal(std::string_view name, const std::map<std::string, std::string>& values);
  /// SHA-256 of all bytes of the file since the last one was taken.
  std::string take_digest() { return out_->take_digest(); }
  void add_message(std::uint16_t channel, std::uint64_t time_ns, std::span<const std::byte> data);

  /// Is the open chunk full (McapWriterOptions::chunk_bytes)? The caller closes chunks, so that
  /// records that belong together stay together.
  bool chunk_is_full() const { return chunk_.size() >= options_.chunk_bytes; }
  void end_chunk();
  /// Closes the open chunk and waits until all is on disk.
  Status sync();
  /// Adds index, statistics and footer. Afterwards the writer may only be destroyed.
  Status close();

  /// Chunks that are whole in the file, also when what follows them could not be written.
  std::uint32_t chunks_written() const { return chunks_; }
  std::uint64_t bytes_written() const { return out_->bytes_written(); }
  const std::optional<Error>& error() const { return out_->error(); }

 private:
  struct Counted {
    std::uint64_t start_time = 0, end_time = 0, messages = 0;
    void add(std::uint64_t time_ns);
  };
  McapWriter(std::unique_ptr<OutputFile> out, const std::filesystem::path& folder,
             McapWriterOptions options);
  void write_record(std::uint8_t opcode, const ByteWriter& content,
                    std::span<const std::byte> more = {});
  /// What a chunk is stored as; empty: as it is.
  std::span<const std::byte> compressed(std::span<const std::byte> records);
  ByteWriter write_metadata(std::string_view name,
                            const std::map<std::string, std::string>& values);
  void write_summary();

  std::unique_ptr<OutputFile> out_;
  McapWriterOptions options_;
  bool closed_ = false;

  ByteWriter chunk_;
  Counted chunk_counted_, file_counted_;
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> chunk_index_;
  std::unique_ptr<std::byte[]> compressor_memory_;  ///< all that it ever needs
  ZSTD_CCtx_s* compressor_ = nullptr;               ///< in it; null: chunks stay as they are
  std::unique_ptr<std::byte[]> compressed_;         ///< touched as far as chunks need it
  std::size_t compressed_bytes_ = 0;

  std::uint16_t schemas_ = 0, channels_ = 0;
  std::uint32_t chunks_ = 0, attachments_ = 0, metadata_ = 0;
  std::map<std::uint16_t, std::uint64_t> messages_of_channel_;
  std::map<std::uint8_t, ByteWriter> summary_;  ///< records of the summary section by opcode
  Spool chunk_indexes_;                         ///< those of chunks: some 300 bytes each
  Spool seal_indexes_;                          ///< and of what stands behind them
};

}  // namespace mortise
