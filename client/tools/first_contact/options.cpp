#include "client/tools/first_contact/options.h"

#include <CLI/CLI.hpp>

#include "common/base/length_unit.h"
#include "common/base/result.h"
#include "common/io/build_info.h"
#include "common/io/usage.h"

namespace mortise {

FirstContactCommandLine read_first_contact_command_line(int argc, char** argv) {
  FirstContactCommandLine line;
  FirstContactOptions& o = line.options;
  CLI::App app{
      "mortise-first-contact: when does a moving mesh first touch a static one, motion by motion"};
  app.set_version_flag("--version", version_line("mortise-first-contact"));
  app.add_option("--moving", o.moving, "Mesh of the moving part (OBJ, STL, PLY, glTF, DAE)")
      ->required();
  app.add_option("--static", o.fixed, "Mesh of the static part, at identity")->required();
  app.add_option("--motions", o.motions,
                 "CSV with the columns id,path,ref_x..z,start_x..z,start_qw..z,end_x..z,end_qw..z; "
                 "path is linear or screw, ref the reference point in the part's own frame")
      ->required();
  std::string unit = "mm";
  app.add_option("--unit", unit, "Unit of every length in the three files: mm, cm, m, in or um")
      ->check(CLI::IsMember(length_unit_names()))
      ->capture_default_str();
  app.add_option("--accuracy-mm", o.accuracy_mm, "Distance that counts as contact, mm")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--work-cap", o.work_cap, "Box and leaf tests after which a motion is undecided")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 60U))
      ->capture_default_str();
  app.add_option("--out", o.out,
                 "CSV to write: id,state,t_clear,t_contact,distance_mm,time_us; state is free, "
                 "contact, undecided, touching_at_start or overlapping_at_start")
      ->required();
  app.footer(
      "t in [0, 1] of the motion. distance_mm is that of the meshes at t_contact (undecided: at "
      "t_clear).\nExit codes: 0 ok, 1 cannot write, 2 usage, 3 bad input.");
  try {
    app.parse(argc, argv);
    o.unit_mm = *length_unit_mm(unit);
  } catch (const CLI::ParseError& error) {
    line.exit_code = exit_of_usage(app, error);
  }
  return line;
}

}  // namespace mortise
