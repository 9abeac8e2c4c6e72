#pragma once
#include <cstddef>
#include <string>
#include <string_view>

/// Texts of strangers, checked where they come in: what is behind a door is UTF-8 and may go into
/// JSON, XML, HTML, a terminal or a log as it is. All functions are linear in the bytes.
namespace mortise {

/// Longest name of a part or a feature, and of a user, bytes: chosen; idl/README.md promises them.
inline constexpr std::size_t kMostName_bytes = 128;
inline constexpr std::size_t kMostUserName_bytes = 64;

/// The bytes up to the first that is not UTF-8 (shortest form, no surrogates); all of them when
/// there is none.
std::size_t utf8_prefix(std::string_view text);

/// UTF-8 without control characters and line breaks.
bool is_text(std::string_view text);

/// A text of 1 to `most` bytes that a reader can see and cannot mistake: not blank, no invisible
/// characters, none that turns the direction of writing.
bool is_name(std::string_view text, std::size_t most = kMostName_bytes);

/// What a session may be called, which becomes part of file names and topics: 1 to 64 of letters,
/// digits, '-', '_' and '.', not beginning with '.'.
bool is_session_name(std::string_view text);

/// The text with U+FFFD in place of each byte that is not UTF-8.
std::string as_utf8(std::string_view text);

/// The same on one line: '?' in place of what is_text() refuses and of what turns the direction.
std::string one_line(std::string_view text);

}  // namespace mortise
