#include "client/tools/first_contact/motions_file.h"

#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <sstream>
#include <string_view>

#include "common/base/file_text.h"
#include "common/base/in_quotes.h"
#include "common/base/ranges.h"

namespace mortise {
namespace {

constexpr std::array<std::string_view, 19> kColumns = {
    "id",      "path",     "ref_x",    "ref_y",    "ref_z",    "start_x", "start_y",
    "start_z", "start_qw", "start_qx", "start_qy", "start_qz", "end_x",   "end_y",
    "end_z",   "end_qw",   "end_qx",   "end_qy",   "end_qz"};
enum Column { kId = 0, kPath = 1, kReference = 2, kStart = 5, kEnd = 12 };

/// A quaternion farther than this from unit length was rounded by no sane writer; it is a mistake.
constexpr double kUnitLength = 1e-3;

struct Cell {
  std::string_view text;
  std::size_t column = 1;  // of its first character, from 1
};

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r'))
    text.remove_suffix(1);
  return text;
}

std::vector<Cell> cells_of(std::string_view line) {
  std::vector<Cell> cells;
  std::size_t begin = 0;
  while (true) {
    const std::size_t comma = line.find(',', begin);
    const std::string_view raw = line.substr(begin, comma == line.npos ? line.npos : comma - begin);
    cells.push_back({trimmed(raw), begin + 1});
    if (comma == line.npos) return cells;
    begin = comma + 1;
  }
}

class MotionsReader {
 public:
  MotionsReader(std::string file, double unit_mm) : file_(std::move(file)), unit_mm_(unit_mm) {}

  Result<std::vector<NamedMotion>> read() {
    Result<std::string> text = file_text(file_);
    if (!text) return text.error();
    std::istringstream in(std::move(*text));
    std::string line;
    while (std::getline(in, line)) {
      ++line_number_;
      if (trimmed(line).empty()) continue;
      const std::vector<Cell> cells = cells_of(line);
      const bool good = width_ == 0 ? header(cells) : row(cells);
      if (!good) return fail(Code::kInvalidInput, error_);
    }
    if (motions_.empty())
      return fail(Code::kInvalidInput,
                  file_ + ":" + std::to_string(line_number_ + 1) +
                      ":1: no motion; the file needs a line of column names and one line a motion");
    return std::move(motions_);
  }

 private:
  bool bad(std::size_t column, const std::string& what) {
    error_ =
        file_ + ":" + std::to_string(line_number_) + ":" + std::to_string(column) + ": " + what;
    return false;
  }

  bool header(const std::vector<Cell>& cells) {
    width_ = cells.size();
    for (std::size_t wanted = 0; wanted < kColumns.size(); ++wanted) {
      bool found = false;
      for (std::size_t i = 0; i < cells.size() && !found; ++i)
        if (cells[i].text == kColumns[wanted]) {
          found = true;
          where_[wanted] = i;
        }
      if (!found)
        return bad(1, "the column " + in_quotes(kColumns[wanted]) +
                          " is missing; the first line must name id,path,ref_x..z,start_x..z,"
                          "start_qw..qz,end_x..z,end_qw..qz");
    }
    return true;
  }

  bool row(const std::vector<Cell>& cells) {
    if (cells.size() != width_)
      return bad(cells.back().column, std::to_string(cells.size()) + " values, but " +
                                          std::to_string(width_) +
                                          " columns are named; add or remove some");
    const Cell& id = cells[where_[kId]];
    if (id.text.empty()) return bad(id.column, "the id is empty; give every motion one");
    if (!ids_.insert(std::string(id.text)).second)
      return bad(id.column, "the id " + in_quotes(id.text) + " occurs twice; make it unique");
    const Cell& path = cells[where_[kPath]];
    if (path.text != "linear" && path.text != "screw")
      return bad(path.column,
                 "the path " + in_quotes(path.text) + " is unknown; write linear or screw");
    Vec3 reference;
    Pose start, end;
    if (!vector(cells, kReference, reference) || !pose(cells, kStart, start) ||
        !pose(cells, kEnd, end))
      return false;
    motions_.push_back({std::string(id.text), path.text == "screw"
                                                  ? screw_motion(start, end, reference)
                                                  : linear_motion(start, end, reference)});
    return true;
  }

  bool number(const std::vector<Cell>& cells, int column, double& x) {
    const Cell& cell = cells[where_[column]];
    std::string_view text = cell.text;
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), x);
    if (status != std::errc{} || end != text.data() + text.size() || !std::isfinite(x))
      return bad(cell.column, in_quotes(cell.text) + " in column " + std::string(kColumns[column]) +
                                  " is no finite number; correct the value");
    return true;
  }

  bool vector(const std::vector<Cell>& cells, int column, Vec3& v) {
    for (int c = 0; c < 3; ++c) {
      if (!number(cells, column + c, v[c])) return false;
      v[c] *= unit_mm_;
      if (!within(v[c], kLongest_mm)) {
        const Cell& cell = cells[where_[column + c]];
        return bad(cell.column, in_quotes(cell.text) + " in column " +
                                    std::string(kColumns[column + c]) +
                                    " is beyond ±1e9 mm; correct the value or the unit");
      }
    }
    return true;
  }

  bool pose(const std::vector<Cell>& cells, int column, Pose& pose) {
    double w = 1.0, x = 0.0, y = 0.0, z = 0.0;
    if (!vector(cells, column, pose.p) || !number(cells, column + 3, w) ||
        !number(cells, column + 4, x) || !number(cells, column + 5, y) ||
        !number(cells, column + 6, z))
      return false;
    pose.q = Quat(w, x, y, z);
    if (!(std::abs(pose.q.norm() - 1.0) <= kUnitLength))
      return bad(cells[where_[column + 3]].column, "the quaternion has length " +
                                                       std::to_string(pose.q.norm()) +
                                                       "; write a unit quaternion, w first");
    pose.q.normalize();
    return true;
  }

  std::string file_, error_;
  double unit_mm_;
  std::size_t line_number_ = 0, width_ = 0;
  std::array<std::size_t, kColumns.size()> where_{};
  std::set<std::string> ids_;
  std::vector<NamedMotion> motions_;
};

}  // namespace

Result<std::vector<NamedMotion>> read_motions(const std::filesystem::path& file, double unit_mm) {
  return MotionsReader(file.string(), unit_mm).read();
}

}  // namespace mortise
