#pragma once
/// \file
/// Files: parts, assemblies, and the logs of sessions. Meshes and STEP files are read by programs
/// of their own in a sandbox (mortise-import, mortise-import-step), which are found beside the
/// running program, in PATH, or by MORTISE_IMPORTER and MORTISE_STEP_IMPORTER. Functions may run in
/// any number of threads.

#include <mortise/judge.h>

namespace mortise::api {

/// Reads one part: STL, OBJ, PLY, glTF, GLB or DAE, or a STEP file of a single part with its exact
/// surfaces. `unit`: of the numbers in a mesh file; STEP has its own. Fails when the file cannot be
/// read, has several parts (load_assembly) or the importer is not there. A tenth of a second and
/// more.
Result<Part> load(const std::string& file, Unit unit = mm);

/// A part where its assembly has it.
struct PlacedPart {
  Part part;                     ///< named by its path in the tree, "arm/servo_1/horn"
  Pose X_WP = Pose::Identity();  ///< its place
};

/// Reads all parts of a STEP assembly. Equal parts share what they are made of. Fails as load()
/// does.
Result<std::vector<PlacedPart>> load_assembly(const std::string& file);

/// Writes a mesh as binary STL, in mm; the ending of the name does not matter. Fails when the file
/// cannot be written.
Status save_stl(const Part& part, const std::string& file);

/// How an assembly is checked.
struct CheckOptions {
  double min_gap_mm = 0.0;  ///< list pairs that are nearer; 0: as the scenario says
  std::vector<std::string> no_explain = {};  ///< relations that explain no overlap: "thread"
  std::vector<std::string> bought = {};  ///< paths or products whose inside is muted, '*' allowed
  std::string general = {};              ///< general tolerance of a STEP file: "ISO 2768-m"
  std::string fit = {};                  ///< of meshes: "H7/g6"
  Unit unit = mm;                        ///< of meshes
  std::string baseline = {};             ///< an older --json report: adds what is new and gone
  bool exact_volumes = true;             ///< ask OpenCASCADE where an explanation needs a volume
  bool html = false;                     ///< also make the page with pictures
  int threads = 2;                       ///< 1 to 256; the answer does not depend on it
};

/// Two parts of an assembly and what they are to each other.
struct CheckedPair {
  std::string part_a;                                      ///< path of one
  std::string part_b;                                      ///< path of the other
  CollisionClass collision_class = CollisionClass::kNone;  ///< of the worst place
  bool contact = false;  ///< they touch as drawn; the class is fake then
  std::string relation;  ///< thread, insert, press fit, clearance hole, touching ... or unknown
  std::string relation_text;  ///< "M2 in Ø1.6 (×2)"
  bool explained = false;     ///< hole and shaft account for the exact volume: no clash
  std::string reason;         ///< why it is explained, or why not
  std::size_t count = 1;      ///< pairs of instances that stand alike
  std::vector<std::pair<std::string, std::string>> instances;  ///< all of them
  std::string inside;                  ///< the product that holds all of them, or empty
  bool muted = false;                  ///< inside of what is bought
  double accuracy_mm = 0.0;            ///< what a contact may be off
  std::optional<double> common_mm3;    ///< exact volume in common; none: not known
  std::optional<double> thickness_mm;  ///< of its thickest piece, 2 V / F
  std::vector<Clash> places;           ///< the worst first; none: touching only
  bool is_clash() const {              ///< real or potential, and nothing explains it
    return collision_class >= CollisionClass::kPotential && !explained && !muted;
  }
};

/// A pair that is nearer than asked.
struct NearPair {
  std::string part_a;  ///< path of one
  std::string part_b;  ///< path of the other
  Interval gap_mm;     ///< of the real surfaces
};

/// What check() found.
struct CheckReport {
  std::vector<CheckedPair> pairs;       ///< in the order in which a designer reads them
  std::vector<NearPair> near;           ///< nearest first
  std::vector<std::string> not_judged;  ///< bodies and pairs, with why
  std::vector<std::string> notes;       ///< of the reading
  std::map<std::string, std::size_t>
      counts;        ///< "unexplained_real", "explained_real", "potential" ...
  std::string json;  ///< the document of `mortise check --json` (schema: check)
  std::string text;  ///< the report for people
  std::string html;  ///< a page with pictures of the worst, where asked for
};

/// Judges an assembly as it stands, as `mortise check` does, with the same bits: a STEP file or a
/// scenario (.yaml). Fails when the file cannot be used. Seconds for a hundred parts.
Result<CheckReport> check(const std::string& file, const CheckOptions& options = {});

/// The same of two or more mesh files as they lie.
Result<CheckReport> check_meshes(const std::vector<std::string>& files,
                                 const CheckOptions& options = {});

/// The worst place of two parts in section, as SVG text, 860 x 560 units. Fails when nothing meets.
/// Costs judge() with full brackets and some ms.
Result<std::string> picture_svg(const Part& a, const Part& b, const JudgeOptions& options = {});

/// A column of a table; one of the two lists is filled.
struct Column {
  std::string name;                ///< of the column
  bool is_text = false;            ///< texts, else numbers
  std::vector<double> numbers;     ///< NaN: unknown
  std::vector<std::string> texts;  ///< empty: unknown
};

/// A table of a log.
struct Table {
  std::string name;             ///< "clashes"
  std::string about;            ///< what a row is
  std::vector<Column> columns;  ///< of equal length
};

/// The log of a session, with the files that continue it.
struct Log {
  std::string session;             ///< its name
  bool complete = false;           ///< it was closed in order
  std::vector<std::string> notes;  ///< what was lost, in words
  std::vector<Table> tables;  ///< session, parts, users, clashes, events, decisions, by_pair ...
};

/// Reads a session log (MCAP) as the tables of `mortise replay export`. Fails when it is none.
Result<Log> read_log(const std::string& file);

/// Computes every tick of a log again and compares: the tick up to which all agrees. Fails with
/// Code::kMismatch at the first difference, and when the log cannot be computed.
Result<std::uint64_t> verify_log(const std::string& file, int threads = 1);

}  // namespace mortise::api
