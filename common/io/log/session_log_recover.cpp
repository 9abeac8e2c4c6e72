#include "common/io/build_info.h"
#include "common/io/log/log_json.h"
#include "common/io/log/log_layout.h"
#include "common/io/log/mcap_reader.h"
#include "common/io/log/mcap_writer.h"
#include "common/io/log/session_log.h"

namespace mortise {

// A copy record by record: what this program does not know (topics of a later version) survives.
Result<Recovery> recover_session_log(const std::filesystem::path& damaged,
                                     const std::filesystem::path& new_file) {
  Result<SessionLog> readable = read_session_log(damaged);
  if (!readable) return readable.error();
  auto created = McapWriter::create(
      new_file, {.profile = log_layout::kProfile, .library = "mortise " + engine_version()});
  if (!created) return created.error();
  McapWriter& out = **created;

  std::map<std::uint16_t, std::uint16_t> schemas, channels;  // number there -> number here
  std::uint16_t gaps_channel = 0;
  std::uint64_t time_ns = 0;
  const auto mark_gap = [&](const std::string& reason) {
    if (gaps_channel == 0) return;  // lost before anything was recorded: said in the metadata
    const std::string gap = log_json::encode(log_json::Gap{.reason = reason});
    out.add_message(gaps_channel, time_ns, std::as_bytes(std::span(gap)));
  };
  const McapHandler handler{
      .on_schema =
          [&](const McapSchema& schema) {
            if (!schemas.contains(schema.id))
              schemas[schema.id] = out.add_schema(
                  schema.name, schema.encoding,
                  {reinterpret_cast<const char*>(schema.data.data()), schema.data.size()});
          },
      .on_channel =
          [&](const McapChannel& channel) {
            const auto schema = schemas.find(channel.schema);
            const std::uint16_t number =
                out.add_channel(channel.topic, channel.message_encoding,
                                schema == schemas.end() ? 0 : schema->second, channel.metadata);
            channels[channel.id] = number;
            if (channel.topic == log_layout::kGaps) gaps_channel = number;
          },
      .on_message =
          [&](const McapChannel& channel, const McapMessage& message) {
            time_ns = message.log_time_ns;
            out.add_message(channels[channel.id], time_ns, message.data);
            if (channel.topic == log_layout::kTicks && out.chunk_is_full()) out.end_chunk();
          },
      .on_attachment =
          [&](const McapAttachment& attachment) {
            out.add_attachment(attachment.name, attachment.media_type, attachment.data,
                               attachment.log_time_ns);
          },
      .on_metadata = [&](const std::string& name,
                         const auto& values) { out.add_metadata(name, values); },
      .on_loss = mark_gap};
  const Result<McapScan> scan = scan_mcap(damaged, handler);
  if (!scan) return scan.error();

  std::map<std::string, std::string> account = {{"was_complete", scan->complete ? "yes" : "no"},
                                                {"lost_chunks", std::to_string(scan->lost_chunks)}};
  for (std::size_t i = 0; i < readable->notes.size(); ++i)
    account["note/" + std::to_string(i + 1)] = readable->notes[i];
  out.add_metadata(log_layout::kRecoveryMetadata, account);
  if (const Status closed = out.close(); !closed) return closed.error();
  return Recovery{.ticks = readable->ticks.size(),
                  .messages = scan->messages,
                  .lost_chunks = scan->lost_chunks,
                  .was_complete = scan->complete,
                  .notes = std::move(readable->notes)};
}

}  // namespace mortise
