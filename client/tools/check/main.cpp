#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "client/tools/check/baseline.h"
#include "client/tools/check/check_files.h"
#include "client/tools/check/check_text.h"
#include "client/tools/check/open_check.h"
#include "client/tools/check/options.h"
#include "client/tools/check/propose.h"
#include "common/base/json_text.h"

namespace {

int say(const mortise::Error& error) {
  std::fprintf(stderr, "mortise-check: %s\n", error.text.c_str());
  return mortise::exit_code_of(error.code);
}

}  // namespace

int main(int argc, char** argv) {
  const mortise::CheckCommandLine line = mortise::read_check_command_line(argc, argv);
  if (line.exit_code >= 0) return line.exit_code;
  const mortise::CheckCommand& o = line.options;
  auto subject = mortise::open_check(o);
  if (!subject) {
    say(subject.error());
    return mortise::kExitBadInput;
  }
  for (const mortise::Finding& finding : subject->opened.findings)
    std::fprintf(stderr, "mortise-check: %s\n", finding.text.c_str());
  if (!subject->opened.usable()) return mortise::kExitBadInput;
  const mortise::CheckReport report = mortise::check_scene(subject->opened, subject->step, o.check);
  mortise::Json document = mortise::check_json(subject->opened, report);
  std::string changes;
  if (!o.baseline.empty()) {
    const auto compared = mortise::compare_with_baseline(o.baseline, document);
    if (!compared) return say(compared.error());
    changes = *compared;
  }
  const bool color = isatty(STDOUT_FILENO) != 0 && std::getenv("NO_COLOR") == nullptr;
  const std::string text =
      o.json ? mortise::json_text(document) + "\n"
             : mortise::check_text(subject->opened, report, {color, o.verbose}) + changes;
  std::fputs(text.c_str(), stdout);
  if (const auto written = mortise::write_check_files(subject->opened, report, o); !written)
    return say(written.error());
  if (o.propose)
    if (const auto proposed = mortise::write_proposal(subject->opened, report, o.files.front());
        !proposed)
      return say(proposed.error());
  return mortise::fails_on(o.fail_on, document) ? mortise::kExitFindings : mortise::kExitOk;
}
