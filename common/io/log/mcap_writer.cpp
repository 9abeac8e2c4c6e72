#include "common/io/log/mcap_writer.h"

#define ZSTD_STATIC_LINKING_ONLY  // for a compressor in memory of ours
#include <zstd.h>

#include <algorithm>

#include "common/io/log/crc32.h"
#include "common/io/log/mcap_format.h"

namespace mortise {
namespace {

// Fast and small enough: a log is written beside a running session.
constexpr int kCompressionLevel = 3;

void put_map(ByteWriter& out, const std::map<std::string, std::string>& values) {
  ByteWriter entries;
  for (const auto& [key, value] : values) {
    entries.string(key);
    entries.string(value);
  }
  out.u32(static_cast<std::uint32_t>(entries.size()));
  out.raw(entries.bytes());
}

template <class Key>
void put_map(ByteWriter& out, const std::map<Key, std::uint64_t>& values) {
  out.u32(static_cast<std::uint32_t>(values.size() * (sizeof(Key) + 8)));
  for (const auto& [key, value] : values) {
    out.u16(key);
    out.u64(value);
  }
}

void put_record(ByteWriter& out, std::uint8_t opcode, const ByteWriter& content) {
  out.u8(opcode);
  out.u64(content.size());
  out.raw(content.bytes());
}

}  // namespace

void McapWriter::Counted::add(std::uint64_t time_ns) {
  start_time = messages == 0 ? time_ns : std::min(start_time, time_ns);
  end_time = std::max(end_time, time_ns);
  ++messages;
}

namespace {

ByteWriter attachment_of(std::string_view name, std::string_view media_type,
                         std::span<const std::byte> data, std::uint64_t time_ns) {
  ByteWriter content;
  content.u64(time_ns);
  content.u64(0);  // time of creation: not known
  content.string(name);
  content.string(media_type);
  content.u64(data.size());
  content.raw(data);
  content.u32(crc32(content.bytes()));
  return content;
}

// Times and offsets of the messages of one channel in a chunk.
ByteWriter message_index_of(std::uint16_t channel,
                            std::span<const std::pair<std::uint64_t, std::uint64_t>> entries) {
  ByteWriter index;
  index.u16(channel);
  index.u32(static_cast<std::uint32_t>(entries.size() * 16));
  for (const auto& [time_ns, offset] : entries) {
    index.u64(time_ns);
    index.u64(offset);
  }
  return index;
}

ByteWriter footer_of(std::uint64_t summary_start, std::uint64_t offsets_start, std::uint32_t crc) {
  ByteWriter footer;
  footer.u8(mcap::kFooter);
  footer.u64(mcap::kFooterBytes);
  footer.u64(summary_start);
  footer.u64(offsets_start);
  footer.u32(crc32(footer.bytes(), crc));
  footer.raw(std::as_bytes(std::span(mcap::kMagic)));
  return footer;
}

}  // namespace

Result<std::unique_ptr<McapWriter>> McapWriter::create(const std::filesystem::path& file,
                                                       McapWriterOptions options) {
  auto out = OutputFile::create(file);
  if (!out) return out.error();
  std::unique_ptr<McapWriter> writer(
      new McapWriter(std::move(out).value(), file.parent_path(), std::move(options)));
  writer->out_->write(std::as_bytes(std::span(mcap::kMagic)));
  ByteWriter header;
  header.string(writer->options_.profile);
  header.string(writer->options_.library);
  writer->write_record(mcap::kHeader, header);
  if (writer->error()) return *writer->error();
  return writer;
}

McapWriter::McapWriter(std::unique_ptr<OutputFile> out, const std::filesystem::path& folder,
                       McapWriterOptions options)
    : out_(std::move(out)),
      options_(std::move(options)),
      chunk_indexes_(folder),
      seal_indexes_(folder) {
  // So that it does not grow when a busy hour brings the first full chunk, nor shrink in a quiet
  // one.
  if (options_.compress) {
    const std::size_t size = ZSTD_estimateCCtxSize(kCompressionLevel);
    compressor_memory_ = std::make_unique<std::byte[]>(size);
    compressor_ = ZSTD_initStaticCCtx(compressor_memory_.get(), size);
  }
  // Room that is not touched costs nothing: a chunk is full once a tick has gone beyond it.
  chunk_.reserve(2 * options_.chunk_bytes);
}

McapWriter::~McapWriter() { static_cast<void>(close()); }

void McapWriter::write_record(std::uint8_t opcode, const ByteWriter& content,
                              std::span<const std::byte> more) {
  ByteWriter record;
  record.u8(opcode);
  record.u64(content.size() + more.size());
  record.raw(content.bytes());
  out_->write(record.bytes(), more);
}

std::uint16_t McapWriter::add_schema(std::string_view name, std::string_view encoding,
                                     std::string_view data) {
  ByteWriter content;
  content.u16(++schemas_);
  content.string(name);
  content.string(encoding);
  content.string(data);
  write_record(mcap::kSchema, content);
  put_record(summary_[mcap::kSchema], mcap::kSchema, content);
  return schemas_;
}

std::uint16_t McapWriter::add_channel(std::string_view topic, std::string_view message_encoding,
                                      std::uint16_t schema,
                                      const std::map<std::string, std::string>& metadata) {
  ByteWriter content;
  content.u16(++channels_);
  content.u16(schema);
  content.string(topic);
  content.string(message_encoding);
  put_map(content, metadata);
  write_record(mcap::kChannel, content);
  put_record(summary_[mcap::kChannel], mcap::kChannel, content);
  messages_of_channel_[channels_] = 0;
  return channels_;
}

void McapWriter::add_attachment(std::string_view name, std::string_view media_type,
                                std::span<const std::byte> data, std::uint64_t time_ns) {
  end_chunk();
  const ByteWriter content = attachment_of(name, media_type, data, time_ns);
  ByteWriter index;
  index.u64(bytes_written());
  index.u64(mcap::kRecordHeaderBytes + content.size());
  index.u64(time_ns);
  index.u64(0);
  index.u64(data.size());
  index.string(name);
  index.string(media_type);
  write_record(mcap::kAttachment, content);
  put_record(summary_[mcap::kAttachmentIndex], mcap::kAttachmentIndex, index);
  ++attachments_;
}

// Returns its record of the index.
ByteWriter McapWriter::write_metadata(std::string_view name,
                                      const std::map<std::string, std::string>& values) {
  ByteWriter content;
  content.string(name);
  put_map(content, values);
  ByteWriter index;
  index.u64(bytes_written());
  index.u64(mcap::kRecordHeaderBytes + content.size());
  index.string(name);
  write_record(mcap::kMetadata, content);
  ++metadata_;
  return index;
}

void McapWriter::add_metadata(std::string_view name,
                              const std::map<std::string, std::string>& values) {
  end_chunk();
  const ByteWriter index = write_metadata(name, values);
  put_record(summary_[mcap::kMetadataIndex], mcap::kMetadataIndex, index);
}

void McapWriter::add_seal(std::string_view name, const std::map<std::string, std::string>& values) {
  ByteWriter record;
  put_record(record, mcap::kMetadataIndex, write_metadata(name, values));
  seal_indexes_.append(record.bytes());
}

void McapWriter::add_message(std::uint16_t channel, std::uint64_t time_ns,
                             std::span<const std::byte> data) {
  chunk_index_[channel].emplace_back(time_ns, chunk_.size());
  chunk_.u8(mcap::kMessage);
  chunk_.u64(2 + 4 + 8 + 8 + data.size());
  chunk_.u16(channel);
  chunk_.u32(static_cast<std::uint32_t>(++messages_of_channel_[channel]));
  chunk_.u64(time_ns);
  chunk_.u64(time_ns);
  chunk_.raw(data);
  chunk_counted_.add(time_ns);
  file_counted_.add(time_ns);
}

std::span<const std::byte> McapWriter::compressed(std::span<const std::byte> records) {
  if (!compressor_) return {};
  const std::size_t most = ZSTD_compressBound(records.size());
  if (compressed_bytes_ < most) {
    compressed_bytes_ = std::max(most, ZSTD_compressBound(2 * options_.chunk_bytes));
    compressed_ = std::make_unique_for_overwrite<std::byte[]>(compressed_bytes_);
  }
  const std::size_t size = ZSTD_compressCCtx(compressor_, compressed_.get(), most, records.data(),
                                             records.size(), kCompressionLevel);
  if (ZSTD_isError(size) != 0) return {};
  return {compressed_.get(), size};
}

void McapWriter::end_chunk() {
  if (chunk_.empty()) return;
  std::span<const std::byte> records = compressed(chunk_.bytes());
  const std::string_view compression = records.empty() ? "" : "zstd";
  if (records.empty()) records = chunk_.bytes();
  ByteWriter content;
  content.u64(chunk_counted_.start_time);
  content.u64(chunk_counted_.end_time);
  content.u64(chunk_.size());
  content.u32(crc32(chunk_.bytes()));
  content.string(compression);
  content.u64(records.size());

  ByteWriter index;
  index.u64(chunk_counted_.start_time);
  index.u64(chunk_counted_.end_time);
  index.u64(bytes_written());
  index.u64(mcap::kRecordHeaderBytes + content.size() + records.size());
  write_record(mcap::kChunk, content, records);
  if (!error()) ++chunks_;

  const std::uint64_t index_start = bytes_written();
  std::map<std::uint16_t, std::uint64_t> index_offsets;
  for (const auto& [channel, entries] : chunk_index_) {
    index_offsets[channel] = bytes_written();
    write_record(mcap::kMessageIndex, message_index_of(channel, entries));
  }
  put_map(index, index_offsets);
  index.u64(bytes_written() - index_start);
  index.string(compression);
  index.u64(records.size());
  index.u64(chunk_.size());
  ByteWriter record;
  put_record(record, mcap::kChunkIndex, index);
  chunk_indexes_.append(record.bytes());
  chunk_.clear();
  chunk_index_.clear();
  chunk_counted_ = {};
}

Status McapWriter::sync() {
  end_chunk();
  return out_->sync();
}

void McapWriter::write_summary() {
  ByteWriter data_end;
  data_end.u32(out_->crc());
  write_record(mcap::kDataEnd, data_end);

  ByteWriter statistics;
  statistics.u64(file_counted_.messages);
  statistics.u16(schemas_);
  statistics.u32(channels_);
  statistics.u32(attachments_);
  statistics.u32(metadata_);
  statistics.u32(chunks_);
  statistics.u64(file_counted_.start_time);
  statistics.u64(file_counted_.end_time);
  put_map(statistics, messages_of_channel_);
  put_record(summary_[mcap::kStatistics], mcap::kStatistics, statistics);

  const std::uint64_t summary_start = bytes_written();
  out_->begin_crc();  // from here on: of the summary section
  ByteWriter offsets;
  const std::map<std::uint8_t, const Spool*> spools = {{mcap::kChunkIndex, &chunk_indexes_},
                                                       {mcap::kMetadataIndex, &seal_indexes_}};
  for (const auto& [opcode, spool] : spools)
    if (spool->size() > 0) static_cast<void>(summary_[opcode]);  // has its place among them
  for (const auto& [opcode, records] : summary_) {
    const std::uint64_t group_start = bytes_written();
    out_->write(records.bytes());
    const auto spool = spools.find(opcode);
    if (spool != spools.end() && !spool->second->read([&](auto bytes) { out_->write(bytes); })) {
      out_->set_error("read back the index of");
      return;
    }
    offsets.u8(mcap::kSummaryOffset);
    offsets.u64(1 + 8 + 8);
    offsets.u8(opcode);
    offsets.u64(group_start);
    offsets.u64(bytes_written() - group_start);
  }
  const std::uint64_t offsets_start = bytes_written();
  out_->write(offsets.bytes());

  out_->write(footer_of(summary_start, offsets_start, out_->crc()).bytes());
}

Status McapWriter::close() {
  if (!closed_) {
    closed_ = true;
    end_chunk();
    write_summary();
    return sync();
  }
  if (error()) return *error();
  return ok();
}

}  // namespace mortise
