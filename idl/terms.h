#pragma once
#include <fastdds/rtps/writer/WriterDiscoveryInfo.h>
#include <cstdint>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <string>
#include <vector>

namespace mortise {

/// Who led a session later has the higher term: ms since 1970 of its beginning, told with the
/// server's writers; 0: one that tells none.
std::uint64_t term_of(const std::vector<eprosima::fastrtps::rtps::octet>& user_data);
/// The last one that is a time, the year 2116: what is later is a mistake or a lie, and counts for
/// nothing. There is room for one more for each that was ever taken.
inline constexpr std::uint64_t kLatestTerm_ms = (std::uint64_t{1} << 62U) / 1'000'000;
/// The one of now, or where the clock says less, the next.
std::uint64_t next_term(std::uint64_t after);
/// The term that a server of the session tells with this writer; 0: it is no such writer, or goes.
std::uint64_t told_term(const eprosima::fastrtps::rtps::WriterDiscoveryInfo& writer,
                        const std::string& session);
/// Of the program that wrote it, told behind the term; empty: one of before told none.
std::string version_of(const std::vector<eprosima::fastrtps::rtps::octet>& user_data);
/// The other way: the term first, for programs of before read it there and nothing behind it.
void put_term(std::uint64_t term, eprosima::fastdds::dds::DataWriterQos& qos);

}  // namespace mortise
