#include "common/io/log/mcap_index.h"

#include <algorithm>

#include "common/io/log/crc32.h"
#include "common/io/log/mcap_format.h"

namespace mortise::mcap {

std::map<std::string, std::string> read_map(ByteReader& in) {
  ByteReader entries(in.raw(in.u32()));
  std::map<std::string, std::string> values;
  while (entries.left() > 0) {
    std::string key = entries.string();
    std::string value = entries.string();
    if (entries.ok()) values[std::move(key)] = std::move(value);
  }
  return values;
}

std::optional<McapSchema> schema_of(std::span<const std::byte> content) {
  ByteReader reader(content);
  McapSchema schema;
  schema.id = reader.u16();
  schema.name = reader.string();
  schema.encoding = reader.string();
  schema.data = reader.raw(reader.u32());
  if (!reader.ok() || schema.id == 0) return std::nullopt;
  return schema;
}

std::optional<McapChannel> channel_of(std::span<const std::byte> content) {
  ByteReader reader(content);
  McapChannel channel;
  channel.id = reader.u16();
  channel.schema = reader.u16();
  channel.topic = reader.string();
  channel.message_encoding = reader.string();
  channel.metadata = read_map(reader);
  if (!reader.ok()) return std::nullopt;
  return channel;
}

namespace {

std::map<std::uint16_t, std::uint64_t> messages_of(std::span<const std::byte> statistics) {
  ByteReader reader(statistics);
  reader.raw(8 + 2 + 4 + 4 + 4 + 4 + 8 + 8);  // counts of the whole file, two times
  ByteReader entries(reader.raw(reader.u32()));
  std::map<std::uint16_t, std::uint64_t> messages;
  while (entries.left() > 0) {
    const std::uint16_t channel = entries.u16();
    const std::uint64_t count = entries.u64();
    if (entries.ok()) messages[channel] = count;
  }
  return messages;
}

}  // namespace

std::optional<Index> read_index(const InputFile& file, std::uint64_t at) {
  constexpr std::uint64_t kTailBytes = kRecordHeaderBytes + kFooterBytes + kMagic.size();
  if (file.size() < kTailBytes) return std::nullopt;
  std::vector<std::byte> tail_buffer;
  ByteReader tail(file.read(file.size() - kTailBytes, kTailBytes, tail_buffer));
  const bool is_footer = tail.u8() == kFooter && tail.u64() == kFooterBytes;
  const std::uint64_t told = tail.u64(), start = at == 0 ? told : at;
  tail.u64();
  const std::uint32_t crc = tail.u32();
  const bool is_end = std::ranges::equal(tail.raw(kMagic.size()), std::as_bytes(std::span(kMagic)));
  const std::uint64_t crc_end = file.size() - kMagic.size() - 4;
  if (!tail.ok() || !is_footer || !is_end || crc == 0 || start == 0 || start > crc_end)
    return std::nullopt;
  Index index;
  index.start = start;
  const auto summary = file.read(start, crc_end - start, index.bytes);
  if (crc32(summary) != crc) return std::nullopt;
  ByteReader reader(summary);
  while (reader.left() > 0) {
    const std::uint8_t opcode = reader.u8();
    if (opcode == kFooter) break;
    const auto content = reader.raw(reader.u64());
    if (!reader.ok()) break;
    if (opcode == kSchema) {
      if (const auto schema = schema_of(content)) index.schemas.emplace(schema->id, *schema);
    } else if (opcode == kChannel) {
      if (auto channel = channel_of(content))
        index.channels.emplace(channel->id, std::move(*channel));
    } else if (opcode == kStatistics) {
      index.messages = messages_of(content);
    }
  }
  return index;
}

}  // namespace mortise::mcap
