#include "common/io/log/mcap_reader.h"

#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>
#include <set>
#include <utility>

#include "common/io/log/crc32.h"
#include "common/io/log/input_file.h"
#include "common/io/log/mcap_format.h"
#include "common/io/log/mcap_index.h"
#include "common/io/state/bytes.h"

namespace mortise {
namespace {

// A damaged file must not fill the report with one line per byte.
constexpr std::size_t kMostNotes = 50;

// A chunk's head up to its records. Names of compressions are short.
constexpr std::size_t kLongestCompression = 32;
constexpr std::size_t kChunkHeadBytes =
    mcap::kRecordHeaderBytes + mcap::kChunkFixedBytes + kLongestCompression;

// What such a head, cut at the end of the file, says of its compression; nothing: its lengths
// contradict each other, or the `left` bytes from it to the end of the file.
std::optional<std::string> compression_of(std::span<const std::byte> head, std::uint64_t left) {
  ByteReader reader(head.first(std::min(head.size(), kChunkHeadBytes)));
  reader.u8();
  const std::uint64_t length = reader.u64();
  if (!reader.ok() || length > left - mcap::kRecordHeaderBytes) return std::nullopt;
  reader.raw(8 + 8 + 8 + 4);
  std::string compression = reader.string();
  const std::uint64_t stored = reader.u64();
  const std::uint64_t fixed = mcap::kChunkFixedBytes + compression.size();
  if (!reader.ok() || length < fixed || stored != length - fixed) return std::nullopt;
  return compression;
}

// The next place at or after `from` that is a chunk by all its lengths; the size of the file when
// there is none. Linear: what is read is a small multiple of the bytes up to that place.
std::uint64_t find_chunk(const InputFile& file, std::uint64_t from,
                         std::vector<std::byte>& buffer) {
  constexpr std::uint64_t kFirstWindow = 256, kWindow = 1 << 16;  // bytes read at once
  std::uint64_t bytes = kFirstWindow;
  for (std::uint64_t start = from; start < file.size();
       start += bytes, bytes = std::min(2 * bytes, kWindow)) {
    const auto window = file.read(start, bytes + kChunkHeadBytes, buffer);
    for (std::size_t i = 0; i < window.size() && i < bytes; ++i) {
      if (window[i] != std::byte{mcap::kChunk}) continue;
      const std::uint64_t here = start + i;
      const auto compression = compression_of(window.subspan(i), file.size() - here);
      if (compression && (compression->empty() || *compression == "zstd")) return here;
    }
  }
  return file.size();
}

// A record of any other kind whose length is damaged may span chunks; theirs is checked as such.
bool has_own_check(std::uint8_t opcode) {
  return opcode == mcap::kChunk || opcode == mcap::kMessage;
}

// Begins a record there, or ends the file? A footer stands behind the end of data alone.
bool begins_record(const InputFile& file, std::uint64_t at, std::vector<std::byte>& buffer) {
  if (at == file.size()) return true;
  ByteReader reader(file.read(at, mcap::kRecordHeaderBytes, buffer));
  const std::uint8_t opcode = reader.u8();
  const std::uint64_t length = reader.u64();
  const bool known = opcode != 0 && opcode <= mcap::kDataEnd && opcode != mcap::kFooter;
  return reader.ok() && known && length <= file.size() - at;
}

// False: it is damaged.
bool tell_metadata(const McapHandler& handler, std::span<const std::byte> content) {
  ByteReader reader(content);
  const std::string name = reader.string();
  const auto values = mcap::read_map(reader);
  if (reader.ok() && handler.on_metadata) handler.on_metadata(name, values);
  return reader.ok();
}

// `size` bytes in `into`; empty: they are damaged.
std::span<const std::byte> decompressed(std::span<const std::byte> data, std::uint64_t size,
                                        std::vector<std::byte>& into) {
  const unsigned long long claimed = ZSTD_getFrameContentSize(data.data(), data.size());
  if (claimed == ZSTD_CONTENTSIZE_ERROR || (claimed != ZSTD_CONTENTSIZE_UNKNOWN && claimed != size))
    return {};
  if (into.size() < size) into.resize(static_cast<std::size_t>(size));
  const std::size_t got =
      ZSTD_decompress(into.data(), static_cast<std::size_t>(size), data.data(), data.size());
  if (ZSTD_isError(got) != 0 || got != size) return {};
  return std::span<const std::byte>(into).first(got);
}

// Nothing where it is damaged.
std::optional<McapAttachment> attachment_of(std::span<const std::byte> content) {
  ByteReader reader(content);
  McapAttachment attachment;
  attachment.log_time_ns = reader.u64();
  reader.u64();
  attachment.name = reader.string();
  attachment.media_type = reader.string();
  attachment.data = reader.raw(reader.u64());
  const std::uint32_t crc = reader.u32();
  if (!reader.ok() || (crc != 0 && crc32(content.first(content.size() - 4)) != crc))
    return std::nullopt;
  return attachment;
}

// How many messages the index states, by topic.
std::map<std::string, std::uint64_t> stated_of(
    const mcap::Index& index, const std::map<std::uint16_t, McapChannel>& channels) {
  std::map<std::string, std::uint64_t> stated;
  for (const auto& [id, count] : index.messages)
    if (const auto channel = channels.find(id); channel != channels.end())
      stated[channel->second.topic] += count;
  return stated;
}

// The file was closed with its index at `told_at`, and that is now somewhere else.
std::string moved_text(std::uint64_t found_at, std::uint64_t told_at) {
  const bool is_less = told_at > found_at;
  return std::to_string(is_less ? told_at - found_at : found_at - told_at) + " bytes were " +
         (is_less ? "taken out" : "added") + " before this place, after the file had been closed";
}

// False: the length is damaged, by what is known without the content.
bool has_likely_length(const InputFile& file, std::uint64_t at, std::uint8_t opcode,
                       std::uint64_t length, std::vector<std::byte>& buffer) {
  if (opcode == mcap::kFooter) return length == mcap::kFooterBytes;
  if (opcode == mcap::kDataEnd) return length <= mcap::kFooterBytes;
  if (opcode != mcap::kChunk) return true;
  return compression_of(file.read(at, kChunkHeadBytes, buffer), file.size() - at).has_value();
}

// Bytes that may still be read from places that the scan perhaps goes back to: no more than the
// file in all. Reading each of many absurd records up to the end would take its square.
struct Doubt {
  std::uint64_t left = 0;
  bool takes(std::uint64_t bytes) {
    if (bytes > left) return false;
    left -= bytes;
    return true;
  }
};

// Does such a record end there, by its own check or by the record that begins there?
bool ends_at(std::uint64_t at, std::uint8_t opcode, const InputFile& file,
             std::uint64_t index_start, std::vector<std::byte>& buffer) {
  return opcode >= mcap::kDataEnd || has_own_check(opcode) ||
         (at < index_start && begins_record(file, at, buffer));
}

// The index that was told to be elsewhere, where it is at `at`.
std::optional<mcap::Index> moved_index(const InputFile& file, std::uint64_t told_at,
                                       std::uint64_t at, Doubt& doubt) {
  if (told_at == 0 || !doubt.takes(file.size() - at)) return std::nullopt;
  return mcap::read_index(file, at);
}

class Scanner {
 public:
  Scanner(const InputFile& file, const McapHandler& handler, const McapLimits& limits,
          mcap::Index index)
      : file_(file), handler_(handler), limits_(limits), index_(std::move(index)) {
    const std::uint64_t size = file.size();
    expansion_left_ = size > UINT64_MAX / limits.expansion ? UINT64_MAX : size * limits.expansion;
    expansion_left_ = std::max(expansion_left_, limits.expansion_floor_bytes);
  }

