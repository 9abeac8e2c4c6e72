#include "common/base/plain_text.h"

#include <algorithm>
#include <array>
#include <boost/locale/utf.hpp>

namespace mortise {
namespace {

using Utf8 = boost::locale::utf::utf_traits<char>;
using boost::locale::utf::code_point;

bool is_character(code_point c) {
  return c != boost::locale::utf::illegal && c != boost::locale::utf::incomplete;
}

// Calls f(character, bytes) for each; a byte that is no UTF-8 comes alone, as `illegal`. f says
// whether to go on.
template <class F>
void for_each(std::string_view text, const F& f) {
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at != end) {
    const char* next = at;
    const code_point c = Utf8::decode(next, end);
    if (!is_character(c)) next = at + 1;
    if (!f(is_character(c) ? c : boost::locale::utf::illegal,
           std::string_view(at, static_cast<std::size_t>(next - at))))
      return;
    at = next;
  }
}

template <class F>
bool all_of(std::string_view text, const F& f) {
  bool all = true;
  for_each(text, [&](code_point c, std::string_view) { return all = is_character(c) && f(c); });
  return all;
}

struct Span {
  code_point first, last;
};
template <std::size_t N>
bool in(const std::array<Span, N>& spans, code_point c) {
  return std::any_of(spans.begin(), spans.end(),
                     [c](const Span& s) { return c >= s.first && c <= s.last; });
}

// The Unicode standard, chapter 23: C0, DEL and C1; the separators of lines and paragraphs.
constexpr std::array<Span, 3> kControls{{{0x00, 0x1f}, {0x7f, 0x9f}, {0x2028, 0x2029}}};
// Marks, embeddings, overrides and isolates of the bidirectional algorithm.
constexpr std::array<Span, 4> kDirections{
    {{0x61c, 0x61c}, {0x200e, 0x200f}, {0x202a, 0x202e}, {0x2066, 0x2069}}};
// Soft hyphen, zero width space, invisible operators, byte order mark, noncharacters, tags.
constexpr std::array<Span, 7> kInvisible{{{0xad, 0xad},
                                          {0x200b, 0x200b},
                                          {0x2060, 0x2064},
                                          {0xfdd0, 0xfdef},
                                          {0xfeff, 0xfeff},
                                          {0xfff9, 0xffff},
                                          {0xe0000, 0xe0fff}}};
// Spaces and fillers.
constexpr std::array<Span, 12> kBlanks{{{0x20, 0x20},
                                        {0xa0, 0xa0},
                                        {0x115f, 0x1160},
                                        {0x1680, 0x1680},
                                        {0x2000, 0x200a},
                                        {0x200c, 0x200d},
                                        {0x202f, 0x202f},
                                        {0x205f, 0x205f},
                                        {0x2800, 0x2800},
                                        {0x3000, 0x3000},
                                        {0x3164, 0x3164},
                                        {0xffa0, 0xffa0}}};

constexpr std::string_view kReplacement = "\xef\xbf\xbd";  // U+FFFD

}  // namespace

std::size_t utf8_prefix(std::string_view text) {
  std::size_t good = 0;
  for_each(text, [&](code_point c, std::string_view bytes) {
    if (!is_character(c)) return false;
    good += bytes.size();
    return true;
  });
  return good;
}

bool is_text(std::string_view text) {
  return all_of(text, [](code_point c) { return !in(kControls, c); });
}

bool is_name(std::string_view text, std::size_t most) {
  const auto visible = [](code_point c) {
    return !in(kControls, c) && !in(kDirections, c) && !in(kInvisible, c);
  };
  return text.size() <= most && all_of(text, visible) &&
         !all_of(text, [](code_point c) { return in(kBlanks, c); });
}

bool is_session_name(std::string_view text) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_' || c == '.';
  };
  return !text.empty() && text.size() <= 64 && text.front() != '.' &&
         std::all_of(text.begin(), text.end(), allowed);
}

std::string as_utf8(std::string_view text) {
  std::string out;
  for_each(text, [&](code_point c, std::string_view bytes) {
    out += is_character(c) ? bytes : kReplacement;
    return true;
  });
  return out;
}

std::string one_line(std::string_view text) {
  std::string out;
  for_each(text, [&](code_point c, std::string_view bytes) {
    if (!is_character(c))
      out += kReplacement;
    else if (in(kControls, c) || in(kDirections, c))
      out += '?';
    else
      out += bytes;
    return true;
  });
  return out;
}

}  // namespace mortise
