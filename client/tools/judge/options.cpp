#include "client/tools/judge/options.h"

#include "common/base/length_unit.h"
#include "common/io/build_info.h"
#include "common/io/mesh/mesh_import.h"
#include "common/io/usage.h"

namespace mortise {

JudgeCommandLine read_judge_command_line(int argc, char** argv) {
  JudgeCommandLine line;
  JudgeOptions& o = line.options;
  ProgramOptions app("mortise-judge: judges all pairs of a scenario, or of meshes, at their poses",
                     version_line("mortise-judge"));
  app.add("files", o.files,
          "a scenario (.yaml), or two or more meshes, which meet as they lie in their files")
      .reads_file()
      .required();
  app.add("--fit", o.fit,
          "of meshes: the fit of their hole and shaft, H7/g6; with a size before it where "
          "there are several, \"Ø20 H7/g6\"");
  app.add("--unit", o.unit, "of the numbers in meshes: mm (default), cm, m, in, um")
      .one_of(length_unit_names());
  app.add_flag("--json", o.json, "one JSON document on stdout");
  app.add_flag("-v,--verbose", o.verbose,
               "below each clash its places, and why each has its class");
  app.add_flag("--full", o.full, "refine every bracket, not only until the class is decided");
  app.add("--fail-on", o.fail_on, "exit 6 when a collision of this class or worse is found")
      .one_of({"real", "potential"});
  app.add("--picture", o.picture,
          "draw the worst region in section, as .svg or .png; implies --full")
      .writes_file();
  app.add("--region", o.regions, "draw this region instead; several are drawn side by side");
  app.add_flag(
      "--apply-way", o.apply_way,
      "move the part of the worst region, or of --region, out by its way, and judge again");
  app.add("--threads", o.threads, "threads; the result does not depend on it").in_range(1, 256);
  app.footer(
      "Exit codes: 0 ok, 1 cannot write, 2 usage, 3 a file has errors, 6 --fail-on found "
      "something.");
  line.exit_code = app.read(argc, argv, [&] {
    if (!is_mesh_name(o.files.front())) {
      if (o.files.size() > 1)
        throw UsageError("one scenario, or two or more meshes: not " + o.files[0] + " and " +
                         o.files[1]);
      if (!o.fit.empty() || !o.unit.empty())
        throw UsageError("--fit and --unit are of meshes; a scenario says them itself");
    }
  });
  return line;
}

}  // namespace mortise