  McapScan run();

 private:
  enum class Next { kGoOn, kResync, kEnd };
  Next record(std::uint8_t opcode, std::uint64_t length, std::span<const std::byte> content);
  Next data_end(std::span<const std::byte> content, std::uint64_t next_offset);
  bool chunk(std::span<const std::byte> content);
  void chunk_records(std::span<const std::byte> records);
  void schema(std::span<const std::byte> content);
  void channel(std::span<const std::byte> content);
  void announce(McapChannel channel);
  void announce_missing();
  void message(std::span<const std::byte> content);
  void attachment(std::span<const std::byte> content);
  void note(const std::string& what);
  void loss(const std::string& what);

  const InputFile& file_;
  const McapHandler& handler_;
  const McapLimits& limits_;
  McapScan scan_;
  std::uint64_t at_ = 0;  ///< of the record in work
  std::uint64_t expansion_left_ = 0;
  Doubt doubt_{file_.size()};
  bool crc_known_ = true;
  std::uint32_t crc_ = 0;
  mcap::Index index_;  ///< empty: there is none that is whole
  bool all_announced_ = false;
  std::map<std::uint16_t, McapChannel> channels_;
  std::set<std::uint16_t> unknown_channels_;
  std::vector<std::byte> buffer_, search_buffer_, decompressed_;
};

void Scanner::note(const std::string& what) {
  if (scan_.notes.size() < kMostNotes)
    scan_.notes.push_back("byte " + std::to_string(at_) + ": " + what);
  else if (scan_.notes.size() == kMostNotes)
    scan_.notes.push_back("more findings of this kind are not listed");
}

void Scanner::loss(const std::string& what) {
  note(what);
  if (handler_.on_loss) handler_.on_loss("byte " + std::to_string(at_) + ": " + what);
}

McapScan Scanner::run() {
  crc_ = crc32(file_.read(0, mcap::kMagic.size(), buffer_));
  at_ = mcap::kMagic.size();
  while (true) {
    if (at_ == file_.size()) {
      note("the file ends without footer: it was not closed");
      break;
    }
    const auto head = file_.read(at_, mcap::kRecordHeaderBytes, buffer_);
    ByteReader reader(head);
    const std::uint8_t opcode = reader.u8();
    const std::uint64_t length = reader.u64();
    const std::uint64_t content_at = at_ + mcap::kRecordHeaderBytes;
    Next next = Next::kResync;
    const bool is_inside = reader.ok() && opcode != 0 && content_at <= file_.size() &&
                           length <= file_.size() - content_at;
    const bool ends_well =
        is_inside && ends_at(content_at + length, opcode, file_, index_.start, search_buffer_);
    if (is_inside && has_likely_length(file_, at_, opcode, length, search_buffer_) &&
        (ends_well || doubt_.takes(length))) {
      if (opcode != mcap::kDataEnd) crc_ = crc32(head, crc_);
      const auto content = file_.read(content_at, length, buffer_);
      if (content.size() == length) {
        next = opcode == mcap::kDataEnd ? data_end(content, content_at + length)
                                        : record(opcode, length, content);
        if (opcode != mcap::kDataEnd) crc_ = crc32(content, crc_);
      }
    }
    if (next == Next::kEnd) break;
    if (next == Next::kGoOn && !ends_well) next = Next::kResync;
    if (next == Next::kGoOn) {
      if (handler_.is_enough && handler_.is_enough()) break;
      at_ = content_at + length;
      if (handler_.on_progress)
        handler_.on_progress(static_cast<double>(at_) / static_cast<double>(file_.size()));
      continue;
    }
    crc_known_ = false;
    const std::uint64_t found = find_chunk(file_, at_ + 1, search_buffer_);
    if (found == file_.size()) {
      loss("the tail is cut off or damaged: " + std::to_string(file_.size() - at_) +
           " bytes are no whole record");
      break;
    }
    loss("damaged: " + std::to_string(found - at_) + " bytes left out up to the next whole chunk");
    at_ = found;
  }
  return std::move(scan_);
}

Scanner::Next Scanner::record(std::uint8_t opcode, std::uint64_t length,
                              std::span<const std::byte> content) {
  ++scan_.records;
  switch (opcode) {
    case mcap::kHeader: {
      ByteReader reader(content);
      scan_.profile = reader.string();
      scan_.library = reader.string();
      break;
    }
    case mcap::kSchema:
      schema(content);
      break;
    case mcap::kChannel:
      channel(content);
      break;
    case mcap::kMessage:  // our messages stand in chunks: this was another record
      note("a message outside of chunks is left out");
      break;
    case mcap::kChunk:
      announce_missing();
      return chunk(content) ? Next::kGoOn : Next::kResync;
    case mcap::kAttachment:
      attachment(content);
      break;
    case mcap::kMetadata:
      if (!tell_metadata(handler_, content)) note("metadata record is damaged and left out");
      break;
    case mcap::kFooter:
      note("a footer without end of data");
      return length == mcap::kFooterBytes ? Next::kEnd : Next::kResync;
    default:
      if (opcode > mcap::kDataEnd)
        note("record of unknown kind " + std::to_string(opcode) + " left out");
      break;
  }
  return Next::kGoOn;
}

Scanner::Next Scanner::data_end(std::span<const std::byte> content, std::uint64_t next_offset) {
  ByteReader reader(content);
  const std::uint32_t data_crc = reader.u32();
  const std::size_t tail_bytes =
      mcap::kRecordHeaderBytes + mcap::kFooterBytes + mcap::kMagic.size();
  const std::uint64_t footer_at = file_.size() - std::min<std::uint64_t>(file_.size(), tail_bytes);
  std::vector<std::byte> tail_buffer;
  ByteReader tail(file_.read(footer_at, tail_bytes, tail_buffer));
  const bool footer = tail.u8() == mcap::kFooter && tail.u64() == mcap::kFooterBytes;
  const std::uint64_t summary_start = tail.u64();
  tail.u64();
  const std::uint32_t summary_crc = tail.u32();
  const auto magic = tail.raw(mcap::kMagic.size());
  const bool closed =
      reader.ok() && tail.ok() && footer &&
      std::ranges::equal(magic, std::as_bytes(std::span(mcap::kMagic))) &&
      (summary_start == next_offset || (summary_start == 0 && footer_at == next_offset));
  if (!closed) {
    const auto moved = moved_index(file_, summary_start, next_offset, doubt_);
    if (moved && reader.ok() && content.size() == 4) {
      note(moved_text(next_offset, summary_start));
      scan_.stated = stated_of(*moved, channels_);
      scan_.complete = true;
      return Next::kEnd;
    }
    // Either the file lost its tail inside the summary, or this is no end of data at all.
    if (reader.ok() && content.size() == 4 &&
        find_chunk(file_, next_offset, search_buffer_) == file_.size()) {
      note("the index at the end is cut off or damaged; it is not needed");
      return Next::kEnd;
    }
    return Next::kResync;
  }
  scan_.complete = true;
  scan_.stated = stated_of(index_, channels_);
  if (crc_known_ && data_crc != 0 && data_crc != crc_)
    note(
        "the checksum of the data section does not fit: some record between the chunks is damaged");
  if (summary_start != 0 && summary_crc != 0) {
    const auto summary =
        file_.read(summary_start, file_.size() - mcap::kMagic.size() - 4 - summary_start, buffer_);
    if (crc32(summary) != summary_crc) note("the index at the end is damaged; it is not needed");
  }
  return Next::kEnd;
}

bool Scanner::chunk(std::span<const std::byte> content) {
  ByteReader reader(content);
  reader.u64();
  reader.u64();
  const std::uint64_t size = reader.u64();
  const std::uint32_t crc = reader.u32();
  const std::string compression = reader.string();
  const std::uint64_t stored = reader.u64();
  if (!reader.ok() || stored != reader.left()) return false;  // the lengths disagree
  std::span<const std::byte> records = reader.raw(stored);
  ++scan_.chunks;
  const auto lost = [&](const std::string& why) {
    ++scan_.lost_chunks;
    loss("chunk left out: " + why);
    return true;
  };
  if (size > limits_.chunk_bytes) return lost("it claims " + std::to_string(size) + " bytes");
  if (size > expansion_left_) return lost("the file expands beyond the limit");
  expansion_left_ -= size;
  if (compression == "zstd") {
    records = decompressed(records, size, decompressed_);
    if (records.size() != size) return lost("its compressed data are damaged");
  } else if (!compression.empty()) {
    return lost("unknown compression");
  } else if (size != stored) {
    return lost("its size is wrong");
  }
  if (crc != 0 && crc32(records) != crc) return lost("its checksum does not fit");
  chunk_records(records);
  return true;
}

void Scanner::chunk_records(std::span<const std::byte> records) {
  ByteReader reader(records);
  while (reader.left() > 0) {
    const std::uint8_t opcode = reader.u8();
    const auto content = reader.raw(reader.u64());
    if (!reader.ok()) {
      ++scan_.lost_chunks;
      loss("the end of a chunk is damaged and left out");
      return;
    }
    ++scan_.records;
    if (opcode == mcap::kSchema)
      schema(content);
    else if (opcode == mcap::kChannel)
      channel(content);
    else if (opcode == mcap::kMessage)
      message(content);
    else
      note("record of kind " + std::to_string(opcode) + " inside a chunk left out");
  }
}

// What the index says of a record of the front is what was written: it has a checksum.
void Scanner::schema(std::span<const std::byte> content) {
  const auto schema = mcap::schema_of(content);
  if (!schema) return note("schema record is damaged and left out");
  const auto again = index_.schemas.find(schema->id);
  if (handler_.on_schema)
    handler_.on_schema(again == index_.schemas.end() ? *schema : again->second);
}

void Scanner::channel(std::span<const std::byte> content) {
  std::optional<McapChannel> channel = mcap::channel_of(content);
  if (!channel) return note("channel record is damaged and left out");
  if (!index_.channels.empty()) {
    const auto again = index_.channels.find(channel->id);
    if (again == index_.channels.end())
      return note("a channel that is not in the index is left out");
    if (again->second.topic != channel->topic || again->second.schema != channel->schema ||
        again->second.message_encoding != channel->message_encoding)
      note("channel record is damaged; its copy in the index is taken");
    channel = again->second;
  }
  announce(std::move(*channel));
}

void Scanner::announce(McapChannel channel) {
  const auto [entry, is_new] = channels_.try_emplace(channel.id, std::move(channel));
  if (is_new && handler_.on_channel) handler_.on_channel(entry->second);
}

// Channels whose record at the front is damaged, before the first message needs them.
void Scanner::announce_missing() {
  if (std::exchange(all_announced_, true)) return;
  for (const auto& [id, channel] : index_.channels) {
    if (channels_.contains(id)) continue;
    const auto schema = index_.schemas.find(channel.schema);
    if (schema != index_.schemas.end() && handler_.on_schema) handler_.on_schema(schema->second);
    announce(channel);
  }
}

void Scanner::message(std::span<const std::byte> content) {
  ByteReader reader(content);
  const std::uint16_t channel = reader.u16();
  McapMessage message;
  message.sequence = reader.u32();
  message.log_time_ns = reader.u64();
  message.publish_time_ns = reader.u64();
  message.data = reader.raw(reader.left());
  const auto known = channels_.find(channel);
  if (!reader.ok() || known == channels_.end()) {
    if (!unknown_channels_.insert(channel).second) return;
    const std::string what =
        "messages of channel " + std::to_string(channel) + " left out: it was never announced";
    note(what);
    if (handler_.on_stray) handler_.on_stray("byte " + std::to_string(at_) + ": " + what);
    return;
  }
  ++scan_.messages;
  if (handler_.on_message) handler_.on_message(known->second, message);
}

void Scanner::attachment(std::span<const std::byte> content) {
  ++scan_.attachments;
  const std::optional<McapAttachment> attachment = attachment_of(content);
  if (!attachment) {
    ++scan_.lost_attachments;
    note("attachment is damaged and left out");
  } else if (handler_.on_attachment) {
    handler_.on_attachment(*attachment);
  }
}

}  // namespace

Result<McapScan> scan_mcap(const std::filesystem::path& file, const McapHandler& handler,
                           const McapLimits& limits) {
  const InputFile input(file);
  if (!input.is_open())
    return fail(Code::kNotFound, file.string() + ": cannot open the log: " + std::strerror(errno));
  if (input.size() == 0)
    return fail(Code::kInvalidInput, file.string() + ": is empty; there is nothing to read");
  std::optional<mcap::Index> index = mcap::read_index(input);
  std::vector<std::byte> magic;
  const bool begins = std::ranges::equal(input.read(0, mcap::kMagic.size(), magic),
                                         std::as_bytes(std::span(mcap::kMagic)));
  // One that ends as such a file does is one whose first bytes are damaged.
  if (!begins && !index)
    return fail(Code::kInvalidInput,
                file.string() +
                    ": is no session log (MCAP): it does not begin as one; is it the right file?");
  McapScan scan = Scanner(input, handler, limits, std::move(index).value_or(mcap::Index{})).run();
  scan.file_bytes = input.size();
  scan.bytes_read = input.bytes_read();
  return scan;
}

}  // namespace mortise
