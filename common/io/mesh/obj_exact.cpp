#include "common/io/mesh/obj_exact.h"

#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "common/base/in_quotes.h"
#include "common/io/mesh/raw_soup.h"

namespace mortise {
namespace {

constexpr std::array<std::string_view, 12> kPassedOver = {
    "vt", "vn", "vp", "g", "o", "s", "usemtl", "mtllib", "l", "p", "cstype", "end"};

/// One line of the file, word by word; remembers where it stands.
class Line {
 public:
  Line(std::string_view text) : text_(text) {}

  /// The next word; empty at the end of the line or at a comment.
  std::string_view word() {
    while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
    begin_ = at_;
    if (at_ < text_.size() && text_[at_] == '#') return {};
    while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
    return text_.substr(begin_, at_ - begin_);
  }
  std::size_t column() const { return begin_ + 1; }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
  std::string_view text_;
  std::size_t at_ = 0, begin_ = 0;
};

class ObjReader {
 public:
  ObjReader(std::string file) : file_(std::move(file)) {}

  Result<CleanMesh> read(double unit_mm) {
    std::error_code ignored;  // a pipe would be waited for
    if (std::filesystem::exists(file_, ignored) &&
        !std::filesystem::is_regular_file(file_, ignored))
      return fail(Code::kInvalidInput, file_ + ": is no regular file; give it a file of its own");
    std::ifstream in(file_);
    if (!in) return fail(Code::kNotFound, file_ + ": cannot be opened; check the path");
    for (std::string text; std::getline(in, text);) {
      ++line_number_;
      Line line(text);
      const std::string_view kind = line.word();
      if (kind.empty()) continue;
      bool good = true;
      if (kind == "v")
        good = vertex(line);
      else if (kind == "f")
        good = face(line);
      else
        good = passed_over(kind) ||
               bad(line, "unknown statement " + in_quotes(kind) + "; is this an OBJ file?");
      if (!good) return fail(Code::kInvalidInput, error_);
    }
    if (in.bad()) return fail(Code::kRuntime, file_ + ": reading broke off; check the disk");
    CleanMesh clean = weld(corners_, unit_mm);
    if (clean.mesh.triangles.empty())
      return fail(Code::kInvalidInput,
                  file_ + ": no triangles with an area; export the part again");
    return clean;
  }

 private:
  static bool passed_over(std::string_view kind) {
    for (const std::string_view known : kPassedOver)
      if (kind == known) return true;
    return false;
  }

  bool bad(const Line& line, const std::string& what) {
    error_ = file_ + ":" + std::to_string(line_number_) + ":" + std::to_string(line.column()) +
             ": " + what;
    return false;
  }

  bool vertex(Line& line) {
    std::array<double, 3> p{};
    for (double& x : p) {
      std::string_view word = line.word();
      if (word.empty()) return bad(line, "a vertex needs three coordinates; add the missing ones");
      if (word.front() == '+') word.remove_prefix(1);
      const auto [end, status] = std::from_chars(word.data(), word.data() + word.size(), x);
      if (status != std::errc{} || end != word.data() + word.size() || !std::isfinite(x))
        return bad(line, in_quotes(word) + " is no finite number; correct the coordinate");
    }
    points_.push_back(p);
    return true;
  }

  bool face(Line& line) {
    corner_.clear();
    while (true) {
      const std::string_view word = line.word();
      if (word.empty()) break;
      const std::string_view index_text = word.substr(0, word.find('/'));
      long long index = 0;
      const auto [end, status] =
          std::from_chars(index_text.data(), index_text.data() + index_text.size(), index);
      const bool whole = status == std::errc{} && end == index_text.data() + index_text.size();
      const auto count = static_cast<long long>(points_.size());
      const long long from_one = index < 0 ? count + 1 + index : index;
      if (!whole || from_one < 1 || from_one > count)
        return bad(line, in_quotes(word) + " names no vertex read so far (there are " +
                             std::to_string(count) + "); correct the index");
      corner_.push_back(static_cast<std::size_t>(from_one - 1));
    }
    if (corner_.size() < 3) return bad(line, "a face needs three corners; add the missing ones");
    for (std::size_t k = 2; k < corner_.size(); ++k) {
      for (const std::size_t c : {corner_[0], corner_[k - 1], corner_[k]})
        corners_.insert(corners_.end(), points_[c].begin(), points_[c].end());
      if (corners_.size() / 9 > kMostRawTriangles)
        return bad(line, "more than " + std::to_string(kMostRawTriangles) +
                             " triangles; split the mesh or make it coarser");
    }
    return true;
  }

  std::string file_, error_;
  std::size_t line_number_ = 0;
  std::vector<std::array<double, 3>> points_;
  std::vector<std::size_t> corner_;
  std::vector<double> corners_;
};

}  // namespace

Result<CleanMesh> read_obj_exact(const std::filesystem::path& file, double unit_mm) {
  return ObjReader(file.string()).read(unit_mm);
}

}  // namespace mortise
