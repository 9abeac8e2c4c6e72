#include "common/io/log/log_index_check.h"

#include <algorithm>

#include "common/io/log/crc32.h"
#include "common/io/log/log_layout.h"
#include "common/io/log/mcap_format.h"

namespace mortise {
namespace {

ByteWriter as_record(std::uint8_t opcode, std::span<const std::byte> content) {
  ByteWriter record;
  record.u8(opcode);
  record.u64(content.size());
  record.raw(content);
  return record;
}

template <class Entries>
void put_offsets(ByteWriter& out, const Entries& entries) {
  out.u32(static_cast<std::uint32_t>(entries.size() * (2 + 8)));
  for (const auto& [channel, value] : entries) {
    out.u16(channel);
    out.u64(value);
  }
}

}  // namespace

void ExpectedIndex::record(std::uint64_t at, std::uint8_t opcode,
                           std::span<const std::byte> content) {
  if (!has_begun_) crc_ = crc32(std::as_bytes(std::span(mcap::kMagic)));
  has_begun_ = true;
  const ByteWriter record = as_record(opcode, content);
  crc_ = crc32(record.bytes(), crc_);
  if (opcode == mcap::kMessageIndex) return message_index(at, content);
  end_chunk();
  if (opcode == mcap::kChunk) {
    open_.at = at;
    open_.bytes = record.size();
    chunk(content);
  } else if (opcode == mcap::kSchema || opcode == mcap::kChannel) {
    groups_[opcode].raw(record.bytes());
    if (opcode == mcap::kSchema) ++schemas_;
    if (opcode == mcap::kChannel) messages_[ByteReader(content).u16()] = 0;
  } else if (opcode == mcap::kAttachment) {
    attachment(at, content);
  } else if (opcode == mcap::kMetadata) {
    metadata(at, content);
  }
}

void ExpectedIndex::chunk(std::span<const std::byte> content) {
  ByteReader reader(content);
  open_.start_time = reader.u64();
  open_.end_time = reader.u64();
  open_.size = reader.u64();
  reader.u32();
  open_.compression = reader.string();
  open_.stored = reader.u64();
  first_time_ = chunks_ == 0 ? open_.start_time : std::min(first_time_, open_.start_time);
  last_time_ = std::max(last_time_, open_.end_time);
  ++chunks_;
}

void ExpectedIndex::message_index(std::uint64_t at, std::span<const std::byte> content) {
  ByteReader reader(content);
  const std::uint16_t channel = reader.u16();
  const std::uint64_t count = reader.u32() / 16;
  messages_[channel] += count;
  all_messages_ += count;
  open_.offsets.emplace_back(channel, at);
  open_.index_bytes += mcap::kRecordHeaderBytes + content.size();
}

void ExpectedIndex::end_chunk() {
  if (open_.at == 0) return;
  ByteWriter index;
  index.u64(open_.start_time);
  index.u64(open_.end_time);
  index.u64(open_.at);
  index.u64(open_.bytes);
  put_offsets(index, open_.offsets);
  index.u64(open_.index_bytes);
  index.string(open_.compression);
  index.u64(open_.stored);
  index.u64(open_.size);
  groups_[mcap::kChunkIndex].raw(as_record(mcap::kChunkIndex, index.bytes()).bytes());
  open_ = {};
}

void ExpectedIndex::attachment(std::uint64_t at, std::span<const std::byte> content) {
  ByteReader reader(content);
  const std::uint64_t log_time = reader.u64(), create_time = reader.u64();
  const std::string name = reader.string(), media_type = reader.string();
  ByteWriter index;
  index.u64(at);
  index.u64(mcap::kRecordHeaderBytes + content.size());
  index.u64(log_time);
  index.u64(create_time);
  index.u64(reader.u64());
  index.string(name);
  index.string(media_type);
  groups_[mcap::kAttachmentIndex].raw(as_record(mcap::kAttachmentIndex, index.bytes()).bytes());
  ++attachments_;
}

void ExpectedIndex::metadata(std::uint64_t at, std::span<const std::byte> content) {
  const std::string name = ByteReader(content).string();
  ByteWriter index;
  index.u64(at);
  index.u64(mcap::kRecordHeaderBytes + content.size());
  index.string(name);
  ByteWriter& group = name == log_layout::kSealMetadata ? seals_ : groups_[mcap::kMetadataIndex];
  group.raw(as_record(mcap::kMetadataIndex, index.bytes()).bytes());
  ++metadata_;
}

ByteWriter ExpectedIndex::statistics() const {
  ByteWriter statistics;
  statistics.u64(all_messages_);
  statistics.u16(static_cast<std::uint16_t>(schemas_));
  statistics.u32(static_cast<std::uint32_t>(messages_.size()));
  statistics.u32(attachments_);
  statistics.u32(metadata_);
  statistics.u32(chunks_);
  statistics.u64(first_time_);
  statistics.u64(last_time_);
  put_offsets(statistics, messages_);
  return as_record(mcap::kStatistics, statistics.bytes());
}

std::vector<std::byte> ExpectedIndex::end(std::uint64_t at) const {
  ByteWriter content;
  content.u32(crc_);
  ByteWriter end = as_record(mcap::kDataEnd, content.bytes());
  const std::size_t before = end.size();
  const std::uint64_t start = at + before;
  std::map<std::uint8_t, ByteWriter> groups = groups_;
  groups[mcap::kMetadataIndex].raw(seals_.bytes());
  groups[mcap::kStatistics] = statistics();
  ByteWriter offsets;
  for (const auto& [opcode, records] : groups) {
    content.clear();
    content.u8(opcode);
    content.u64(at + end.size());
    content.u64(records.size());
    offsets.raw(as_record(mcap::kSummaryOffset, content.bytes()).bytes());
    end.raw(records.bytes());
  }
  const std::uint64_t offsets_start = at + end.size();
  end.raw(offsets.bytes());
  end.u8(mcap::kFooter);
  end.u64(mcap::kFooterBytes);
  end.u64(start);
  end.u64(offsets_start);
  end.u32(crc32(end.bytes().subspan(before)));
  end.raw(std::as_bytes(std::span(mcap::kMagic)));
  return end.take();
}

}  // namespace mortise
