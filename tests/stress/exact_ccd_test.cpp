// Published queries of one edge against another and of a corner against a face, with exact answers
// (shared/data/ccd; Wang et al. 2021). Those in which each primitive moves by a pure translation
// are rigid motions: ours to answer.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/stress/random_cases.h"
#include "tests/stress/record.h"
#include "tests/support/test_data.h"

namespace mortise::stress {
namespace {

namespace fs = std::filesystem;

struct Query {
  Vec3 start[4], end[4];
  bool edges = false;    ///< two edges; else a corner (0) and a face (1, 2, 3)
  bool contact = false;  ///< the published answer
  std::string label;
};

// Denominators are powers of two and numerators below 2^53: the quotient is exact.
bool read_row(const std::string& line, Vec3& point, bool& contact) {
  std::istringstream in(line);
  std::string cell[7];
  for (std::string& c : cell)
    if (!std::getline(in, c, ',')) return false;
  for (int k = 0; k < 3; ++k)
    point[k] =
        std::strtod(cell[2 * k].c_str(), nullptr) / std::strtod(cell[2 * k + 1].c_str(), nullptr);
  contact = cell[6][0] == '1';
  return true;
}

std::vector<Query> read_queries(const fs::path& file) {
  std::vector<Query> queries;
  std::ifstream in(file);
  Query q;
  q.edges = file.parent_path().filename() == "edge-edge";
  int row = 0;
  for (std::string line; std::getline(in, line); ++row) {
    if (!read_row(line, row % 8 < 4 ? q.start[row % 4] : q.end[row % 4], q.contact)) return {};
    if (row % 8 != 7) continue;
    q.label = file.parent_path().parent_path().filename().string() + "/" +
              file.parent_path().filename().string() + "/" + file.filename().string() + " query " +
              std::to_string(row / 8);
    queries.push_back(q);
  }
  return queries;
}

// a - b as the unevaluated sum of two doubles, exactly (Knuth).
std::pair<double, double> difference(double a, double b) {
  const double x = a - b, bb = a - x;
  return {x, (a - (x + bb)) + (bb - b)};
}

bool same_shift(const Query& q, int i, int j) {
  for (int k = 0; k < 3; ++k)
    if (difference(q.end[i][k], q.start[i][k]) != difference(q.end[j][k], q.start[j][k]))
      return false;
  return true;
}

bool translates(const Query& q) {
  return q.edges ? same_shift(q, 0, 1) && same_shift(q, 2, 3)
                 : same_shift(q, 1, 2) && same_shift(q, 2, 3);
}

// Corners, edges and faces as triangles with or without area.
SolidPtr primitive(const Vec3& a, const Vec3& b, const Vec3& c) {
  TriangleMesh mesh;
  mesh.points_mm = {a, b, c};
  mesh.triangles = {{0, 1, 2}};
  return testing::solid(mesh);
}

Case case_of(const Query& q) {
  Case c;
  const Vec3* x = q.start;
  c.a = q.edges ? primitive(x[0], x[1], x[1]) : primitive(x[0], x[0], x[0]);
  c.b = q.edges ? primitive(x[2], x[3], x[3]) : primitive(x[1], x[2], x[3]);
  const int first_b = q.edges ? 2 : 1;
  c.motion_a = testing::slide(Vec3::Zero(), q.end[0] - x[0]);
  c.motion_b = testing::slide(Vec3::Zero(), q.end[first_b] - x[first_b]);
  c.ask_fcl = false;
  return c;
}

TEST(ExactCcd, PublishedQueriesOfPureTranslation) {
  const fs::path folder = test::data_folder() / "ccd";
  MORTISE_NEEDS_DATA(folder);
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".csv") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  CcdScratch scratch;
  int all = 0, rigid = 0, published = 0, sampled = 0;
  for (const double accuracy_mm : {1e-6, 1e-9, 1e-12}) {
    char name[48];
    std::snprintf(name, sizeof name, "exact queries, accuracy %.0e", accuracy_mm);
    Sweep sweep(name);
    int false_negative = 0, false_positive = 0;
    all = rigid = published = sampled = 0;
    for (const fs::path& file : files)
      for (const Query& q : read_queries(file)) {
        ++all;
        if (!translates(q)) continue;
        ++rigid;
        published += q.contact;
        Case both = case_of(q), one = both;
        both.accuracy_mm = one.accuracy_mm = accuracy_mm;
        // The same relative motion with a still face.
        one.motion_a = testing::slide(Vec3::Zero(), both.motion_a.v_W - both.motion_b.v_W);
        one.motion_b = still_motion({});
        for (const Case* c : {&both, &one}) {
          const FirstContact answer = sweep.ask(*c, q.label, 8);
          const bool contact = answer.state != ContactState::kFree;
          EXPECT_NE(answer.state, ContactState::kUndecided) << q.label;
          EXPECT_FALSE(q.contact && !contact) << "false negative: " << q.label;
          false_negative += q.contact && !contact;
          // Within the accuracy it may be: the oracles have looked at the distance.
          false_positive += !q.contact && contact;
          // Looking now and then is what the check must be able to refuse.
          sampled += q.contact && first_contact_by_sampling(query_of(*c), 10, scratch).state ==
                                      ContactState::kFree;
        }
      }
    std::printf(
        "accuracy %.0e: %d queries, %d pure translations (%d with contact), twice each: "
        "%d false negatives, %d contacts within the accuracy that exact arithmetic denies; "
        "ten samples miss %d\n",
        accuracy_mm, all, rigid, published, false_negative, false_positive, sampled);
  }
  EXPECT_EQ(all, 2324);
  EXPECT_EQ(rigid, 626);
  EXPECT_GT(sampled, published) << "a check that nothing can fail";
}

}  // namespace
}  // namespace mortise::stress
