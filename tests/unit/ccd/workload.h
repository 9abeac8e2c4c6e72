#pragma once
#include <string>
#include <vector>

#include "common/geometry/solid.h"
#include "common/motion/motion.h"

namespace mortise::testing {

/// One set of measured motions: a moving part, a static part at identity, and for each motion what
/// a slow independent method found.
struct Workload {
  struct Row {
    int id = 0;
    Motion motion;
    bool contact = false;
    double t_contact = 1.0;
    double max_speed_mm = 0.0;  ///< of any point of the moving part, per tick
  };
  std::string name;
  SolidPtr moving, fixed;
  std::vector<Row> rows;
};

/// The folder of the data sets: MORTISE_DATA, else <source>/../shared/data.
std::string data_folder();
std::vector<std::string> workload_names();

/// False when the files are not there.
bool load_workload(const std::string& name, Workload& workload);

/// "v" and "f" lines only, as the data sets are written.
bool load_plain_obj(const std::string& file, TriangleMesh& mesh);

}  // namespace mortise::testing
