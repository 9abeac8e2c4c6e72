#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "client/tools/check/baseline.h"
#include "client/tools/check/check_files.h"
#include "client/tools/check/check_text.h"
#include "client/tools/check/options.h"
#include "client/tools/check/propose.h"
#include "client/tools/check/run_check.h"
#include "common/base/json_text.h"
#include "common/io/scenario/assembly_parts.h"
#include "common/io/usage.h"

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
  for (const mortise::Finding& finding : subject->findings)
    std::fprintf(stderr, "mortise-check: %s\n", finding.text.c_str());
  if (!subject->usable()) return mortise::kExitBadInput;
  if (const auto kept = mortise::none_is_written(files_of(subject->scenario)); !kept)
    return say(kept.error());
  const auto outcome = mortise::run_check(std::move(*subject), o);
  if (!outcome) return say(outcome.error());
  const mortise::OpenedScene& opened = outcome->opened;
  const mortise::CheckReport& report = outcome->report;
  const bool color = isatty(STDOUT_FILENO) != 0 && std::getenv("NO_COLOR") == nullptr;
  const std::string text =
      o.json ? mortise::json_text(outcome->document) + "\n"
             : mortise::check_text(opened, report, {color, o.verbose}) + outcome->changes;
  std::fputs(text.c_str(), stdout);
  if (const auto written = mortise::write_check_files(opened, report, o); !written)
    return say(written.error());
  if (o.propose)
    if (const auto proposed = mortise::write_proposal(opened, report, o.files.front()); !proposed)
      return say(proposed.error());
  if (mortise::fails_on(o.fail_on, outcome->document)) return mortise::kExitFindings;
  return not_read_of(opened.scenario).empty() ? mortise::kExitOk : mortise::kExitNotWhole;
}
