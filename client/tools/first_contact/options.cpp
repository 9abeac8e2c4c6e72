#include "client/tools/first_contact/options.h"

#include "common/base/length_unit.h"
#include "common/base/result.h"
#include "common/io/build_info.h"
#include "common/io/usage.h"

namespace mortise {

FirstContactCommandLine read_first_contact_command_line(int argc, char** argv) {
  FirstContactCommandLine line;
  FirstContactOptions& o = line.options;
  ProgramOptions app(
      "mortise-first-contact: when does a moving mesh first touch a static one, motion by motion",
      version_line("mortise-first-contact"));
  app.add("--moving", o.moving, "Mesh of the moving part (OBJ, STL, PLY, glTF, DAE)")
      .reads_file()
      .required();
  app.add("--static", o.fixed, "Mesh of the static part, at identity").reads_file().required();
  app.add("--motions", o.motions,
          "CSV with the columns id,path,ref_x..z,start_x..z,start_qw..z,end_x..z,end_qw..z; "
          "path is linear or screw, ref the reference point in the part's own frame")
      .reads_file()
      .required();
  std::string unit = "mm";
  app.add("--unit", unit, "Unit of every length in the three files: mm, cm, m, in or um")
      .one_of(length_unit_names())
      .shows_default();
  app.add("--accuracy-mm", o.accuracy_mm, "Distance that counts as contact, mm")
      .positive()
      .shows_default();
  app.add("--work-cap", o.work_cap, "Box and leaf tests after which a motion is undecided")
      .in_range(std::uint64_t{1}, std::uint64_t{1} << 60U)
      .shows_default();
  app.add("--out", o.out,
          "CSV to write: id,state,t_clear,t_contact,distance_mm,time_us; state is free, "
          "contact, undecided, touching_at_start or overlapping_at_start")
      .writes_file();
  app.add_flag("--json", o.json, "One JSON document on stdout");
  app.footer(
      "t in [0, 1] of the motion. distance_mm is that of the meshes at t_contact (undecided: at "
      "t_clear).\nExit codes: 0 ok, 1 cannot write, 2 usage, 3 bad input.");
  line.exit_code = app.read(argc, argv, [&] {
    o.unit_mm = *length_unit_mm(unit);
    if (o.out.empty() && !o.json)
      throw UsageError("say where the answers go: --out FILE.csv, or --json");
  });
  return line;
}

}  // namespace mortise
