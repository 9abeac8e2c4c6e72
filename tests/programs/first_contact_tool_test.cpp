// The program mortise-first-contact, from files to a table.
#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "common/io/mesh/obj_exact.h"

namespace mortise::test {
namespace {

namespace fs = std::filesystem;

const char* kCube =
    "# unit cube\nv -0.5 -0.5 -0.5\nv 0.5 -0.5 -0.5\nv -0.5 0.5 -0.5\nv 0.5 0.5 -0.5\n"
    "v -0.5 -0.5 0.5\nv 0.5 -0.5 0.5\nv -0.5 0.5 0.5\nv 0.5 0.5 0.5\n"
    "vn 0 0 1\nf 1 3 4 2\nf 5//1 6//1 8//1 7//1\nf -8 -7 -3 -4\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
const char* kHeader =
    "id,path,ref_x,ref_y,ref_z,start_x,start_y,start_z,start_qw,start_qx,start_qy,start_qz,end_x,"
    "end_y,end_z,end_qw,end_qx,end_qy,end_qz\n";

class Tool : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("mortise_first_contact_" + std::to_string(getpid()));
    fs::create_directories(folder_);
    write("cube.obj", kCube);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
  }
  std::string read(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(folder_ / name).rdbuf();
    return text.str();
  }
  // Exit code; stdout and stderr go to files of these names.
  int run(const std::string& arguments) {
    const std::string command = "cd '" + folder_.string() +
                                "' && '" MORTISE_BIN_DIR "/mortise-first-contact' " + arguments +
                                " >stdout 2>stderr";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  int run_motions(const std::string& rows, const std::string& more = "") {
    write("motions.csv", kHeader + rows);
    return run("--moving cube.obj --static cube.obj --motions motions.csv --out out.csv " + more);
  }

  fs::path folder_;
};

TEST_F(Tool, AnswersEveryMotion) {
  ASSERT_EQ(run_motions("hit,linear,0,0,0,-5,0,0,1,0,0,0,5,0,0,1,0,0,0\n"
                        "by,linear,0,0,0,-5,3,0,1,0,0,0,5,3,0,1,0,0,0\n\n"
                        "touch,screw,0,0,0,1,0,0,1,0,0,0,5,0,0,1,0,0,0\r\n"
                        "in,linear,0,0,0,0.5,0,0,1,0,0,0,5,0,0,1,0,0,0\n"),
            0)
      << read("stderr");
  std::istringstream out(read("out.csv"));
  std::string line;
  std::getline(out, line);
  EXPECT_EQ(line, "id,state,t_clear,t_contact,distance_mm,time_us");
  const char* expected[4] = {"hit,contact,0.399999", "by,free,1,1,4.47213595499957",
                             "touch,touching_at_start,0,0,0,", "in,overlapping_at_start,0,0,0,"};
  for (const char* begin : expected) {
    ASSERT_TRUE(std::getline(out, line));
    EXPECT_EQ(line.rfind(begin, 0), 0U) << line;
  }
  EXPECT_FALSE(std::getline(out, line));
  EXPECT_NE(read("stdout").find("4 motions: 1 free, 1 contact, 0 undecided, 1 touching"),
            std::string::npos);
}

TEST_F(Tool, UnitsAreThoseOfTheFiles) {
  ASSERT_EQ(run_motions("a,linear,0,0,0,-5,3,0,1,0,0,0,5,3,0,1,0,0,0\n", "--unit in"), 0);
  const std::string out = read("out.csv");
  EXPECT_NE(out.find("a,free,1,1,113.592253256989"), std::string::npos) << out;
}

// Of 40 times the 99th percentile is the largest, and the median the twentieth.
TEST_F(Tool, SaysPercentilesByNearestRank) {
  std::string rows;
  for (int i = 0; i < 40; ++i)
    rows += "m" + std::to_string(i) + ",linear,0,0,0,-5,0." + std::to_string(10 + i) +
            ",0,1,0,0,0,5,0,0,1,0,0,0\n";
  ASSERT_EQ(run_motions(rows), 0) << read("stderr");
  std::vector<double> time_us;
  std::istringstream out(read("out.csv"));
  std::string line;
  for (std::getline(out, line); std::getline(out, line);)
    time_us.push_back(std::stod(line.substr(line.rfind(',') + 1)));
  ASSERT_EQ(time_us.size(), 40U);
  std::sort(time_us.begin(), time_us.end());
  char said[80];
  std::snprintf(said, sizeof said, "median %.1f us, p99 %.1f us\n", time_us[19], time_us[39]);
  EXPECT_NE(read("stdout").find(said), std::string::npos) << read("stdout") << said;
}

TEST_F(Tool, WhatMayLieInAnOpenMeshIsNotFree) {
  // The cube without one face, ten times as large; the small one stays in it, or beside it.
  std::string open(kCube);
  open.erase(open.rfind("f 2 4 8 6"));
  for (std::size_t at = 0; (at = open.find("0.5", at)) != std::string::npos; at += 3)
    open.replace(at, 3, "5.0");
  write("open.obj", open);
  write("motions.csv", std::string(kHeader) + "in,linear,0,0,0,0,0,0,1,0,0,0,1,0,0,1,0,0,0\n" +
                           "beside,linear,0,0,0,20,0,0,1,0,0,0,21,0,0,1,0,0,0\n");
  ASSERT_EQ(run("--moving cube.obj --static open.obj --motions motions.csv --out out.csv"), 0);
  const std::string out = read("out.csv");
  EXPECT_NE(out.find("in,no_inside,"), std::string::npos) << out;
  EXPECT_NE(out.find("beside,free,"), std::string::npos) << out;
  EXPECT_NE(read("stdout").find("1 motions: no inside"), std::string::npos) << read("stdout");
}

TEST_F(Tool, SaysUndecidedAtTheWorkCap) {
  ASSERT_EQ(run_motions("a,linear,0,0,0,-5,0.1,0.2,1,0,0,0,5,0,0,0.8,0.6,0,0\n", "--work-cap 1"),
            0);
  EXPECT_NE(read("out.csv").find("a,undecided,"), std::string::npos) << read("out.csv");
}

TEST_F(Tool, NamesFileLineAndColumnOfBadInput) {
  const struct {
    const char *row, *says;
  } bad[] = {
      {"a,lnear,0,0,0,-5,0,0,1,0,0,0,5,0,0,1,0,0,0\n", "motions.csv:2:3: the path 'lnear'"},
      {"a,linear,0,0,0,-5,0,0,1,0,0,0,5,0,x,1,0,0,0\n", "motions.csv:2:35: 'x' in column end_z"},
      {"a,linear,0,0,0,nan,0,0,1,0,0,0,5,0,0,1,0,0,0\n",
       "motions.csv:2:16: 'nan' in column start_x"},
      {"a,linear,0,0,0,1e20,0,0,1,0,0,0,5,0,0,1,0,0,0\n",
       "motions.csv:2:16: '1e20' in column start_x is beyond"},
      {"a,screw,0,1e300,0,-5,0,0,1,0,0,0,5,0,0,1,0,0,0\n",
       "motions.csv:2:11: '1e300' in column ref_y is beyond"},
      {"a,linear,0,0,0,-5,0,0,2,0,0,0,5,0,0,1,0,0,0\n", "motions.csv:2:23: the quaternion"},
      {"a,linear,0,0\n", "motions.csv:2:12: 4 values"},
      {"a,linear,0,0,0,-5,0,0,1,0,0,0,5,0,0,1,0,0,0\na,linear,0,0,0,-5,0,0,1,0,0,0,5,0,0,1,0,0,0\n",
       "motions.csv:3:1: the id 'a' occurs twice"},
      {"", "motions.csv:2:1: no motion"}};
  for (const auto& b : bad) {
    EXPECT_EQ(run_motions(b.row), 3) << b.says;
    EXPECT_NE(read("stderr").find(b.says), std::string::npos) << read("stderr");
  }
  write("motions.csv", "id,path\n");
  EXPECT_EQ(run("--moving cube.obj --static cube.obj --motions motions.csv --out o.csv"), 3);
  EXPECT_NE(read("stderr").find("motions.csv:1:1: the column 'ref_x' is missing"),
            std::string::npos);
  EXPECT_EQ(run("--moving none.obj --static cube.obj --motions motions.csv --out o.csv"), 3);
  EXPECT_EQ(run("--moving cube.obj"), 2);
  EXPECT_EQ(run("--help"), 0);
  run_motions("a,linear,0,0,0,-5,0,0,1,0,0,0,5,0,0,1,0,0,0\n");
  EXPECT_EQ(run("--moving cube.obj --static cube.obj --motions motions.csv --out /no/such/o.csv"),
            1);
}

TEST_F(Tool, APointBeyondAllThatIsMadeIsRefused) {
  std::string far(kCube);
  for (std::size_t at = 0; (at = far.find("0.5", at)) != std::string::npos; at += 4)
    far.replace(at, 3, "5e20");
  write("far.obj", far);
  write("motions.csv", std::string(kHeader) + "a,linear,0,0,0,-5,0,0,1,0,0,0,5,0,0,1,0,0,0\n");
  EXPECT_EQ(run("--moving far.obj --static cube.obj --motions motions.csv --out out.csv"), 3);
  EXPECT_NE(read("stderr").find("far.obj: a coordinate is beyond ±1e9 mm"), std::string::npos)
      << read("stderr");
}

TEST_F(Tool, ObjKeepsAllDigitsAndNamesMistakes) {
  write("fine.obj", "v 0.1234567890123456 0 0\nv 1 0 0\nv 0 1 1e-3\nf 1 2 3\n");
  const Result<CleanMesh> fine = read_obj_exact(folder_ / "fine.obj", 10.0);
  ASSERT_TRUE(fine);
  EXPECT_EQ(fine->mesh.points_mm[0].x(), 0.1234567890123456 * 10.0);
  const struct {
    const char *text, *says;
  } bad[] = {{"v 0 0 0\nv 1 0 zero\n", "bad.obj:2:7: 'zero'"},
             {"v 0 0 0\nf 1 2 3\n", "bad.obj:2:5: '2' names no vertex"},
             {"v 0 0 0\nf 1 1\n", "bad.obj:2:"},
             {"v 0 0\n", "bad.obj:1:"},
             {"v 0 0 inf\n", "bad.obj:1:7: 'inf'"},
             {"solid x\n", "bad.obj:1:1: unknown statement 'solid'"},
             {"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "no triangles with an area"}};
  for (const auto& b : bad) {
    write("bad.obj", b.text);
    const Result<CleanMesh> mesh = read_obj_exact(folder_ / "bad.obj", 1.0);
    ASSERT_FALSE(mesh) << b.says;
    EXPECT_NE(mesh.error().text.find(b.says), std::string::npos) << mesh.error().text;
  }
}

}  // namespace
}  // namespace mortise::test
