#include "common/io/log/log_checkpoint.h"

#include <algorithm>

#include "common/base/hash.h"
#include "common/io/state/state_fields.h"

namespace mortise::log_records {

using state_bytes::Reader;
using state_bytes::Writer;

namespace {
// 2: of the clashes that ended only the last ones.
constexpr std::uint8_t kTotalsLayout = 2;
}  // namespace

std::vector<std::byte> encode(const Checkpoint& state) {
  Writer counters;
  counters(state.counters, state.counters.event_times_at_latest);
  const std::vector<std::byte> counted = counters.take();
  ByteWriter out;
  out.u8(kStateLayout);
  out.varint(state.tick);
  out.u64(state.state_hash);
  out.string(state.build);
  out.string(content_hash(state.bytes));
  out.varint(counted.size());
  out.raw(counted);
  out.raw(state.bytes);
  return out.take();
}

bool decode(std::span<const std::byte> bytes, Checkpoint& out, bool keep) {
  ByteReader in(bytes);
  out = {};
  if (in.u8() != kStateLayout) return false;
  out.tick = in.varint();
  out.state_hash = in.u64();
  out.build = in.string();
  out.hash = in.string();
  Reader counted(in.raw(in.varint()));
  counted(out.counters);
  if (!counted.at_end()) counted(out.counters.event_times_at_latest);  // files of before have none
  if (!counted.at_end()) return false;
  const auto state = in.raw(in.left());
  if (!in.ok() || content_hash(state) != out.hash) return false;
  if (keep) out.bytes.assign(state.begin(), state.end());
  return true;
}

std::vector<std::byte> encode(const SessionStatistics& totals) {
  Writer out;
  out(kTotalsLayout);
  out(totals);
  return out.take();
}

bool decode(std::span<const std::byte> bytes, SessionStatistics& out) {
  Reader in(bytes);
  std::uint8_t layout = 0;
  SessionStatistics totals;
  in(layout, totals);
  if (layout != kTotalsLayout || !in.at_end() || !totals.is_whole()) return false;
  out = std::move(totals);
  return true;
}

}  // namespace mortise::log_records
