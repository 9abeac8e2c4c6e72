#include "client/tools/check/options.h"

#include "common/base/length_unit.h"
#include "common/io/build_info.h"
#include "common/io/usage.h"

namespace mortise {
namespace {

void add_files(ProgramOptions& app, CheckCommand& o) {
  app.add("files", o.files,
          "a STEP assembly, a scenario (.yaml), or two or more meshes, as they lie")
      .reads_file()
      .required();
  app.add("--unit", o.unit, "of the numbers in meshes: mm (default), cm, m, in, um")
      .one_of(length_unit_names());
  app.add("--fit", o.fit, "of meshes: the fit of their hole and shaft, H7/g6");
  app.add("--general", o.general,
          "of a STEP assembly: the general tolerance of its title block, ISO 2768-m");
  app.add("--bought", o.bought,
          "of a STEP assembly: a path or product whose inside is not reported; '*' allowed");
}

void add_judgement(ProgramOptions& app, CheckCommand& o, std::vector<std::string>& unexplained) {
  app.add("--min-gap", o.check.min_gap_mm, "list pairs that are nearer than this, mm").positive();
  std::vector<std::string> relations;
  for (std::size_t i = 0; i < kMatingKindCount; ++i)
    if (is_meant_to_overlap(static_cast<MatingKind>(i)))
      relations.emplace_back(name_of(static_cast<MatingKind>(i)));
  app.add("--no-explain", unexplained, "let this relation explain no overlap").one_of(relations);
  app.add("--threads", o.check.threads, "threads; the result does not depend on it")
      .in_range(1, 256)
      .shows_default();
}

void add_output(ProgramOptions& app, CheckCommand& o) {
  app.add_flag("--json", o.json, "one JSON document on stdout");
  app.add_flag("-v,--verbose", o.verbose, "every contact and every statement of the file");
  app.add("--csv", o.csv, "write the pairs to this file").writes_file();
  app.add("--html", o.html, "write a page with pictures of the worst to this file").writes_file();
  app.add("--junit", o.junit, "write a test report for CI to this file").writes_file();
  app.add(
         "--bcf", o.bcf,
         "write an issue for each clash that nothing explains to this BCF 3.0 file, which must not "
         "exist")
      .writes_file();
  app.add("--sqlite", o.sqlite, "write a database to this file, which must not exist")
      .writes_file();
  app.add("--baseline", o.baseline,
          "a JSON report of before: say what is new, gone, changed and unchanged")
      .reads_file();
  app.add("--fail-on", o.fail_on,
          "exit 6 when there is: real, a real clash that nothing explains; potential, also "
          "a potential one; near, also a gap below --min-gap; new, one that the baseline "
          "has not")
      .one_of({"real", "potential", "near", "new"});
  app.add_flag("--propose", o.propose,
               "write NAME.mortise.yaml beside the STEP file, with the fits to be filled in; it is "
               "read the next time");
  app.add(
         "--session", o.session,
         "of a STEP assembly: write a scenario for a session of it to this file; the overlaps that "
         "are explained begin approved")
      .writes_file();
  app.add("--fix", o.fixed, "with --session: a path of what does not move; '*' allowed");
}

}  // namespace

CheckCommandLine read_check_command_line(int argc, char** argv) {
  CheckCommandLine line;
  CheckCommand& o = line.options;
  ProgramOptions app("mortise-check: what really clashes in an assembly as it stands",
                     version_line("mortise-check"));
  std::vector<std::string> unexplained;
  add_files(app, o);
  add_judgement(app, o, unexplained);
  add_output(app, o);
  app.footer(
      "Exit codes: 0 ok, 1 cannot write, 2 usage, 3 a file has errors, 6 --fail-on found "
      "something, 7 not all of a STEP file could be read: what is missing is not examined.");
  line.exit_code = app.read(argc, argv, [&] {
    o.check.unexplained.insert(unexplained.begin(), unexplained.end());
    if (const Status good = coherent(o); !good) throw UsageError(good.error().text);
  });
  return line;
}

}  // namespace mortise
