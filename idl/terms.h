#pragma once
#include <fastdds/rtps/writer/WriterDiscoveryInfo.h>
#include <cstdint>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <string>
#include <vector>

namespace mortise {

/// Who led a session later has the higher term: ms since 1970 of its beginning, or one more than
/// that of the leader that it follows. Told with the server's writers; 0: one that tells none.
std::uint64_t term_of(const std::vector<eprosima::fastrtps::rtps::octet>& user_data);
/// The last one that is a time, the year 2116: what is later is a mistake or a lie, and counts for
/// nothing. There is room for one more for each that was ever taken.
inline constexpr std::uint64_t kLatestTerm_ms = (std::uint64_t{1} << 62U) / 1'000'000;
/// Of one that begins to lead: the one of now, or where the clock says less, the next.
std::uint64_t next_term(std::uint64_t after);
/// Of one that takes over from a leader of this term, however late it does: below any term of that
/// leader that it has not heard.
inline std::uint64_t term_of_successor(std::uint64_t leader) { return leader + 1; }
/// Of a leader that leads anew: above whoever took over from it meanwhile, whatever their clocks.
inline std::uint64_t term_led_anew(std::uint64_t led) { return next_term(term_of_successor(led)); }
/// The term that a server of the session tells with this writer; 0: it is no such writer, or goes.
std::uint64_t told_term(const eprosima::fastrtps::rtps::WriterDiscoveryInfo& writer,
                        const std::string& session);
/// Of the program that wrote it, told behind the term; empty: one of before told none.
std::string version_of(const std::vector<eprosima::fastrtps::rtps::octet>& user_data);
/// The other way: the term first, for programs of before read it there and nothing behind it.
void put_term(std::uint64_t term, eprosima::fastdds::dds::DataWriterQos& qos);

}  // namespace mortise
