#include "common/io/mesh/raw_soup.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "common/base/plain_text.h"

namespace mortise {
namespace {

constexpr std::uint64_t kMagic = 0x32'50'55'4f'53'54'52'4dULL;  // "MRTSOUP2"
// Some sentences; a broken answer cannot ask for more memory.
constexpr std::uint64_t kLongestText = 4096;

struct Header {
  std::uint64_t magic = kMagic;
  std::uint64_t refusal_bytes = 0, format_bytes = 0, note_bytes = 0;
  double stated_unit_mm = 0.0, quantum = 0.0;
  std::uint64_t raw_vertices = 0, points_and_lines = 0, triangles = 0;
};
static_assert(sizeof(Header) == 72, "written as it lies in memory: no padding");

Error broken(const std::string& what) {
  return fail(Code::kRuntime, "the importer's answer is damaged (" + what + ")");
}

}  // namespace

std::vector<std::byte> encode(const RawSoup& soup) {
  const std::string refusal = soup.refusal.substr(0, kLongestText);
  const std::string note = soup.note.substr(0, kLongestText);
  Header header;
  header.refusal_bytes = refusal.size();
  header.format_bytes = soup.format.size();
  header.note_bytes = note.size();
  header.stated_unit_mm = soup.stated_unit_mm;
  header.quantum = soup.quantum;
  header.raw_vertices = soup.raw_vertices;
  header.points_and_lines = soup.points_and_lines;
  header.triangles = soup.coordinates.size() / 9;
  std::vector<std::byte> bytes(sizeof header + refusal.size() + soup.format.size() + note.size() +
                               soup.coordinates.size() * sizeof(double));
  std::byte* out = bytes.data();
  const auto put = [&](const void* from, std::size_t size) {
    if (size > 0) std::memcpy(out, from, size);
    out += size;
  };
  put(&header, sizeof header);
  put(refusal.data(), refusal.size());
  put(soup.format.data(), soup.format.size());
  put(note.data(), note.size());
  put(soup.coordinates.data(), soup.coordinates.size() * sizeof(double));
  return bytes;
}

Result<RawSoup> decode(std::span<const std::byte> bytes) {
  Header header;
  if (bytes.size() < sizeof header) return broken("it is too short");
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.magic != kMagic) return broken("it is not one of ours");
  if (std::max({header.refusal_bytes, header.format_bytes, header.note_bytes}) > kLongestText)
    return broken("a text is too long");
  if (header.triangles > kMostRawTriangles) return broken("too many triangles");
  const std::uint64_t expected = sizeof header + header.refusal_bytes + header.format_bytes +
                                 header.note_bytes + header.triangles * 9 * sizeof(double);
  if (bytes.size() != expected) return broken("its length is not what it states");
  const bool numbers_ok = std::isfinite(header.quantum) && header.quantum >= 0.0 &&
                          std::isfinite(header.stated_unit_mm) && header.stated_unit_mm >= 0.0;
  if (!numbers_ok) return broken("a number is not finite");

  RawSoup soup;
  const std::byte* in = bytes.data() + sizeof header;
  const auto text = [&](std::uint64_t size) {
    std::string s(reinterpret_cast<const char*>(in), size);
    in += size;
    return one_line(s);  // a text of a stranger
  };
  soup.refusal = text(header.refusal_bytes);
  soup.format = text(header.format_bytes);
  soup.note = text(header.note_bytes);
  soup.stated_unit_mm = header.stated_unit_mm;
  soup.quantum = header.quantum;
  soup.raw_vertices = header.raw_vertices;
  soup.points_and_lines = header.points_and_lines;
  soup.coordinates.resize(header.triangles * 9);
  if (!soup.coordinates.empty())
    std::memcpy(soup.coordinates.data(), in, soup.coordinates.size() * sizeof(double));
  for (const double x : soup.coordinates)
    if (!std::isfinite(x)) return broken("a coordinate is not finite");
  return soup;
}

}  // namespace mortise
