#include "idl/terms.h"

#include <algorithm>
#include <charconv>
#include <chrono>

#include "idl/participant.h"

namespace mortise {
namespace {

const std::string kTermPrefix = "term=", kVersionPrefix = "version=";

}  // namespace

std::uint64_t term_of(const std::vector<eprosima::fastrtps::rtps::octet>& user_data) {
  const std::string text(user_data.begin(), user_data.end());
  std::uint64_t term = 0;
  if (!text.starts_with(kTermPrefix)) return 0;
  std::from_chars(text.data() + kTermPrefix.size(), text.data() + text.size(), term);
  return term <= kLatestTerm_ms ? term : 0;
}

std::uint64_t next_term(std::uint64_t after) {
  using std::chrono::milliseconds;
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const auto now_ms = std::chrono::duration_cast<milliseconds>(now).count();
  return std::max(static_cast<std::uint64_t>(std::max<std::int64_t>(now_ms, 0)), after + 1);
}

std::uint64_t told_term(const eprosima::fastrtps::rtps::WriterDiscoveryInfo& writer,
                        const std::string& session) {
  if (writer.status == eprosima::fastrtps::rtps::WriterDiscoveryInfo::REMOVED_WRITER) return 0;
  // Who leads answers, and tells with that writer when it leads anew.
  if (writer.info.topicName().to_string() != row_of(Topic::kAnswers).topic) return 0;
  const std::vector<std::string> partitions = writer.info.m_qos.m_partition.names();
  const bool is_here =
      std::find(partitions.begin(), partitions.end(), partition_of(session)) != partitions.end();
  return is_here ? term_of(writer.info.m_qos.m_userData.data_vec()) : 0;
}

std::string version_of(const std::vector<eprosima::fastrtps::rtps::octet>& user_data) {
  const std::string text(user_data.begin(), user_data.end());
  const std::size_t at = text.find(kVersionPrefix);
  if (at == std::string::npos) return {};
  const std::size_t first = at + kVersionPrefix.size();
  return text.substr(first, text.find(' ', first) - first);
}

void put_term(std::uint64_t term, eprosima::fastdds::dds::DataWriterQos& qos) {
  std::string text = kVersionPrefix + MORTISE_VERSION;
  if (term != 0) text = kTermPrefix + std::to_string(term) + " " + text;
  qos.user_data().data_vec({text.begin(), text.end()});
}

}  // namespace mortise
